// The cross-check's map against means taken place by place.
#include "pipeline/check/check_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/checked_cloud.h"

namespace sparsha::pipeline {
namespace {

using testing::grid_of;
using testing::lattice_of;

TEST(CheckMap, IsTheMeanErrorOfItsSurroundingsAndEmptyOffTheSurface) {
  // Twice as far on the right half; a third of the nodes judged; a corner that was never measured.
  const scene::Lattice lattice = lattice_of(90, 70, 0.001);
  scene::DepthGrid grid = grid_of(lattice, [](double, double) { return 0.0; });
  CheckResult check;
  std::mt19937 random(5);
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t n = lattice.index(i, j);
      if (i < 20 && j < 20) {
        grid.state[n] = scene::NodeState::unknown;
        grid.height_m[n] = scene::kUnknownHeight;
      } else if (random() % 3 == 0) {
        check.node_errors.node.push_back(n);
        check.node_errors.error_m.push_back(i < 45 ? 1e-4F : 2e-4F);
        ++check.cloud_to_surface.samples;
      }
    }
  check.cloud_to_surface.p95_m = 2e-4;
  const auto map = check_map_of(grid, check);
  ASSERT_TRUE(map);
  EXPECT_EQ(map->lattice.nx, 90) << "small grids are not made coarser";
  EXPECT_EQ(map->high_m, 2e-4);
  EXPECT_TRUE(std::isnan(map->at(lattice.x_m(5), lattice.y_m(5))));
  int empty = 0;
  for (int j = 25; j < 65; ++j) {
    for (int i : {25, 30, 35, 38}) EXPECT_NEAR(map->at(lattice.x_m(i), lattice.y_m(j)), 1e-4, 1e-9);
    for (int i : {52, 60, 85}) {
      const float value = map->at(lattice.x_m(i), lattice.y_m(j));
      if (std::isnan(value))
        ++empty;
      else
        EXPECT_NEAR(value, 2e-4, 1e-9);
    }
  }
  EXPECT_LT(empty, 12) << "spots are wide enough to hold samples";
}

TEST(CheckMap, OfALargeGridIsCoarseAndLiesWhereTheGridLies) {
  const scene::Lattice lattice = lattice_of(1301, 700, 0.001);
  const scene::DepthGrid grid = grid_of(lattice, [](double, double) { return 0.0; });
  CheckResult check;
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      check.node_errors.node.push_back(lattice.index(i, j));
      check.node_errors.error_m.push_back(static_cast<float>(1e-6 * i));
    }
  check.cloud_to_surface.samples = lattice.count();
  const auto map = check_map_of(grid, check);
  ASSERT_TRUE(map);
  EXPECT_EQ(map->lattice.nx, 434);
  EXPECT_EQ(map->lattice.ny, 234);
  // A linear error is its own mean over a block, whose middle counts.
  for (int i = 10; i < 1290; i += 7) EXPECT_NEAR(map->at(lattice.x_m(i), lattice.y_m(350)), 1e-6 * i, 1.6e-6) << i;
  EXPECT_FALSE(std::isnan(map->at(lattice.x_m(1300), lattice.y_m(699))));
  EXPECT_TRUE(std::isnan(map->at(lattice.x_m(1300) + 0.1, lattice.y_m(0))));
}

TEST(CheckMap, WithoutSamplesThereIsNone) {
  const scene::DepthGrid grid = grid_of(lattice_of(10, 10, 0.001), [](double, double) { return 0.0; });
  EXPECT_EQ(check_map_of(grid, {}), nullptr);
}

}  // namespace
}  // namespace sparsha::pipeline
