// Where a scanner stood, as files and poses say it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "base/files/files.h"
#include "base/threads/progress.h"
#include "pipeline/scan/set.h"
#include "tests/support/raster_scan.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

using test::TestFolder;

scene::ScanConfig scan_of(const std::filesystem::path& file) {
  scene::ScanConfig scan;
  scan.file = file;
  scan.units.unit = scene::LengthUnit::m;
  return scan;
}

std::vector<Station> stations_of(const std::vector<scene::ScanConfig>& scans, ScanSet::Keep keep) {
  Progress progress;
  return ScanSet(scans, keep, false, progress).stations();
}

/// A grid of 2 x `rows` points at height `z`, from a scanner at (x, y, 5), not turned.
std::string ptx_scan(double x, double y, double z, int rows) {
  std::string text =
      fmt::format("2\n{0}\n{1} {2} 5\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n{1} {2} 5 1\n", rows, x, y);
  for (int k = 0; k < 2 * rows; ++k) text += fmt::format("{} {} {} 0.5\n", 1 + k % 2, k / 2, z - 5.0);
  return text;
}

TEST(Stations, OfAPtxFileAreItsScannersEachWithItsOwnPoints) {
  const TestFolder folder;
  write_file(folder / "two.ptx", ptx_scan(10.0, 0.0, 1.0, 3) + ptx_scan(-20.0, 7.0, 2.0, 4000));
  for (const auto keep : {ScanSet::Keep::quickest, ScanSet::Keep::disk}) {
    const std::vector<Station> stations = stations_of({scan_of(folder / "two.ptx")}, keep);
    ASSERT_EQ(stations.size(), 2U);
    EXPECT_TRUE(stations[0].place_m.isApprox(Eigen::Vector3d(10, 0, 5)));
    EXPECT_TRUE(stations[1].place_m.isApprox(Eigen::Vector3d(-20, 7, 5)));
    EXPECT_TRUE(stations[0].declared);
    EXPECT_EQ(stations[0].seen_m.size(), 6U);
    for (const Eigen::Vector3d& p : stations[0].seen_m) EXPECT_NEAR(p.z(), 1.0, 1e-12);
    EXPECT_GE(stations[1].seen_m.size(), 4000U);
    for (const Eigen::Vector3d& p : stations[1].seen_m) EXPECT_NEAR(p.z(), 2.0, 1e-12);
  }
}

TEST(Stations, AreProvedByTheOrderOfAScannersPoints) {
  const TestFolder folder;
  const test::RasterScan scan = test::scan_from({1.5, -0.4, 0.2}, test::free_in_cave, 0.02);
  write_file(folder / "cave.ptx", test::ptx_of({scan}));
  std::string text;
  for (const Eigen::Vector3d& p : scan.seen) {
    if (!p.isZero(0.0)) text += fmt::format("{:.4f} {:.4f} {:.4f}\n", p.x(), p.y(), p.z());
  }
  write_file(folder / "ordered.xyz", text);
  write_file(folder / "grid.ptx", ptx_scan(10.0, 0.0, 1.0, 4000));
  scene::ScanConfig posed = scan_of(folder / "ordered.xyz");
  posed.pose.topRightCorner<3, 1>() = scan.place;
  for (const auto keep : {ScanSet::Keep::quickest, ScanSet::Keep::disk}) {
    EXPECT_TRUE(stations_of({scan_of(folder / "cave.ptx")}, keep).at(0).proved);
    EXPECT_TRUE(stations_of({posed}, keep).at(0).proved);
    EXPECT_FALSE(stations_of({scan_of(folder / "grid.ptx")}, keep).at(0).proved);
  }
}

TEST(Stations, MoveWithUnitsAndPoseOfTheirScan) {
  const TestFolder folder;
  write_file(folder / "a.ptx", ptx_scan(10.0, 0.0, 1.0, 3));
  scene::ScanConfig scan = scan_of(folder / "a.ptx");
  scan.units.unit = scene::LengthUnit::mm;
  scan.pose << 0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1;
  const std::vector<Station> stations = stations_of({scan}, ScanSet::Keep::disk);
  ASSERT_EQ(stations.size(), 1U);
  EXPECT_LT((stations[0].place_m - Eigen::Vector3d(1.0, 2.010, 3.005)).norm(), 1e-12);
  for (const Eigen::Vector3d& p : stations[0].seen_m) EXPECT_NEAR(p.z(), 3.001, 1e-12);
}

