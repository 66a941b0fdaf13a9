// Caves and niches whose scanners stood within: files that say where, in the order of a scanner that turns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/files/files.h"
#include "base/threads/progress.h"
#include "base/threads/thread_pool.h"
#include "base/yaml/yaml.h"
#include "pipeline/charts/charts.h"
#include "pipeline/projection/projection.h"
#include "pipeline/scan/reader.h"
#include "pipeline/suggest/suggest.h"
#include "scene/charts.h"
#include "scene/config/config.h"
#include "tests/support/raster_scan.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::Not;

class FromWithin : public ::testing::Test {
 protected:
  Suggestion suggested(const std::vector<test::RasterScan>& scans) {
    write_file(folder_ / "scan.ptx", test::ptx_of(scans));
    return suggest_config({folder_ / "scan.ptx"}, folder_, progress_);
  }
  Projection projected(const scene::Config& config, const Eigen::Matrix4d& scan_to_grid) {
    const Cloud cloud = load_scans(config.scans, progress_);
    ThreadPool pool(2);
    return project(cloud, scan_to_grid, config.grid, config.haptics.resolution_m, {pool, progress_});
  }

  const test::TestFolder folder_;
  Progress progress_;
};

struct Judged {
  double measured = 0.0;   // of all nodes
  double off = 0.0;        // of the measured ones: more than 5 cm from the surface
  double from_behind = 0;  // turned away from the viewer
};

// By the function that the scans were made of, which knows nothing of points.
Judged judge(const scene::DepthGrid& grid, const Eigen::Matrix4d& scan_to_grid, const test::Free& free) {
  Judged judged;
  std::size_t measured = 0, off = 0, behind = 0;
  const Eigen::Matrix4d to_scan = scan_to_grid.inverse();
  const Vector3d viewer = to_scan.block<3, 1>(0, 2).normalized();
  for (int j = 0; j < grid.lattice.ny; ++j)
    for (int i = 0; i < grid.lattice.nx; ++i) {
      const std::size_t n = grid.lattice.index(i, j);
      if (grid.state[n] != scene::NodeState::measured) continue;
      const Vector3d node = grid.lattice.origin_m + Vector3d(i * grid.lattice.spacing_m, j * grid.lattice.spacing_m,
                                                             static_cast<double>(grid.height_m[n]));
      const Vector3d p = (to_scan * node.homogeneous()).head<3>();
      Vector3d rise;  // into the room
      for (int a = 0; a < 3; ++a) rise[a] = free(p + 1e-4 * Vector3d::Unit(a)) - free(p - 1e-4 * Vector3d::Unit(a));
      ++measured;
      off += std::abs(free(p)) > 0.05 ? 1 : 0;
      behind += rise.normalized().dot(viewer) < -0.2 ? 1 : 0;
    }
  const auto share = [](std::size_t part, std::size_t of) {
    return static_cast<double>(part) / static_cast<double>(of);
  };
  judged.measured = share(measured, grid.state.size());
  judged.off = share(off, measured);
  judged.from_behind = share(behind, measured);
  return judged;
}

const std::vector<test::RasterScan>& cave() {
  static const std::vector<test::RasterScan> scans = [] {
    std::vector<test::RasterScan> all;
    for (const Vector3d& place : {Vector3d(-2.5, 0.3, 0.0), Vector3d(0.0, -0.5, 0.1), Vector3d(2.6, 0.2, 0.0)})
      all.push_back(test::scan_from(place, test::free_in_cave, 0.015));
    return all;
  }();
  return scans;
}

TEST_F(FromWithin, ACaveIsLookedAtThroughItsNearerWallFromAnySide) {
  const Suggestion suggestion = suggested(cave());
  EXPECT_THAT(suggestion.yaml, HasSubstr("its scanners stood within"));
  EXPECT_THAT(suggestion.yaml, Not(HasSubstr("remove_plane")));
  const Eigen::Matrix4d first = suggestion.config.orientation.scan_to_grid;
  Eigen::Matrix4d other = first;
  other.row(0) *= -1.0;
  other.row(2) *= -1.0;
  for (const Eigen::Matrix4d& view : {first, other}) {
    const Projection projection = projected(suggestion.config, view);
    EXPECT_TRUE(projection.lying_stations.empty());
    EXPECT_TRUE(projection.facing_known);
    const Judged judged = judge(projection.grid, view, test::free_in_cave);
    EXPECT_GT(judged.measured, 0.7);
    EXPECT_LT(judged.off, 0.002);
    EXPECT_LT(judged.from_behind, 0.002);
    EXPECT_LT(projection.outlier, projection.used / 50) << "the nearer wall is hidden, and no heap of outliers";
  }
}

