// Files that are not what they seem, or only just: nothing is lost, doubled or made up without a word.
#include <gmock/gmock.h>

#include <cstring>

#include "pipeline/scan/formats/pcd/lzf.h"
#include "pipeline/scan/statistics.h"
#include "pipeline/scan/writer.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using testing::error_of_bytes;
using testing::expect_refused;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::put;
using testing::ScanFolder;

const std::string kPlyHead = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n";

TEST(ScanReader, KeepsTheFirstRowBehindAByteOrderMark) {
  const ScanFolder folder;
  EXPECT_EQ(folder.read("a.obj", "\xEF\xBB\xBFv 1 2 3\nv 4 5 6\n").records, 2U);
  EXPECT_EQ(folder.read("b.obj", "\xEF\xBB\xBF\xEF\xBB\xBFv 1 2 3\nv 4 5 6\n").records, 2U) << "marks may be doubled";
  EXPECT_EQ(folder
                .read("a.csv",
                      "\xEF\xBB\xBF"
                      "1,2,3\n4,5,6\n")
                .records,
            2U);
  EXPECT_EQ(folder
                .read("a.ptx",
                      "\xEF\xBB\xBF"
                      "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
                      "1 2 3 0.5\n")
                .format,
            "PTX text");
}

TEST(ScanReader, NamesArchivesAndPicturesForWhatTheyAre) {
  const auto refuse = [](const char* name, std::string_view bytes, const char* message) {
    expect_refused(name, bytes, message);
  };
  refuse("a.ply", {"\x1F\x8B\x08\0\0", 5}, "a gzip archive");
  refuse("a.xyz", {"PK\x03\x04\0", 5}, "a zip archive");
  refuse("a.e57", "%PDF-1.4\n1 2 3\n", "a PDF document");
  refuse("a.obj", "\xFF\xD8\xFF\xE0", "a JPEG picture");
}

TEST(PlyReader, ReadsBlanksBehindItsFirstWordAndCommentsOfManyBytes) {
  const ScanFolder folder;
  EXPECT_EQ(folder.read("a.ply", "ply \t\nformat ascii 1.0\n" + kPlyHead + "1 2 3\n").records, 1U);
  const std::string comment = "comment " + std::string(20000, 'a') + "\n";
  EXPECT_EQ(folder.read("b.ply", "ply\nformat ascii 1.0\n" + comment + kPlyHead + "1 2 3\n").records, 1U);
  const auto error = error_of_bytes("c.ply", "ply\nformat ascii 1.0\ncomment " + std::string(1 << 20, 'a') + "\n");
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), HasSubstr("longer than 65536 bytes"));
  EXPECT_EQ(error->place().line, 3);
}

TEST(ScanReader, RefusesACoordinateThatIsThereTwice) {
  const auto ply = error_of_bytes("a.ply",
                                  "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                  "property float x\nproperty float y\nproperty float z\nend_header\n1 2 3 4\n");
  ASSERT_TRUE(ply);
  EXPECT_THAT(ply->what(), HasSubstr("'x' twice"));
  const auto pcd = error_of_bytes("a.pcd", "VERSION 0.7\nFIELDS x y z y\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3 4\n");
  ASSERT_TRUE(pcd);
  EXPECT_THAT(pcd->what(), HasSubstr("'y' twice"));
}

TEST(ScanReader, SaysWhatACountThatIsTooSmallLeavesOut) {
  const ScanFolder folder;
  std::string two;
  for (const float value : {1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F}) put(two, value);
  EXPECT_THAT(folder.read("a.ply", "ply\nformat ascii 1.0\n" + kPlyHead + "1 2 3\n4 5 6\n").warnings,
              ElementsAre(HasSubstr("more lines than its header has records")));
  EXPECT_THAT(folder.read("b.ply", "ply\nformat binary_little_endian 1.0\n" + kPlyHead + two).warnings,
              ElementsAre(HasSubstr("12 bytes behind the last record")));
  EXPECT_THAT(folder.read("c.ply", "ply\nformat ascii 1.0\n" + kPlyHead + "1 2 3\n\n \n").warnings, IsEmpty());
  EXPECT_THAT(folder.read("a.pcd", "VERSION 0.7\nFIELDS x y z\nWIDTH 1\nHEIGHT 1\nDATA binary\n" + two).warnings,
              ElementsAre(HasSubstr("room for 2 points, its header promises 1")));
}

TEST(StlReader, RefusesACountOfZeroBeforeTriangles) {
  std::string bytes(80, ' ');
  put(bytes, std::uint32_t{0});
  bytes += std::string(100, '\1');
  const auto error = error_of_bytes("a.stl", bytes);
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), HasSubstr("promises no triangles, the file has room for 2"));
}

/// A LAS 1.x header of point format 0 whose points begin at byte `first`.
std::string las(int minor, std::uint32_t first, std::uint32_t claimed, std::uint64_t claimed64, int points) {
  const std::size_t size = minor == 4 ? 375 : 227;
  std::string bytes(size + 20 * static_cast<std::size_t>(points), '\0');
  const auto set = [&](std::size_t at, auto value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
  bytes.replace(0, 4, "LASF");
  set(24, std::uint8_t{1});
  set(25, static_cast<std::uint8_t>(minor));
  set(94, static_cast<std::uint16_t>(size));
  set(96, first);
  set(105, std::uint16_t{20});
  set(107, claimed);
  for (std::size_t k = 0; k < 3; ++k) set(131 + 8 * k, 0.01);
  if (minor == 4) set(247, claimed64);
  return bytes;
}

TEST(LasReader, NeverTakesItsHeaderForPoints) {
  const auto error = error_of_bytes("a.las", las(2, 100, 2, 0, 2));
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), HasSubstr("begin at byte 100, within the header of 227 bytes"));
}

