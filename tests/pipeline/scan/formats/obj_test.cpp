// OBJ: vertices with and without colours, faces of every spelling.
#include <gmock/gmock.h>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::expect_refused;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ScanFolder;
using Face = std::array<std::uint32_t, 3>;

TEST(ObjReader, ReadsVerticesAndFacesOfEverySpelling) {
  const ScanFolder folder;
  const RawScan scan =
      folder.read("a.obj",
                  "# made by hand\nmtllib x.mtl\no thing\n  v 0 0 0\nv\t1 0 0 # corner\nvt 0 0\nvn 0 0 1\n"
                  "v 1 1 0 1.0\nv 0 1 0\ng side\nusemtl m\ns off\nf 1 2 3\nf 1/1 3/1 4/1\nf 1//1 2//1 3//1\n"
                  "f 1/1/1 2/1/1 3/1/1 4/1/1\nf -4 -3 -1\nl 1 2\np 1\n");
  EXPECT_EQ(scan.format, "OBJ");
  EXPECT_EQ(scan.records, 4U);
  EXPECT_EQ(scan.points[2], Eigen::Vector3d(1, 1, 0));
  EXPECT_THAT(scan.faces,
              ElementsAre(Face{0, 1, 2}, Face{0, 2, 3}, Face{0, 1, 2}, Face{0, 1, 3}, Face{0, 1, 2}, Face{0, 2, 3}));
  EXPECT_TRUE(scan.rgba.empty());
  EXPECT_TRUE(scan.warnings.empty());
}

TEST(ObjReader, ReadsFacesOfTheOldKeyword) {
  const ScanFolder folder;
  const RawScan scan = folder.read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nfo 1 2 3\nfo 2/1 4/1 3/1\n");
  EXPECT_THAT(scan.faces, ElementsAre(Face{0, 1, 2}, Face{1, 3, 2}));
  EXPECT_THAT(scan.warnings, IsEmpty());
}

TEST(ObjReader, ReadsCrlfBlankLinesContinuationsAndNoLastLineEnd) {
  const ScanFolder folder;
  const RawScan scan = folder.read("a.obj", "\r\nv 0 0 \\\r\n 0\r\n\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 \\\r\n2 \\\r\n3");
  EXPECT_EQ(scan.records, 3U);
  EXPECT_THAT(scan.faces, ElementsAre(Face{0, 1, 2}));
}

TEST(ObjReader, ReadsColoursOfFractionsAndBytes) {
  const ScanFolder folder;
  EXPECT_THAT(folder.read("f.obj", "v 0 0 0 1 0.5 0\nv 1 1 1 0 0 1\n").rgba, ElementsAre(0xFF0080FFU, 0xFFFF0000U));
  EXPECT_THAT(folder.read("b.obj", "v 0 0 0 255 128 0\nv 1 1 1 0 0 1\n").rgba, ElementsAre(0xFF0080FFU, 0xFF010000U));
  EXPECT_THAT(folder.read("a.obj", "v 0 0 0 1 0.5 0 0\n").rgba, ElementsAre(0x000080FFU));
  const RawScan mixed = folder.read("m.obj", "v 0 0 0 1 0.5 0\nv 1 1 1\n");
  EXPECT_THAT(mixed.rgba, ElementsAre(0xFF0080FFU, kNoColour));
  EXPECT_EQ(mixed.warnings.size(), 1U);
}

TEST(ObjReader, CountsInvalidVerticesAndKeepsTheNumbersOfTheOthers) {
  const ScanFolder folder;
  const RawScan scan = folder.read("n.obj", "v nan 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\nf 1 2 3\nf -1 -2 -3\n");
  EXPECT_EQ(scan.invalid, 1U);
  EXPECT_THAT(scan.faces, ElementsAre(Face{0, 1, 2}, Face{2, 1, 0}));
}

TEST(ObjReader, ReadsAnExponentWithItsSignBeforeItsLetterAndSaysSo) {
  const ScanFolder folder;
  const RawScan scan = folder.read("e.obj", "v 1e+2 2.e+1 3.1+e2\nv 1. +.5 -3.1-e2\n");
  EXPECT_DOUBLE_EQ(scan.points[0].z(), 310.0);
  EXPECT_DOUBLE_EQ(scan.points[1].z(), -0.031);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("2 numbers")));
}

TEST(ObjReader, LeavesOutFacesOnMissingVerticesAndSaysSo) {
  const ScanFolder folder;
  const RawScan scan =
      folder.read("f.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 12\nf 0 1 2\nf -9 1 2\nf 1 2 3\nf 1 2 3 99999999999\n");
  EXPECT_THAT(scan.faces, ElementsAre(Face{0, 1, 2}));
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("1 corner of faces names vertex 0"), HasSubstr("4 faces")));
}

TEST(ObjReader, ReadsFacesThatCountFromZeroAndSaysSo) {
  const ScanFolder folder;
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\n";
  const RawScan scan = folder.read("z.obj", vertices + "f 1 4 2\nf 0 1 2 3\n");
  EXPECT_THAT(scan.faces, ElementsAre(Face{1, 4, 2}, Face{0, 1, 2}, Face{0, 2, 3}));
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("count from 0")));
  // The last vertex is named, or none next to it: one 0 tells nothing of the other faces.
  for (const std::string faces : {"f 0 1 2\nf 3 4 5\n", "f 0 1 2\n", "f 0 1 2\nf 2 3 4\nf -1 -2 -3\n"}) {
    EXPECT_THAT(folder.read("o.obj", vertices + faces).warnings,
                ElementsAre(HasSubstr("1 corner of faces names vertex 0"), HasSubstr("1 face names vertices")))
        << faces;
  }
}