TEST_F(FromWithin, WithoutTheOrderOfItsPointsACaveIsSeenFromOutside) {
  std::vector<test::RasterScan> scans = cave();
  std::mt19937_64 random(7);
  for (test::RasterScan& scan : scans) std::shuffle(scan.seen.begin(), scan.seen.end(), random);
  const Suggestion suggestion = suggested(scans);
  EXPECT_THAT(suggestion.yaml, Not(HasSubstr("its scanners stood within")));
  const Projection projection = projected(suggestion.config, suggestion.config.orientation.scan_to_grid);
  EXPECT_FALSE(projection.lying_stations.empty()) << "a place within a solid object is not believed";
}

// Its ends have too few points for the samples that tell sides: that no scanner stood on their other side tells them.
TEST_F(FromWithin, ATunnelIsLookedIntoUpToItsEnds) {
  std::vector<test::RasterScan> scans;
  for (const Vector3d& place : {Vector3d(-3.2, 0.2, 0.0), Vector3d(0.0, -0.3, 0.1), Vector3d(3.1, 0.1, 0.0)})
    scans.push_back(test::scan_from(place, test::free_in_tunnel, 0.014));
  const Suggestion suggestion = suggested(scans);
  EXPECT_THAT(suggestion.yaml, HasSubstr("its scanners stood within"));
  const Eigen::Matrix4d view = suggestion.config.orientation.scan_to_grid;
  const Projection projection = projected(suggestion.config, view);
  const Judged judged = judge(projection.grid, view, test::free_in_tunnel);
  EXPECT_GT(judged.measured, 0.75);
  EXPECT_LT(judged.off, 0.002);
  EXPECT_LT(judged.from_behind, 0.03);
  EXPECT_LT(projection.outlier, projection.used / 25);
}

// Under its tripod a scanner sees no floor; what the others see of it there is sparse and lies by itself.
TEST_F(FromWithin, AsAWholeACaveHasNoFaceTurnedIntoTheStone) {
  write_file(folder_ / "scan.ptx", test::ptx_of(cave()));
  const scene::Config config =
      scene::parse_config(yaml::parse_text("scans: [{file: scan.ptx, units: m}]\n", "cave"), folder_.path());
  ThreadPool pool(2);
  const scene::Charts charts =
      make_charts(load_scans(config.scans, progress_), Eigen::Matrix4d::Identity(), config.grid, 0.0, {pool, progress_})
          .charts;
  std::size_t nodes = 0, wrong = 0;
  for (const scene::Sheet& sheet : charts.sheets)
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        const Vector3d before =
            charts.origin_m + charts.place_m(sheet, i, j) + 0.05 * scene::Charts::normal(sheet, i, j);
        ++nodes;
        wrong += test::free_in_cave(before) < 0.0 ? 1 : 0;
      }
  EXPECT_GT(nodes, 100'000U);
  EXPECT_LE(wrong, nodes / 5000);
}

TEST_F(FromWithin, ANicheIsSeenFromBeforeItAndItsWallStays) {
  const Suggestion suggestion = suggested({test::scan_from({0.0, -1.5, 0.6}, test::free_before_apse, 0.01),
                                           test::scan_from({0.8, -0.4, 0.5}, test::free_before_apse, 0.01)});
  EXPECT_THAT(suggestion.yaml, Not(HasSubstr("remove_plane: {normal: [0, 1, 0]")));
  const Eigen::Matrix4d view = suggestion.config.orientation.scan_to_grid;
  const Judged judged = judge(projected(suggestion.config, view).grid, view, test::free_before_apse);
  EXPECT_GT(judged.measured, 0.5);
  EXPECT_LT(judged.off, 0.02);
  EXPECT_LT(judged.from_behind, 0.005) << suggestion.yaml;
}

TEST_F(FromWithin, AStoneScannedFromAroundItIsNoRoom) {
  const auto stone = [](const Vector3d& p) {
    return (Vector3d(p.x() / 0.5, p.y() / 0.4, p.z() / 0.8).norm() - 1.0) * 0.4;
  };
  std::vector<test::RasterScan> scans;
  for (const double turn : {0.3, 2.4, 4.5})
    scans.push_back(test::scan_from({2.5 * std::cos(turn), 2.5 * std::sin(turn), 0.3}, stone, 0.003, 0.0005));
  const Suggestion suggestion = suggested(scans);
  EXPECT_THAT(suggestion.yaml, Not(HasSubstr("stood within")));
  const Eigen::Matrix4d view = suggestion.config.orientation.scan_to_grid;
  const Projection projection = projected(suggestion.config, view);
  EXPECT_TRUE(projection.lying_stations.empty());
  EXPECT_LT(judge(projection.grid, view, stone).from_behind, 0.002);
}

}  // namespace
}  // namespace sparsha::pipeline
