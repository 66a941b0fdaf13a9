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

// Unknown heights are NaN here and compare false.
void include(Range& range, float height) {
  range.low = height < range.low ? height : range.low;
  range.high = height > range.high ? height : range.high;
}

Range range_of_nodes(const DepthGrid& grid, int i0, int j0, int i1, int j1) {
  Range range;
  for (int j = std::max(0, j0); j <= std::min(grid.lattice.ny - 1, j1); ++j) {
    for (int i = std::max(0, i0); i <= std::min(grid.lattice.nx - 1, i1); ++i) {
      include(range, grid.height_m[grid.lattice.index(i, j)]);
    }
  }
  return range;
}

// Of the four nodes around cell (i, j), which must be inside.
Range range_of_cell(const DepthGrid& grid, int i, int j) {
  const float* lower = grid.height_m.data() + grid.lattice.index(i, j);
  const float* upper = lower + grid.lattice.nx;
  Range range;
  include(range, lower[0]);
  include(range, lower[1]);
  include(range, upper[0]);
  include(range, upper[1]);
  return range;
}

}  // namespace

void classify_points(const OrientedPoints& points, const BinLattice& lattice, ThreadPool& pool,
                     Projection& projection) {
  const DepthGrid& grid = projection.grid;
  const auto gap = static_cast<float>(projection.gap_m);
  const auto per_m = static_cast<float>(1.0 / lattice.spacing_m);
  const auto x0 = static_cast<float>(lattice.x0_m);
  const auto y0 = static_cast<float>(lattice.y0_m);
  const float last_u = static_cast<float>(lattice.nx) - 0.5F;
  const float last_v = static_cast<float>(lattice.ny) - 0.5F;
  projection.fate.resize(points.count);
  std::vector<std::array<std::uint64_t, 4>> counts((points.count + kPiece - 1) / kPiece);
  pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
    std::array<std::uint64_t, 4> mine{};
    for (std::size_t k = begin; k < end; ++k) {
      const float u = (points.x[k] - x0) * per_m;
      const float v = (points.y[k] - y0) * per_m;
      PointFate fate = PointFate::outside;
      if (u >= -0.5F && v >= -0.5F && u <= last_u && v <= last_v) {
        // One up and down again: truncation then rounds towards minus infinity.
        const int i = static_cast<int>(u + 1.0F) - 1;
        const int j = static_cast<int>(v + 1.0F) - 1;
        const bool inner = i >= 0 && j >= 0 && i + 1 < lattice.nx && j + 1 < lattice.ny;
        Range range = inner ? range_of_cell(grid, i, j) : range_of_nodes(grid, i, j, i + 1, j + 1);
        if (range.low > range.high) range = range_of_nodes(grid, i - 1, j - 1, i + 2, j + 2);
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
