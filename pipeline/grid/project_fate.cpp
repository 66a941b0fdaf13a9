// Fate of points by the range of measured heights around them.
#include "pipeline/grid/project_fate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kPiece = 1U << 15U;

struct Range {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
};

Range measured_range(const DepthGrid& grid, int i0, int j0, int i1, int j1) {
  Range range;
  for (int j = std::max(0, j0); j <= std::min(grid.lattice.ny - 1, j1); ++j) {
    for (int i = std::max(0, i0); i <= std::min(grid.lattice.nx - 1, i1); ++i) {
      const std::size_t node = grid.lattice.index(i, j);
      if (grid.state[node] != NodeState::measured) continue;
      range.low = std::min(range.low, grid.height_m[node]);
      range.high = std::max(range.high, grid.height_m[node]);
    }
  }
  return range;
}

}  // namespace

void classify_points(const OrientedPoints& points, const BinLattice& lattice, ThreadPool& pool,
                     Projection& projection) {
  const DepthGrid& grid = projection.grid;
  const auto gap = static_cast<float>(projection.gap_m);
  const double per_m = 1.0 / lattice.spacing_m;
  projection.fate.resize(points.count);
  std::vector<std::array<std::uint64_t, 4>> counts((points.count + kPiece - 1) / kPiece);
  pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
    std::array<std::uint64_t, 4> mine{};
    for (std::size_t k = begin; k < end; ++k) {
      const double u = (static_cast<double>(points.x[k]) - lattice.x0_m) * per_m;
      const double v = (static_cast<double>(points.y[k]) - lattice.y0_m) * per_m;
      PointFate fate = PointFate::outside;
      if (u >= -0.5 && v >= -0.5 && u <= lattice.nx - 0.5 && v <= lattice.ny - 0.5) {
        const int i = static_cast<int>(std::floor(u));
        const int j = static_cast<int>(std::floor(v));
        Range range = measured_range(grid, i, j, i + 1, j + 1);
        if (range.low > range.high) range = measured_range(grid, i - 1, j - 1, i + 2, j + 2);
        const float z = points.z[k];
        if (range.low > range.high || z > range.high + gap) {
          fate = PointFate::outlier;
        } else {
          fate = z < range.low - gap ? PointFate::occluded : PointFate::used;
        }
      }
      projection.fate[k] = fate;
      ++mine[static_cast<std::size_t>(fate)];
    }
    counts[begin / kPiece] = mine;
  });
  std::array<std::uint64_t, 4> all{};
  for (const std::array<std::uint64_t, 4>& mine : counts) {
    for (std::size_t f = 0; f < 4; ++f) all[f] += mine[f];
  }
  projection.used = all[static_cast<std::size_t>(PointFate::used)];
  projection.occluded = all[static_cast<std::size_t>(PointFate::occluded)];
  projection.outlier = all[static_cast<std::size_t>(PointFate::outlier)];
  projection.outside = all[static_cast<std::size_t>(PointFate::outside)];
}

}  // namespace sparsha::pipeline
