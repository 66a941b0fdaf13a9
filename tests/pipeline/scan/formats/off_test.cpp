// OFF in the forms that files in use have, against the mesh that they all describe.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "pipeline/scan/writer.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using testing::error_of_bytes;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ScanFolder;

const std::vector<Eigen::Vector3d> kCorners{{0, 0, 0}, {1, 0, 0.5}, {1, 2, 0.25}, {0, 2, -1}};

/// A square of four corners, of which two triangles become whatever the form.
void expect_square(const std::string& text, const char* name = "a.off") {
  const RawScan scan = read_scan_bytes(text, name);
  EXPECT_EQ(scan.points, kCorners) << text;
  EXPECT_EQ(scan.faces.size(), 2U) << text;
  EXPECT_EQ(scan.records, 4U);
  EXPECT_THAT(scan.format, HasSubstr("OFF text"));
}

const std::string kRows = "0 0 0\n1 0 0.5\n1 2 0.25\n0 2 -1\n";
const std::string kFace = "4 0 1 2 3\n";

TEST(OffReader, ReadsEveryFormOfHeader) {
  for (const char* head :
       {"OFF\n4 1 0\n", "OFF 4 1 0\n", "OFF4 1 0\n", "off\n4 1\n", "Off\r\n4 1 4\n", "OFF\n\n# four\n4 1 0\n",
        "# first\nOFF # word\n4 1 0 # counts\n", "4 1 0\n", "OFF\n4\n1\n0\n", "nOFF 3\n4 1 0\n", "nOFF\n3\n4 1 0\n",
        "  OFF\n  4 1 0\n", "\xEF\xBB\xBFOFF\n4 1 0\n"}) {
    expect_square(head + kRows + kFace);
  }
  for (const char* name : {"a.txt", "a.ply", "a.xyz", "a"}) {
    if (std::string(name) != "a.ply") expect_square("OFF\n4 1 0\n" + kRows + kFace, name);
  }
}

TEST(OffReader, ReadsLinesOfAnyKindAndEnd) {
  std::string text = "OFF\n4 1 0\n" + kRows + kFace;
  for (const char* end : {"\r\n", "\r", "\n\n", "\n# remark\n", " # remark\n", "\t\n"}) {
    std::string other;
    for (const char c : text) c == '\n' ? other += end : other += c;
    expect_square(other);
  }
  text.pop_back();
  expect_square(text);
  expect_square("OFF 4 1 0 0 0 0 1 0 0.5 1 2 0.25 0 2 -1 4 0 1 2 3");
  expect_square("OFF\n4 1 0\n0 0\n0 1 0\n0.5 1 2\n0.25 0 2 -1\n4 0 1\n2 3\n");
  expect_square("OFF\n4 2 0\n" + kRows + "3 0 1 2\n3 0 2 3\n");
  expect_square("OFF\n4 2 0\n" + kRows + "3  0 1 2  255 0 0\n3 0 2 3 7\n");
  expect_square("OFF\n4 3 0\n" + kRows + "3 0 1 2\n2 0 1\n3 0 2 3\n");
}

