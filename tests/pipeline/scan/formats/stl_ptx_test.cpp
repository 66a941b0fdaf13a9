// STL: distinct vertices, both encodings, headers that lie. PTX: several scans, each in its place.
#include <gmock/gmock.h>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using testing::expect_refused;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::put;
using testing::ScanFolder;
using Face = std::array<std::uint32_t, 3>;

std::string binary_stl(const std::string& head, std::uint32_t claimed, const std::vector<float>& coordinates) {
  std::string bytes = head;
  bytes.resize(80, ' ');
  put(bytes, claimed);
  for (std::size_t at = 0; at < coordinates.size(); at += 9) {
    for (int i = 0; i < 3; ++i) put(bytes, 0.0F);
    for (std::size_t i = 0; i < 9; ++i) put(bytes, coordinates[at + i]);
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}

const std::vector<float> kTwoTriangles = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, -0.0F, 1, 0};

TEST(StlReader, ReadsBinaryTrianglesOfDistinctVertices) {
  const ScanFolder folder;
  for (const std::string head : {"made by a test", "solid but binary"}) {
    const RawScan scan = folder.read("b.stl", binary_stl(head, 2, kTwoTriangles));
    EXPECT_EQ(scan.format, "STL binary");
    EXPECT_EQ(scan.records, 4U);
    EXPECT_THAT(scan.faces, ElementsAre(Face{0, 1, 2}, Face{1, 3, 2}));
  }
}

TEST(StlReader, ReadsAsciiWithSeveralSolidsAndCrlf) {
  const ScanFolder folder;
  const std::string facet =
      "facet normal 0 0 1\r\n outer loop\r\n  vertex 0 0 0\r\n  VERTEX 1e0 0 0\r\n  vertex 0 1. 0\r\n"
      " endloop\r\nendfacet\r\n";
  const RawScan scan = folder.read("a.stl", "solid one\r\n" + facet + "endsolid one\r\nsolid\r\nendsolid\r\n");
  EXPECT_EQ(scan.format, "STL ascii");
  EXPECT_EQ(scan.records, 3U);
  EXPECT_THAT(scan.faces, ElementsAre(Face{0, 1, 2}));
}

TEST(StlReader, ReadsAsciiInOneLine) {
  const ScanFolder folder;
  const std::string facet =
      " facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet FACET NORMAL 0 0 1 OUTER "
      "LOOP VERTEX 1 0 0 VERTEX 1 1 0 VERTEX 0 1 0 ENDLOOP ENDFACET";
  const std::vector<std::string> texts = {
      "solid a" + facet + " endsolid a", "solid" + facet + " endsolid",
      "solid facet of a stone" + facet + " endsolid facet of a stone\n", "solid endsolid\nsolid" + facet + "\nendsolid",
      "solid a facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet endsolid a "
      "solid "
      "b facet normal 0 0 1 outer loop vertex 1 0 0 vertex 1 1 0 vertex 0 1 0 endloop endfacet endsolid b"};
  for (const std::string& text : texts) {
    const RawScan scan = folder.read("a.stl", text);
    EXPECT_EQ(scan.records, 4U) << text;
    EXPECT_THAT(scan.faces, ElementsAre(Face{0, 1, 2}, Face{1, 3, 2})) << text;
  }
  expect_refused("cut.stl", "solid a" + facet, "ends within a solid");
  expect_refused("cut.stl", "solid a" + facet.substr(0, 70), "ends within a solid");
  // Remarks behind a statement are none.
  EXPECT_EQ(folder
                .read("r.stl",
                      "solid a solid part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0 // a\nvertex 1 0 0\n"
                      "vertex 0 1 0\nendloop\nendfacet\nendsolid a solid part\n")
                .faces.size(),
            1U);
}