std::string pcd(const std::string& viewpoint) {
  return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\nVIEWPOINT " + viewpoint +
         "\nPOINTS 3\nDATA ascii\n0 0 0\n1 0 0\n0 1 0\n";
}

TEST(Stations, OfAPcdFileAreItsViewpointUnlessThatIsTheDefault) {
  const TestFolder folder;
  write_file(folder / "seen.pcd", pcd("0 -2 4 1 0 0 0"));
  write_file(folder / "default.pcd", pcd("0 0 0 1 0 0 0"));
  for (const auto keep : {ScanSet::Keep::quickest, ScanSet::Keep::disk}) {
    const std::vector<Station> stations =
        stations_of({scan_of(folder / "default.pcd"), scan_of(folder / "seen.pcd")}, keep);
    ASSERT_EQ(stations.size(), 1U);
    EXPECT_EQ(stations[0].scan, (folder / "seen.pcd").string());
    EXPECT_EQ(stations[0].place_m, Eigen::Vector3d(0, -2, 4));
    EXPECT_EQ(stations[0].seen_m.size(), 3U);
  }
}

TEST(Stations, AViewpointIsSaidWithThePoseThatMovesThePointsAndThatPoseAnswersIt) {
  const TestFolder folder;
  // A quarter turn about z, and a place.
  const std::string turned = "10 -2 4 0.7071067811865476 0 0 0.7071067811865476";
  write_file(folder / "turned.pcd", pcd(turned));
  const auto warnings_of = [](const scene::ScanConfig& scan, std::vector<Station>& stations) {
    Progress progress;
    const ScanSet set({scan}, ScanSet::Keep::quickest, false, progress);
    stations = set.stations();
    return progress.warnings();
  };
  const auto told = ::testing::HasSubstr(
      "'pose: {translate: [10, -2, 4], quaternion: [0, 0, 0.707106781, 0.707106781]}' of the scan");
  std::vector<Station> stations;
  EXPECT_THAT(warnings_of(scan_of(folder / "turned.pcd"), stations), ::testing::Contains(told));
  EXPECT_THAT(inspect_scan(folder / "turned.pcd").warnings, ::testing::Contains(told));
  scene::ScanConfig posed = scan_of(folder / "turned.pcd");
  posed.pose << 0, -1, 0, 10, 1, 0, 0, -2, 0, 0, 1, 4, 0, 0, 0, 1;
  EXPECT_THAT(warnings_of(posed, stations), ::testing::Not(::testing::Contains(told)));
  ASSERT_EQ(stations.size(), 1U);
  EXPECT_EQ(stations[0].place_m, Eigen::Vector3d(10, -2, 4)) << "the scanner is the origin of its own frame";
  posed.pose << 1, 0, 0, 100, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_THAT(warnings_of(posed, stations), ::testing::Not(::testing::Contains(told)));
  ASSERT_EQ(stations.size(), 1U);
  EXPECT_EQ(stations[0].place_m, Eigen::Vector3d(110, -2, 4)) << "another pose moves the viewpoint with the points";
  for (const std::string still : {"0 0 0 1 0 0 0", "0 0 0 -1 0 0 0", "0 0 0 0 0 0 0"}) {
    write_file(folder / "still.pcd", pcd(still));
    EXPECT_THAT(inspect_scan(folder / "still.pcd").warnings,
                ::testing::Not(::testing::Contains(::testing::HasSubstr("viewpoint"))));
  }
}

TEST(Stations, OfAPosedScanIsWhereItsOriginWentButNotDeclared) {
  const TestFolder folder;
  write_file(folder / "a.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  scene::ScanConfig posed = scan_of(folder / "a.xyz");
  posed.pose.topRightCorner<3, 1>() = Eigen::Vector3d(4, 5, 6);
  const std::vector<Station> stations = stations_of({scan_of(folder / "a.xyz"), posed}, ScanSet::Keep::quickest);
  ASSERT_EQ(stations.size(), 1U) << "the scan without a pose says nothing";
  EXPECT_FALSE(stations[0].declared);
  EXPECT_EQ(stations[0].place_m, Eigen::Vector3d(4, 5, 6));
}

}  // namespace
}  // namespace sparsha::pipeline