TEST(OffReader, KnowsColoursNormalsTextureAndTheFourthCoordinate) {
  struct Form {
    const char* word;
    std::vector<std::string> values;
    bool colour, normal;
  };
  const Form forms[] = {
      {"COFF", {"255 0 0 255", "0 255 0 255", "0 0 255 255", "9 9 9 255"}, true, false},
      {"COFF", {"1 0 0 1", "0 1 0 1", "0 0 1 1", "0.5 0.5 0.5 1"}, true, false},
      {"COFF", {"255 0 0", "0 255 0", "0 0 255", "9 9 9"}, true, false},
      {"OFF", {"255 0 0", "0 255 0", "0 0 255", "9 9 9"}, true, false},
      {"OFF", {"255 0 0 255", "0 255 0 255", "0 0 255 255", "9 9 9 255"}, true, false},
      {"OFF", {"1 0 0", "0 -1 0", "0 0 1", "1 0 0"}, false, false},
      {"NOFF", {"0 0 1", "0 0 1", "0 0 1", "0 0 1"}, false, true},
      {"NCOFF", {"0 0 1 255 0 0 255", "0 0 1 0 255 0 255", "0 0 1 0 0 255 255", "0 0 1 9 9 9 255"}, true, true},
      {"CNOFF", {"0 0 1 255 0 0 255", "0 0 1 0 255 0 255", "0 0 1 0 0 255 255", "0 0 1 9 9 9 255"}, true, true},
      {"STOFF", {"0 0", "1 0", "1 1", "0 1"}, false, false},
      {"STCNOFF", {"0 0 1 1 0 0 1 0 0", "0 0 1 0 1 0 1 1 0", "0 0 1 0 0 1 1 1 1", "0 0 1 0 0 1 1 0 1"}, true, true},
      {"4OFF", {"1", "1", "1", "1"}, false, false},
  };
  const std::vector<std::string> rows{"0 0 0", "1 0 0.5", "1 2 0.25", "0 2 -1"};
  for (const Form& form : forms) {
    std::string text = std::string(form.word) + "\n4 1 0\n";
    for (std::size_t v = 0; v < 4; ++v) text += rows[v] + " " + form.values[v] + "\n";
    expect_square(text + kFace, "a.off");
    const RawScan scan = read_scan_bytes(text + kFace, "a.off");
    EXPECT_EQ(!scan.rgba.empty(), form.colour) << text;
    EXPECT_EQ(!scan.normals.empty(), form.normal) << text;
    if (form.colour) {
      EXPECT_EQ(scan.rgba[1], pack_rgba(0, 255, 0)) << text;
    }
    if (form.normal) {
      EXPECT_EQ(scan.normals[2], Eigen::Vector3f(0, 0, 1)) << text;
    }
  }
  const RawScan halves = read_scan_bytes("4OFF\n1 0 0\n2 4 6 2\n", "a.off");
  EXPECT_EQ(halves.points, std::vector<Eigen::Vector3d>(1, {1, 2, 3}));
}

TEST(OffReader, CountsWhatIsNotValid) {
  const RawScan scan = read_scan_bytes("OFF\n5 3 0\nnan 0 0\n" + kRows + "3 1 2 3\n3 0 1 2\n3 1 2 99\n", "a.off");
  EXPECT_EQ(scan.records, 5U);
  EXPECT_EQ(scan.invalid, 1U);
  EXPECT_EQ(scan.faces.size(), 1U);
  EXPECT_FALSE(scan.warnings.empty());
}

TEST(OffReader, RefusesWhatIsDamagedWithItsLine) {
  const auto refuse = [](const std::string& text, int line, const char* message) {
    const auto error = error_of_bytes("a.off", text);
    ASSERT_TRUE(error) << text;
    EXPECT_THAT(error->what(), HasSubstr(message)) << text;
    EXPECT_EQ(error->place().line, line) << text;
  };
  refuse("OFF\n", 1, "ends within the header");
  refuse("OFF\n4 x 0\n", 2, "'x' is no number of faces");
  refuse("OFF\n-4 1 0\n", 2, "'-4' is no number of vertices");
  refuse("OFF\n4000000000 1 0\n0 0 0\n", 2, "cannot be in the");
  refuse("OFF\n1 4000000000 0\n0 0 0\n", 2, "cannot be in the");
  refuse("OFF\n4 1 0\n0 0 0\n1 0\n1 2 0\n0 2 0\n" + kFace, 4, "a vertex of 2 values");
  refuse("OFF\n4 1 0\n0 0 0\n1 a 0\n1 2 0\n0 2 0\n" + kFace, 4, "'a' in a vertex");
  refuse("OFF\n4 1 0\n0 0 0\n1 0 0\n1 2 0\n", 5, "ends within the vertices");
  refuse("OFF\n4 2 0\n" + kRows + "3 0 1 2\n3 0", 8, "ends within the faces");
  refuse("OFF\n4 1 0\n" + kRows + "3 0 one 2\n", 7, "'one' is no vertex");
  refuse("OFF\n4 1 0\n" + kRows + "99999 0 1 2\n", 7, "a face of 99999 corners");
  refuse("nOFF 5\n1 0 0\n1 2 3 4 5\n", 1, "5 dimensions");
  refuse("OFF BINARY\n4 1 0\n", 0, "a binary OFF mesh");
  refuse(std::string("COFF BINARY\n\0\0\0\4\0\0\0\1", 20), 0, "a binary OFF mesh");
}

TEST(OffReader, AColumnOfThatNameIsNoMesh) {
  const ScanFolder folder;
  EXPECT_EQ(folder.read("a.txt", "off x y z\n7 1 2 3\n7 4 5 6\n7 7 8 8\n").records, 3U);
}

}  // namespace
}  // namespace sparsha::pipeline