TEST(StlReader, SaysThatColoursOfFacesAreNotUsed) {
  const ScanFolder folder;
  const auto warnings = [&](const std::string& head, std::uint16_t first, std::uint16_t second) {
    std::string bytes = binary_stl(head, 2, kTwoTriangles);
    bytes.replace(84 + 48, 2, std::string({static_cast<char>(first & 0xFF), static_cast<char>(first >> 8)}));
    bytes.replace(84 + 98, 2, std::string({static_cast<char>(second & 0xFF), static_cast<char>(second >> 8)}));
    return folder.read("c.stl", bytes).warnings;
  };
  EXPECT_THAT(warnings("VisCAM", 0xFC04, 0x8001), ElementsAre(HasSubstr("colours of 2 faces are not used")));
  EXPECT_THAT(warnings("VisCAM", 0xFC04, 0), ElementsAre(HasSubstr("colour of 1 face is not used")));
  EXPECT_THAT(warnings("COLOR=abcd", 0x0C1F, 0x8000), ElementsAre(HasSubstr("colour of 1 face is not used")));
  EXPECT_THAT(warnings("other", 0x0C1F, 0), IsEmpty());
  EXPECT_THAT(warnings("other", 0xFFFF, 0xFFFF), IsEmpty());
}

TEST(StlReader, PassesOverColoursInText) {
  const ScanFolder folder;
  const std::string loop = "outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n";
  const std::vector<std::string> facets = {"facet normal 0 0 1\ncolor 0.5 0.5 0.5\n" + loop + "endfacet\n",
                                           "facet normal 0 0 1\n" + loop + "  COLOR 1 0 0 1\nendfacet\n",
                                           "facet normal 0 0 1 color 255 0 0 " + loop + "endfacet\n"};
  for (const std::string& facet : facets) {
    const RawScan scan = folder.read("a.stl", "solid a\n" + facet + "endsolid a\n");
    EXPECT_THAT(scan.faces, ElementsAre(Face{0, 1, 2})) << facet;
    EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("colour of 1 face is not used"))) << facet;
  }
  const RawScan whole =
      folder.read("a.stl", "solid a\ncolor 0.5 0.5 0.5\nfacet normal 0 0 1\n" + loop + "endfacet\nendsolid a\n");
  EXPECT_EQ(whole.faces.size(), 1U);
  EXPECT_THAT(whole.warnings, ElementsAre(HasSubstr("colour of a solid is not used")));
}

TEST(StlReader, CountsInvalidVertices) {
  const ScanFolder folder;
  std::vector<float> coordinates = kTwoTriangles;
  coordinates[0] = std::numeric_limits<float>::quiet_NaN();
  const RawScan scan = folder.read("n.stl", binary_stl("", 2, coordinates));
  EXPECT_EQ(scan.invalid, 1U);
  EXPECT_EQ(scan.faces.size(), 1U);
}

TEST(StlReader, RefusesLies) {
  const ScanFolder folder;
  const auto refuse = [](const std::string& bytes, const char* message) { expect_refused("lie.stl", bytes, message); };
  std::string huge = binary_stl("head", 4000000000U, kTwoTriangles);
  huge[5] = '\0';
  refuse(huge, "promises 4000000000 triangles");
  refuse("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n",
         "loop of 2");
  refuse("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nendloop\nendfacet\nendsolid\n", "in a vertex");
  refuse("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "ends within a solid");
  refuse(binary_stl("", 0, {}), "no facets");
  refuse(binary_stl("solid x", 0, {}), "no facets");
  refuse("solid x\nendsolid x\n", "no facets");
  refuse("solid x\nfacet normal 0 0 1\nendfacet\nendsolid x\n", "no facets");
  refuse("solid x\nfacet\nnonsense\nendsolid\n", "unknown STL line");
}

const std::string kUnit = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";

TEST(StlReader, AFacetNeedsNoNormal) {
  const ScanFolder folder;
  EXPECT_EQ(folder
                .read("a.stl",
                      "solid a facet outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet endsolid a\n")
                .faces.size(),
            1U);
}

TEST(PtxReader, AppliesEachScansMatrixToItsRowsOfPoints) {
  const ScanFolder folder;
  // A quarter turn about z, then a shift: the matrix multiplies row vectors from the right.
  const std::string text = "2\n1\n" + kUnit + "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n0 0 0 0.5\n" + "1\n1\n" +
                           kUnit + "0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n1 0 0 0.25\n";
  const RawScan scan = folder.read("a.ptx", text);
  EXPECT_EQ(scan.format, "PTX text");
  EXPECT_EQ(scan.scans, 2U);
  EXPECT_EQ(scan.records, 3U);
  EXPECT_EQ(scan.invalid, 1U) << "a cell without answer is 0 0 0";
  EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(10, 21, 30)));
  EXPECT_THAT(scan.intensity, ElementsAre(0.5F, 0.25F));
}

