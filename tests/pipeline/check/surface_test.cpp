// Distances to lattices whose heights are whole multiples of the spacing, of every small shape, against all cells.
#include "pipeline/check/surface.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/grids.h"

namespace sparsha::pipeline {
namespace {

using Eigen::Vector3d;
using testing::lattice_of;

double distance_to_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - t * along).norm();
}

/// Distance to one cell: at every v its surface is a straight line, and the least of those lines' distances is found by
/// samples and by thirds between the best one's neighbours.
double distance_to_cell(const Vector3d& p, const scene::DepthGrid& grid, int i, int j) {
  const scene::Lattice& l = grid.lattice;
  const auto node = [&](int a, int b) {
    return Vector3d((i + a) * l.spacing_m, (j + b) * l.spacing_m, grid.height_m[l.index(i + a, j + b)]);
  };
  const Vector3d p00 = node(0, 0), p10 = node(1, 0), p01 = node(0, 1), p11 = node(1, 1);
  const auto at = [&](double v) { return distance_to_segment(p, p00 + v * (p01 - p00), p10 + v * (p11 - p10)); };
  constexpr int kLines = 24;
  int best = 0;
  for (int k = 1; k <= kLines; ++k)
    if (at(k / double{kLines}) < at(best / double{kLines})) best = k;
  double low = std::max(0, best - 1) / double{kLines}, high = std::min(kLines, best + 1) / double{kLines};
  for (int k = 0; k < 50; ++k) {
    const double third = (high - low) / 3;
    (at(low + third) < at(high - third) ? high : low) += at(low + third) < at(high - third) ? -third : third;
  }
  return at(0.5 * (low + high));
}

double distance_to_all_cells(const Vector3d& p, const scene::DepthGrid& grid) {
  const scene::Lattice& l = grid.lattice;
  double best = std::numeric_limits<double>::infinity();
  for (int j = 0; j + 1 < l.ny; ++j)
    for (int i = 0; i + 1 < l.nx; ++i) {
      const float* z = grid.height_m.data() + l.index(i, j);
      if (std::max(std::abs(p.x() / l.spacing_m - i - 0.5), std::abs(p.y() / l.spacing_m - j - 0.5)) * l.spacing_m >
          best + l.spacing_m)
        continue;  // beside the cell by more
      if (!std::isnan(z[0] + z[1] + z[l.nx] + z[l.nx + 1])) best = std::min(best, distance_to_cell(p, grid, i, j));
    }
  return best;
}

/// Asks on, near and far from the surface.
void expect_true_distances(const scene::DepthGrid& grid, int points, std::mt19937& random) {
  const scene::Lattice& l = grid.lattice;
  const double spacing = l.spacing_m;
  const SurfaceIndex surface(grid);
  std::uniform_real_distribution<double> unit(0, 1), around(-1, 1);
  for (int k = 0; k < points; ++k) {
    const double x = unit(random) * (l.nx - 1), y = unit(random) * (l.ny - 1);
    const float height = grid.height_m[l.index(static_cast<int>(x), static_cast<int>(y))];
    const double reach = k % 3 == 0 ? 0.01 : k % 3 == 1 ? 3 : 60;
    const Vector3d p = spacing * Vector3d(x + reach * around(random), y + reach * around(random),
                                          (std::isnan(height) ? 0 : height / spacing) + reach * around(random));
    const double found = surface.distance(p.x(), p.y(), p.z()).distance_m;
    const double truth = distance_to_all_cells(p, grid);
    // Thirds end where distances differ by no more than rounding: some 1e-16 of the distance's square.
    ASSERT_NEAR(found, truth, 1e-6 * spacing + 1e-7 * truth)
        << l.nx << " x " << l.ny << " nodes " << spacing << " m apart, at " << p.transpose();
  }
}

