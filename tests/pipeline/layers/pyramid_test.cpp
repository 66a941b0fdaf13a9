// Levels: where their nodes lie, what they keep, and that nothing is invented.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <numbers>

#include "pipeline/layers/layers.h"
#include "tests/support/grids.h"

namespace sparsha::pipeline {
namespace {

using testing::add_noise;
using testing::forget;
using testing::grid_of;
using testing::lattice_of;

constexpr double kPi = std::numbers::pi;

scene::Layers layers_of(scene::DepthGrid grid) {
  scene::Layers layers;
  layers.grid = std::move(grid);
  return layers;
}

double peak(const scene::DepthGrid& grid, int margin) {
  double most = 0;
  for (int j = margin; j < grid.lattice.ny - margin; ++j)
    for (int i = margin; i < grid.lattice.nx - margin; ++i)
      most = std::max(most, std::abs(static_cast<double>(grid.height_m[grid.lattice.index(i, j)])));
  return most;
}

TEST(Pyramid, PutsNodesOfLevelLOnEveryTwoToTheLth) {
  scene::Lattice lattice = lattice_of(801, 530, 0.00125);
  lattice.origin_m = {3.0, -2.0, 7.0};
  const auto plane = [](double x, double y) { return 0.3 * x - 0.9 * y + 0.1; };
  ThreadPool pool(2);
  const std::vector<scene::Layers> levels = build_pyramid(layers_of(grid_of(lattice, plane)), 200, pool);
  ASSERT_EQ(levels.size(), 3U);  // 401, 201, 101
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const int step = 2 << k;
    const scene::Lattice& coarse = levels[k].grid.lattice;
    EXPECT_EQ(coarse.nx, (801 + step - 1) / step);
    EXPECT_EQ(coarse.ny, (530 + step - 1) / step);
    EXPECT_DOUBLE_EQ(coarse.spacing_m, step * lattice.spacing_m);
    EXPECT_EQ(coarse.origin_m, lattice.origin_m);
    // A plane stays itself, borders included; heights stay metres.
    for (int j = 0; j < coarse.ny; ++j)
      for (int i = 0; i < coarse.nx; ++i) {
        EXPECT_EQ(levels[k].grid.state[coarse.index(i, j)], scene::NodeState::measured);
        ASSERT_NEAR(levels[k].grid.height_m[coarse.index(i, j)], plane(i * coarse.spacing_m, j * coarse.spacing_m),
                    2e-6);
      }
  }
}

TEST(Pyramid, StopsWhereTheWindowHoldsTheLevel) {
  ThreadPool pool(1);
  const auto zero = [](double, double) { return 0; };
  EXPECT_TRUE(build_pyramid(layers_of(grid_of(lattice_of(200, 10, 1), zero)), 200, pool).empty());
  EXPECT_EQ(build_pyramid(layers_of(grid_of(lattice_of(10, 201, 1), zero)), 200, pool).size(), 1U);
  EXPECT_EQ(build_pyramid(layers_of(grid_of(lattice_of(3, 3, 1), zero)), 1, pool).back().grid.lattice.nx, 2);
}

TEST(Pyramid, StopsAtALevelThatCanStillBeTouched) {
  ThreadPool pool(1);
  const auto zero = [](double, double) { return 0; };
  // 5 x 450, 3 x 225, 2 x 113; half of that would be a single column.
  const std::vector<scene::Layers> strip = build_pyramid(layers_of(grid_of(lattice_of(5, 450, 1), zero)), 50, pool);
  ASSERT_EQ(strip.size(), 2U);
  EXPECT_EQ(strip.back().grid.lattice.nx, 2);
  EXPECT_EQ(strip.back().grid.lattice.ny, 113);
  // Scattered nodes are less than half of what a coarser node stands for.
  scene::DepthGrid scattered = grid_of(lattice_of(300, 300, 1), zero);
  for (int j = 0; j < 300; ++j)
    for (int i = 0; i < 300; ++i)
      if (i % 4 > 1 || j % 4 > 1) forget(scattered, i, j);
  EXPECT_TRUE(build_pyramid(layers_of(scattered), 50, pool).empty());
}

TEST(Pyramid, LetsWavesBeyondTheCoarseNyquistVanish) {
  ThreadPool pool(1);
  for (const double frequency : {0.30, 0.34, 0.38, 0.42, 0.45, 0.49}) {  // cycles per node; the coarse Nyquist is 0.25
    const scene::DepthGrid grid =
        grid_of(lattice_of(301, 301, 1), [&](double x, double) { return std::sin(2 * kPi * frequency * x + 0.3); });
    const double left = peak(build_pyramid(layers_of(grid), 200, pool)[0].grid, 3);
    const double response = std::pow(std::cos(kPi * frequency), 6);
    EXPECT_LT(left, response + 1e-6);
    EXPECT_LT(left, 0.05) << frequency;
    // What plain decimation would have felt as vibration:
    double decimated = 0;
    for (int i = 0; i < 301; i += 2) decimated = std::max(decimated, std::abs(std::sin(2 * kPi * frequency * i + 0.3)));
    EXPECT_GT(decimated, 0.9);
  }
}

TEST(Pyramid, KeepsWavesThatTheCoarseLevelCanShow) {
  ThreadPool pool(1);
  const scene::DepthGrid grid = grid_of(lattice_of(301, 301, 1), [](double x, double y) {
    return std::sin(2 * kPi * x / 40) * std::cos(2 * kPi * y / 50);
  });
  EXPECT_GT(peak(build_pyramid(layers_of(grid), 200, pool)[0].grid, 3), 0.94);
}

/// Sign changes of the discrete second derivative along all rows.
int zero_crossings(const scene::DepthGrid& grid) {
  int count = 0;
  for (int j = 4; j < grid.lattice.ny - 4; ++j) {
    double before = 0;
    for (int i = 4; i < grid.lattice.nx - 4; ++i) {
      const float* z = grid.height_m.data() + grid.lattice.index(i, j);
      const double bend = static_cast<double>(z[1]) - 2.0 * z[0] + z[-1];
      if (std::abs(bend) < 1e-7) continue;
      if (before * bend < 0) ++count;
      before = bend;
    }
  }
  return count;
}

TEST(Pyramid, InventsNoZeroCrossingsOfTheLaplacian) {
  // Along rows of a surface that varies along rows only, each level must have at most as many as the finer one.
  ThreadPool pool(1);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> phase(0, 2 * kPi);
  for (int round = 0; round < 20; ++round) {
    std::vector<std::array<double, 3>> waves;
    for (int k = 1; k < 60; ++k) waves.push_back({1.0 / k, k * 0.008, phase(random)});
    const scene::DepthGrid grid = grid_of(lattice_of(801, 20, 1), [&](double x, double) {
      double z = x > 400 ? 3.0 : 0.0;  // a step, where filters with negative lobes ring
      for (const auto& [a, q, p] : waves) z += a * std::sin(q * x + p);
      return z;
    });
    const std::vector<scene::Layers> levels = build_pyramid(layers_of(grid), 40, pool);
    int finer = zero_crossings(grid) / (grid.lattice.ny - 8);
    for (const scene::Layers& level : levels) {
      if (level.grid.lattice.ny <= 8) break;
      const int coarser = zero_crossings(level.grid) / (level.grid.lattice.ny - 8);
      EXPECT_LE(coarser, finer);
      finer = coarser;
    }
  }
}

TEST(Pyramid, NeverOvershootsAStep) {
  ThreadPool pool(1);
  const scene::DepthGrid grid = grid_of(lattice_of(401, 60, 1), [](double x, double) { return x > 200 ? 1.0 : 0.0; });
  for (const scene::Layers& level : build_pyramid(layers_of(grid), 50, pool))
    for (const float z : level.grid.height_m) {
      EXPECT_GE(z, -1e-6F);
      EXPECT_LE(z, 1 + 1e-6F);
    }
}

TEST(Pyramid, MarksMostlyMeasuredSupportMeasuredAndKeepsUnknownUnknown) {
  scene::DepthGrid grid = grid_of(lattice_of(120, 120, 1), [](double x, double y) { return 0.5 * x + 0.25 * y; });
  for (int j = 0; j < 120; ++j)
    for (int i = 0; i < 120; ++i) {
      if (i >= 40 && i < 80) grid.state[grid.lattice.index(i, j)] = scene::NodeState::filled;
      if (i >= 80) forget(grid, i, j);
    }
  ThreadPool pool(2);
  const scene::DepthGrid level = build_pyramid(layers_of(grid), 100, pool)[0].grid;
  for (int j = 0; j < 60; ++j) {
    EXPECT_EQ(level.state[level.lattice.index(10, j)], scene::NodeState::measured);
    EXPECT_EQ(level.state[level.lattice.index(30, j)], scene::NodeState::filled);
    EXPECT_EQ(level.state[level.lattice.index(50, j)], scene::NodeState::unknown);
    for (int i = 0; i < 60; ++i) {
      const std::size_t n = level.lattice.index(i, j);
      EXPECT_EQ(std::isnan(level.height_m[n]), level.state[n] == scene::NodeState::unknown);
      // A slope stays a slope up to the edge of what is known.
      if (level.state[n] != scene::NodeState::unknown) {
        EXPECT_NEAR(level.height_m[n], i + 0.5 * j, 1e-4);
      }
    }
  }
}

TEST(Pyramid, CarriesTheOptionalLayers) {
  const scene::Lattice lattice = lattice_of(121, 101, 1);
  scene::Layers base = layers_of(grid_of(lattice, [](double x, double) { return x; }));
  base.envelope_m = base.grid.height_m;
  base.curvature_per_m.assign(lattice.count(), 2.0F);
  base.mean_curvature_per_m.assign(lattice.count(), -1.0F);
  base.gaussian_curvature_per_m2.assign(lattice.count(), 0.5F);
  base.intensity.assign(lattice.count(), 0.25F);
  base.intensity[lattice.index(60, 50)] = scene::kUnknownHeight;
  base.colour_rgba.assign(lattice.count(), 0xFF804020U);
  base.colour_rgba[lattice.index(60, 50)] = 0;
  forget(base.grid, 20, 20);
  base.envelope_m[lattice.index(20, 20)] = scene::kUnknownHeight;
  ThreadPool pool(1);
  const scene::Layers level = build_pyramid(base, 100, pool)[0];
  EXPECT_EQ(level.envelope_m, level.grid.height_m);
  EXPECT_THAT(level.curvature_per_m, ::testing::Each(::testing::FloatNear(2, 1e-6F)));
  EXPECT_THAT(level.mean_curvature_per_m, ::testing::Each(::testing::FloatNear(-1, 1e-6F)));
  EXPECT_THAT(level.gaussian_curvature_per_m2, ::testing::Each(::testing::FloatNear(0.5F, 1e-6F)));
  EXPECT_THAT(level.intensity, ::testing::Each(::testing::FloatNear(0.25F, 1e-6F)));
  EXPECT_THAT(level.colour_rgba, ::testing::Each(0xFF804020U));
  EXPECT_TRUE(build_pyramid(layers_of(base.grid), 100, pool)[0].envelope_m.empty());
}

TEST(Pyramid, LeavesUndecidedCurvatureOutOfMeansAndKeepsItWhereThereIsNoOther) {
  const scene::Lattice lattice = lattice_of(121, 101, 1);
  scene::Layers base = layers_of(grid_of(lattice, [](double x, double) { return x; }));
  base.curvature_per_m.assign(lattice.count(), 2.0F);
  base.curvature_per_m[lattice.index(41, 40)] = scene::kUnknownHeight;
  for (int j = 60; j < 80; ++j)
    for (int i = 60; i < 80; ++i) base.curvature_per_m[lattice.index(i, j)] = scene::kUnknownHeight;
  ThreadPool pool(1);
  const scene::Layers level = build_pyramid(base, 100, pool)[0];
  EXPECT_NEAR(level.curvature_per_m[level.grid.lattice.index(20, 20)], 2, 1e-6);
  EXPECT_TRUE(std::isnan(level.curvature_per_m[level.grid.lattice.index(35, 35)]));
  EXPECT_NEAR(level.curvature_per_m[level.grid.lattice.index(29, 35)], 2, 1e-6);
}

TEST(Pyramid, GivesTheSameBitsOnAnyNumberOfThreads) {
  scene::DepthGrid grid =
      grid_of(lattice_of(333, 222, 1), [](double x, double y) { return std::sin(x * 0.1) + 0.3 * std::cos(y * 0.2); });
  std::mt19937 random(1);
  for (int k = 0; k < 9000; ++k) forget(grid, static_cast<int>(random() % 333), static_cast<int>(random() % 222));
  ThreadPool one(1), three(3);
  const auto a = build_pyramid(layers_of(grid), 50, one), b = build_pyramid(layers_of(grid), 50, three);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].grid.state, b[k].grid.state);
    EXPECT_EQ(
        std::memcmp(a[k].grid.height_m.data(), b[k].grid.height_m.data(), a[k].grid.height_m.size() * sizeof(float)),
        0);
  }
}

}  // namespace
}  // namespace sparsha::pipeline