TEST(ObjReader, ColoursBehindAWeightAreThoseBehindIt) {
  const ScanFolder folder;
  const RawScan scan = folder.read("w.obj", "v 0 0 0 1.0 1 0.5 0\nv 1 1 1 1.0 0 0 1\n");
  EXPECT_THAT(scan.rgba, ElementsAre(0xFF0080FFU, 0xFFFF0000U));
  EXPECT_THAT(scan.notes, ElementsAre(HasSubstr("a weight")));
  EXPECT_THAT(folder.read("b.obj", "v 0 0 0 1 255 128 0\nv 1 1 1 1 0 0 255\n").rgba,
              ElementsAre(0xFF0080FFU, 0xFFFF0000U));
  // An opacity that never varies tells nothing.
  EXPECT_THAT(folder.read("a.obj", "v 0 0 0 1 0.5 0 1\nv 1 1 1 1 0 1 1\n").rgba, ElementsAre(0xFF0080FFU, 0xFFFF00FFU));
}

TEST(ObjReader, RefusesBrokenLinesWithTheirNumber) {
  const ScanFolder folder;
  const auto refuse = [](const std::string& text, int line, const char* message) {
    expect_refused("b.obj", text, message, line);
  };
  refuse("v 1 2\n", 1, "a vertex with 2 numbers");
  refuse("v 0 0 0\nv 1 x 3\n", 2, "'x 3' in a vertex");
  refuse("v 1 2 3 4 5 6 7 8\n", 1, "in a vertex");
  refuse("v 1 2 3\nf 1 b 3\n", 2, "'b' is no vertex");
  refuse("v 1 2 3\nf 1 2.5 3\n", 2, "'2.5' is no vertex");
  refuse("# nothing\nf -4 -3 -2", 0, "no vertices");
  refuse(std::string("\xFE\xFF\0v\0 \0001", 8), 0, "UTF-16");
}

TEST(ObjReader, ElementsThatAreNoFacesAreSaid) {
  const ScanFolder folder;
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
  EXPECT_THAT(folder.read("l.obj", vertices + "l 1 2 3\nl 3 4\n").warnings,
              ElementsAre(AllOf(HasSubstr("lines ('l', 2)"), HasSubstr("no faces"))));
  EXPECT_THAT(folder.read("s.obj", vertices + "f 1 2 3\ncstype bspline\ndeg 3 3\nsurf 0 1 0 1 1 2 3 4\nend\n").warnings,
              ElementsAre(AllOf(HasSubstr("surfaces ('surf', 1)"), HasSubstr("control points"))));
  EXPECT_THAT(folder.read("c.obj", vertices + "curv 0 1 1 2 3 4\n").warnings, ElementsAre(HasSubstr("'curv'")));
  const RawScan points = folder.read("p.obj", vertices + "p 1 2 3 4\n");
  EXPECT_THAT(points.warnings, IsEmpty());
  EXPECT_THAT(points.notes, ElementsAre(HasSubstr("points ('p', 1)")));
  const RawScan edges = folder.read("e.obj", vertices + "f 1 2 3\nl 2 4\n");
  EXPECT_THAT(edges.warnings, IsEmpty());
  EXPECT_THAT(edges.notes, ElementsAre(HasSubstr("lines ('l', 1)")));
}

TEST(ObjReader, AFaceThatHoldsAPlaceMovesNoOthersAndOpaqueWhiteStaysWhite) {
  const ScanFolder folder;
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 9 9 9\n";
  const RawScan scan = folder.read("p.obj", vertices + "f 0 0 0\nf 1 2 3\nf 2 4 3\n");
  ASSERT_EQ(scan.faces.size(), 2U);
  EXPECT_EQ(scan.faces[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  const RawScan white = folder.read("w.obj", "v 0 0 0 1 1 1 0.5\nv 1 0 0 1 1 1 0.25\nv 0 1 0 1 1 1 1\nf 1 2 3\n");
  EXPECT_EQ(white.rgba.at(0) & 0xFFFFFFU, 0xFFFFFFU);
}

TEST(ObjReader, TheUnitOfARemarkIsTakenOrSaid) {
  const ScanFolder folder;
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto read = [&](const std::string& remark) { return folder.read("u.obj", remark + "\n" + vertices); };
  EXPECT_EQ(read("# File units = millimeters").unit, scene::LengthUnit::mm);
  EXPECT_EQ(read("# made\n#  Units: cm").unit, scene::LengthUnit::cm);
  EXPECT_EQ(read("# unit=ft").unit, scene::LengthUnit::ft);
  const RawScan inches = read("# File units = inches");
  EXPECT_EQ(inches.unit, std::nullopt);
  EXPECT_THAT(inches.warnings, ElementsAre(AllOf(HasSubstr("'inches'"), HasSubstr("not converted"))));
  for (const char* other : {"# 4 united parts", "# units unknown", "# Units: generic", "# unit test of mm"}) {
    const RawScan scan = read(other);
    EXPECT_EQ(scan.unit, std::nullopt) << other;
    EXPECT_THAT(scan.warnings, IsEmpty()) << other;
  }
}

TEST(ObjReader, OfSeveralUnitsNoneIsTaken) {
  const ScanFolder folder;
  const std::string body = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(folder.read("a.obj", "# File units = mm\n# units: mm\n" + body).unit, scene::LengthUnit::mm);
  const RawScan scan = folder.read("b.obj", "# File units = mm\n# File units = m\n# units: cm\n" + body);
  EXPECT_EQ(scan.unit, std::nullopt);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("neither is taken")));
}

}  // namespace
}  // namespace sparsha::pipeline