/// Whole multiples of the spacing but for the rounding of floats, as a mesh's interpolated heights are: a slope along
/// x, y or both, steps, or any whole number at any node.
scene::DepthGrid whole_multiples(int nx, int ny, double spacing, int kind, std::mt19937& random) {
  scene::DepthGrid grid(lattice_of(nx, ny, spacing));
  std::uniform_real_distribution<double> rounding(-2, 2);
  const double unit = random() % 4 == 0 ? 0 : std::numeric_limits<float>::epsilon();
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int drawn = static_cast<int>(random() % 9);
      const int multiple = kind == 0   ? i
                           : kind == 1 ? 2 * j
                           : kind == 2 ? i + j - 4
                           : kind == 3 ? 4 * (i / 2)
                           : kind == 4 ? (i * j) % 13 - 6
                                       : drawn * (j % 5 == 0 ? 4 : 1);
      grid.height_m[grid.lattice.index(i, j)] = static_cast<float>(spacing * (multiple + unit * rounding(random)));
    }
  return grid;
}

TEST(SurfaceIndex, FindsTheNearestCellOfHeightFieldsOfWholeSpacings) {
  std::mt19937 random(33);
  for (const double spacing : {1.0, 0.001, 0.05, 1.0 / 3})
    for (int size = 2; size <= 33; size += size < 8 ? 1 : 5)
      for (int kind = 0; kind < 6; ++kind)
        ASSERT_NO_FATAL_FAILURE(expect_true_distances(whole_multiples(size, size, spacing, kind, random), 12, random));
}

TEST(SurfaceIndex, FindsTheNearestCellOfStripsOfWholeSpacings) {
  std::mt19937 random(34);
  for (const double spacing : {0.01, 0.7})
    for (const int length : {3, 5, 9, 450})
      for (const int width : {2, 3, 5})
        for (int kind = 0; kind < 6; ++kind) {
          ASSERT_NO_FATAL_FAILURE(
              expect_true_distances(whole_multiples(length, width, spacing, kind, random), 6, random));
          ASSERT_NO_FATAL_FAILURE(
              expect_true_distances(whole_multiples(width, length, spacing, kind, random), 6, random));
        }
}

TEST(SurfaceIndex, FindsTheNearestCellWhereMostNodesAreUnknown) {
  std::mt19937 random(35);
  for (int round = 0; round < 200; ++round) {
    scene::DepthGrid grid = whole_multiples(2 + static_cast<int>(random() % 30), 2 + static_cast<int>(random() % 30),
                                            0.01, static_cast<int>(random() % 6), random);
    const unsigned kept = 1 + random() % 8;  // of 8, in squares of 2 x 2 nodes
    for (int j = 0; j < grid.lattice.ny; j += 2)
      for (int i = 0; i < grid.lattice.nx; i += 2) {
        if (random() % 8 < kept) continue;
        for (int b = j; b < std::min(j + 2, grid.lattice.ny); ++b)
          for (int a = i; a < std::min(i + 2, grid.lattice.nx); ++a)
            grid.height_m[grid.lattice.index(a, b)] = scene::kUnknownHeight;
      }
    if (std::isinf(distance_to_all_cells(Vector3d::Zero(), grid))) continue;
    ASSERT_NO_FATAL_FAILURE(expect_true_distances(grid, 10, random));
  }
}

TEST(SurfaceIndex, FindsTheNearestCellFarFromTheLatticesOrigin) {
  // Coordinates of 5000 and heights of 100 000 spacings, where the floats of the tree are 0.0005 and 0.008 spacings
  // apart; the surface's own heights are such floats too.
  std::mt19937 random(36);
  scene::DepthGrid grid(lattice_of(5000, 3, 0.001));
  for (float& height : grid.height_m) height = static_cast<float>(100 + 0.001 * static_cast<double>(random() % 12));
  expect_true_distances(grid, 200, random);
}

TEST(SurfaceIndex, ARowOfNodesIsNoSurface) {
  for (const auto& [nx, ny] : {std::pair{1, 1}, {1, 40}, {40, 1}}) {
    scene::DepthGrid grid(lattice_of(nx, ny, 0.01));
    std::fill(grid.height_m.begin(), grid.height_m.end(), 0.0F);
    const SurfaceIndex surface(grid);
    EXPECT_TRUE(std::isinf(surface.distance(0.01, 0, 0).distance_m)) << nx << " x " << ny;
  }
}

}  // namespace
}  // namespace sparsha::pipeline