TEST(PtxReader, ReadsColours) {
  const ScanFolder folder;
  EXPECT_THAT(folder.read("c.ptx", "1\n1\n" + kUnit + "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5 1 2 3\n").rgba,
              ElementsAre(0xFF030201U));
}

const std::string kNotTurned = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

TEST(PtxReader, GreyAndColouredStationsInAnyOrderKeepWhatTheyHave) {
  const ScanFolder folder;
  const std::string head = kUnit + kNotTurned;
  const std::string grey = "2\n1\n" + head + "1 2 3 0.5\n4 5 6 0.25\n";
  const std::string coloured = "1\n3\n" + head + "7 8 9 0.75 1 2 3\n0 0 0 0.5\n1 1 1 0.5\n";
  const std::string empty = "0\n0\n" + head;
  const std::string blind = "1\n1\n" + head + "0 0 0 0.5 0 0 0\n";
  const RawScan scan = folder.read("a.ptx", empty + coloured + grey + blind + "1\n1\n" + head + "3 3 3\n");
  EXPECT_EQ(scan.scans, 5U);
  EXPECT_EQ(scan.invalid, 2U);
  EXPECT_THAT(scan.rgba, ElementsAre(0xFF030201U, kNoColour, kNoColour, kNoColour, kNoColour));
  EXPECT_THAT(scan.intensity, ElementsAre(0.75F, 0.5F, 0.5F, 0.25F, ::testing::IsNan()));
  EXPECT_THAT(scan.fields, ElementsAre("x", "y", "z", "intensity", "red", "green", "blue"));
  const RawScan other = folder.read("b.ptx", grey + coloured);
  EXPECT_THAT(other.rgba, ElementsAre(kNoColour, kNoColour, 0xFF030201U, kNoColour));
  EXPECT_THAT(folder.read("c.ptx", grey).rgba, ::testing::IsEmpty());
}

TEST(PtxReader, RefusesLies) {
  const ScanFolder folder;
  const std::string& matrix = kNotTurned;
  const auto refuse = [](const std::string& text, const char* message) { expect_refused("lie.ptx", text, message); };
  refuse("100000\n100000\n" + kUnit + matrix + "1 2 3 0.5\n", "10000000000 points cannot be");
  refuse("2\n1\n" + kUnit + matrix + "1.000 2.000 3.000 0.5\n", "ends after 1 of 2");
  refuse("1\n1\n" + kUnit + matrix + "1 2 3 grey\n", "no PTX point");
  refuse("1\n1\n" + kUnit + matrix + "1 2 3 0.5\n1\n1\n0 0 0\n", "within a scan's header");
  refuse("1\n1\n" + kUnit + "1 0 0\n", "bad line 7");
  const std::string one = "1\n1\n" + kUnit + matrix + "1 2 3 0.5\n";
  refuse("2\n1\n" + kUnit + matrix + "1 2 3 0.5\n" + one,
         "the scan that begins on line 1 has 1 of its 2 points where the next one begins");
  refuse(one + "1 2 3 0.5\n", "behind the scan that begins on line 1 and has 1 points stands another point");
}

}  // namespace
}  // namespace sparsha::pipeline
