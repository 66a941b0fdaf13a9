// The rasters that the pipeline is compared with are right on clouds whose cells are known by hand.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "bench/pipeline/contest.h"
#include "bench/pipeline/rasters.h"
#include "tests/support/clouds.h"

namespace sparsha::bench {
namespace {

using Points = std::vector<std::array<double, 3>>;

constexpr RasterRule kRules[] = {RasterRule::max, RasterRule::mean, RasterRule::median, RasterRule::inverse_distance};

scene::Lattice lattice(int nx, int ny, double spacing = 1.0, Eigen::Vector3d origin = Eigen::Vector3d::Zero()) {
  return {nx, ny, spacing, origin};
}

double height(const scene::DepthGrid& grid, int i, int j) {
  return static_cast<double>(grid.height_m[grid.lattice.index(i, j)]) + grid.lattice.origin_m.z();
}

TEST(Rasters, OneCellOfFourPointsGivesItsMaximumMeanAndMedian) {
  const Points points{{0.1, 0.2, 1.0}, {-0.3, 0.4, 2.0}, {0.4, -0.4, 4.0}, {0.0, 0.0, 9.0}};
  EXPECT_EQ(height(raster(points, lattice(2, 2), RasterRule::max), 0, 0), 9.0);
  EXPECT_EQ(height(raster(points, lattice(2, 2), RasterRule::mean), 0, 0), 4.0);
  EXPECT_EQ(height(raster(points, lattice(2, 2), RasterRule::median), 0, 0), 4.0);
}

TEST(Rasters, InverseDistanceWeighsByTheSquareAndReachesOneAndAHalfCells) {
  const Points points{{0.5, 0.0, 4.0}, {0.0, -1.0, 9.0}, {-1.6, 0.0, 100.0}};
  // Weights 4 and 1; the third point is out of reach.
  EXPECT_NEAR(height(raster(points, lattice(2, 2), RasterRule::inverse_distance), 0, 0), (4.0 * 4.0 + 9.0) / 5.0, 1e-6);
}

TEST(Rasters, APointBelongsToTheNodeThatItIsNearestToAndCellsWithoutPointsAreUnknown) {
  const Points points{{0.49, 0.0, 1.0}, {0.51, 0.0, 2.0}, {-0.51, 0.0, 50.0}, {3.0, 3.0, 60.0}};
  for (const RasterRule rule : {RasterRule::max, RasterRule::mean, RasterRule::median}) {
    const scene::DepthGrid grid = raster(points, lattice(3, 2), rule);
    EXPECT_EQ(height(grid, 0, 0), 1.0);
    EXPECT_EQ(height(grid, 1, 0), 2.0);
    EXPECT_EQ(grid.state[grid.lattice.index(2, 1)], scene::NodeState::unknown);
    EXPECT_TRUE(std::isnan(grid.height_m[grid.lattice.index(2, 1)]));
  }
}

TEST(Rasters, EveryRuleGivesALevelPlaneBackWhereverItLies) {
  Points points;
  std::mt19937_64 random(3);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (int k = 0; k < 20000; ++k) points.push_back({450000.0 + uniform(), 5412000.0 + uniform(), 312.25});
  for (const RasterRule rule : kRules) {
    const scene::DepthGrid grid = raster(points, lattice(11, 11, 0.1, {450000.0, 5412000.0, 312.0}), rule);
    for (int j = 0; j < 11; ++j)
      for (int i = 0; i < 11; ++i) EXPECT_NEAR(height(grid, i, j), 312.25, 1e-6) << name_of(rule);
  }
}

TEST(Contest, EveryContestantRunsEveryRoundButSlowOnesAndRatiosReferToTheFirst) {
  int fast = 0, slow = 0;
  const auto grid = [] { return scene::DepthGrid(lattice(2, 2)); };
  const std::vector<ContestRow> rows =
      contest({{"a", false, [&] { return ++fast, grid(); }}, {"b", true, [&] { return ++slow, grid(); }}}, 5, 2);
  EXPECT_EQ(fast, 5);
  EXPECT_EQ(slow, 2);
  EXPECT_EQ(rows[0].method, "a");
  EXPECT_EQ(rows[0].ratio, 1.0);
  EXPECT_EQ(rows[0].ratio_low, 1.0);
  EXPECT_EQ(rows[1].rounds, 2);
  EXPECT_GT(rows[1].ratio_high, 0.0);
  EXPECT_GE(rows[1].ratio_high, rows[1].ratio_low);
}

TEST(Contest, MovingLeastSquaresOfPclTakesNoiseAwayAndKeepsAPlaneInItsPlace) {
  test::Points points;
  for (int j = 0; j < 60; ++j)
    for (int i = 0; i < 60; ++i)
      points.push_back({0.01 * i, 0.01 * j, 0.3 * 0.01 * i + 0.0005 * std::sin(91.0 * i + 37.0 * j * j)});
  const pipeline::Cloud cloud = test::make_cloud(points);
  scene::GridConfig config;
  config.spacing_m = 0.01;
  const std::vector<Contestant> all = contestants_of(cloud, points, config, 0.0001, lattice(60, 60, 0.01), 0.01);
  ASSERT_EQ(all.size(), 7U);
  const auto rms = [](const scene::DepthGrid& grid) {
    double squares = 0.0;
    int count = 0;
    for (int j = 5; j < 55; ++j)
      for (int i = 5; i < 55; ++i, ++count) squares += std::pow(height(grid, i, j) - 0.3 * 0.01 * i, 2);
    return std::sqrt(squares / count);
  };
  const double raw = rms(all[2].run()), smoothed = rms(all[5].run());
  EXPECT_EQ(all[2].method, "mean");
  EXPECT_NEAR(raw, 0.0005 / std::sqrt(2.0), 0.00005);
  EXPECT_LT(smoothed, 0.6 * raw);
}

}  // namespace
}  // namespace sparsha::bench