TEST(LasReader, SaysThatCountsDisagreeOrLeavePointsOut) {
  const ScanFolder folder;
  EXPECT_THAT(folder.read("a.las", las(2, 227, 2, 0, 3)).warnings, ElementsAre(HasSubstr("room for 3 points")));
  const RawScan both = folder.read("b.las", las(4, 375, 2, 3, 3));
  EXPECT_EQ(both.records, 3U);
  EXPECT_THAT(both.warnings, ElementsAre(HasSubstr("promises 3 points, in its old place 2")));
  EXPECT_THAT(folder.read("c.las", las(4, 375, 3, 0, 3)).warnings, IsEmpty());
}

TEST(PtxReader, TellsOfMatricesThatAreNoPosesAndRefusesSingularOnes) {
  const ScanFolder folder;
  const std::string head = "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  const std::string point = "1 2 3 0.5\n";
  EXPECT_THAT(folder.read("a.ptx", head + "2 0 0 0\n0 2 0 0\n0 0 2 0\n0 0 0 1\n" + point).warnings,
              ElementsAre(HasSubstr("scales or shears")));
  EXPECT_THAT(folder.read("b.ptx", head + "-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n" + point).warnings,
              ElementsAre(HasSubstr("mirrors")));
  EXPECT_THAT(folder.read("c.ptx", head + "0.8 0.6 0 0\n-0.6 0.8 0 0\n0 0 1 0\n0 0 0 1\n" + point).warnings, IsEmpty());
  const auto singular = error_of_bytes("d.ptx", head + "1 0 0 0\n0 1 0 0\n0 0 0 0\n0 0 0 1\n" + point);
  ASSERT_TRUE(singular);
  EXPECT_THAT(singular->what(), HasSubstr("singular"));
  const auto projective = error_of_bytes("e.ptx", head + "1 0 0 0\n0 1 0 0.5\n0 0 1 0\n0 0 0 1\n" + point);
  ASSERT_TRUE(projective);
  EXPECT_THAT(projective->what(), HasSubstr("not affine"));
  EXPECT_EQ(projective->place().line, 8);
}

TEST(Lzf, KnowsTheLengthOfAStreamBeforeItTakesMemory) {
  const std::string stream(
      "\x02"
      "abc\x20\x02\xE0\x05\x00",
      9);
  std::string out(3 + 3 + 14, '?');
  EXPECT_EQ(lzf_output_size(stream), out.size());
  EXPECT_TRUE(lzf_decompress(stream, out));
  const std::string cut = stream.substr(0, 7);
  EXPECT_LT(lzf_output_size(cut), out.size());
}

TEST(Faces, OfMoreCornersThanAnyPolygonHasAreRefusedInEveryFormat) {
  const std::size_t many = ScanWriter::kMostCorners + 1;
  const std::string head =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list int int vertex_indices\nend_header\n";
  std::string corners;
  for (std::size_t k = 0; k < many; ++k) corners += std::to_string(k % 3 + 1) + " ";
  const auto ply = error_of_bytes("a.ply", "ply\nformat ascii 1.0\n" + head + "0 0 0\n1 0 0\n0 1 0\n" +
                                               std::to_string(many) + " " + corners + "\n");
  ASSERT_TRUE(ply);
  EXPECT_THAT(ply->what(), HasSubstr("a face of 65537 corners"));
  EXPECT_EQ(ply->place().line, 13);
  std::string bytes(3 * 12 + 4 + 4 * many, '\0');
  const auto count = static_cast<std::int32_t>(many);
  std::memcpy(bytes.data() + 36, &count, 4);
  const auto binary = error_of_bytes("b.ply", "ply\nformat binary_little_endian 1.0\n" + head + bytes);
  ASSERT_TRUE(binary);
  EXPECT_THAT(binary->what(), HasSubstr("a face of 65537 corners"));
  const auto obj = error_of_bytes("c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + corners + "\n");
  ASSERT_TRUE(obj);
  EXPECT_THAT(obj->what(), HasSubstr("more than 65536 corners"));
  EXPECT_EQ(obj->place().line, 4);
}

// Each search among duplicates that fill a leaf of the tree would look at all of them.
TEST(MedianSpacing, OfAPointRepeatedAMillionTimesIsThatOfTheOthers) {
  std::vector<Eigen::Vector3d> points(1'000'000, Eigen::Vector3d(0.5, 0.5, 0.5));
  EXPECT_EQ(median_spacing(points), 0.0);
  for (int i = 0; i < 100; ++i)
    for (int k = 0; k < 100; ++k) points.emplace_back(i * 0.25, k * 0.25, 0.0);
  EXPECT_EQ(median_spacing(points), 0.25);
}

}  // namespace
}  // namespace sparsha::pipeline
