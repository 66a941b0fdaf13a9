// Classification of points by the range of measured heights around them.
#include "pipeline/projection/classification.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pipeline/projection/simd/kernels.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kPiece = 1U << 15U;
constexpr std::uint8_t kUndecided = 255;
static_assert(static_cast<int>(PointClass::used) == 0, "the kernel's code of a used point");

struct Range {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
};

// Unknown heights are NaN here and compare false.
void include(Range& range, float height) {
  range.low = height < range.low ? height : range.low;
  range.high = height > range.high ? height : range.high;
}

Range range_of_nodes(const scene::DepthGrid& grid, int i0, int j0, int i1, int j1) {
  Range range;
  for (int j = std::max(0, j0); j <= std::min(grid.lattice.ny - 1, j1); ++j) {
    for (int i = std::max(0, i0); i <= std::min(grid.lattice.nx - 1, i1); ++i) {
      include(range, grid.height_m[grid.lattice.index(i, j)]);
    }
  }
  return range;
}

// Of a point in a border cell, beyond the lattice, or in a cell without a measured node.
PointClass class_at_border(const scene::DepthGrid& grid, const ClassifyKernel& kernel, float x, float y, float z) {
  const float u = (x - kernel.x0_m) * kernel.per_m;
  const float v = (y - kernel.y0_m) * kernel.per_m;
  if (!(u >= -0.5F && v >= -0.5F && u <= kernel.last_u + 0.5F && v <= kernel.last_v + 0.5F)) return PointClass::outside;
  const int i = static_cast<int>(std::floor(u));
  const int j = static_cast<int>(std::floor(v));
  Range range = range_of_nodes(grid, i, j, i + 1, j + 1);
  if (range.low > range.high) range = range_of_nodes(grid, i - 1, j - 1, i + 2, j + 2);
  if (range.low > range.high || z > range.high + kernel.gap_m) return PointClass::outlier;
  return z < range.low - kernel.gap_m ? PointClass::occluded : PointClass::used;
}

}  // namespace

std::array<std::uint64_t, 4> classify_points(const OrientedPoints& points, const BinLattice& lattice,
                                             const scene::DepthGrid& grid, double gap_m, const FacingField* facing,
                                             ThreadPool& pool, PointClass* point_class) {
  ClassifyKernel kernel;
  kernel.height = grid.height_m.data();
  kernel.nx = lattice.nx;
  kernel.x0_m = static_cast<float>(lattice.x0_m);
  kernel.y0_m = static_cast<float>(lattice.y0_m);
  kernel.per_m = static_cast<float>(1.0 / lattice.spacing_m);
  kernel.last_u = static_cast<float>(lattice.nx - 1);
  kernel.last_v = static_cast<float>(lattice.ny - 1);
  kernel.gap_m = static_cast<float>(gap_m);
  kernel.occluded = static_cast<std::int32_t>(PointClass::occluded);
  kernel.outlier = static_cast<std::int32_t>(PointClass::outlier);
  kernel.undecided = kUndecided;
  const bool through = facing != nullptr && facing->sees_through();
  auto* classes = reinterpret_cast<std::uint8_t*>(point_class);
  std::vector<std::array<std::uint64_t, 4>> counts((points.count + kPiece - 1) / kPiece);
  pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
    fastest_kernels().classify(kernel, points.x.get() + begin, points.y.get() + begin, points.z.get() + begin,
                               end - begin, classes + begin);
    std::array<std::uint64_t, 4> mine{};
    for (std::size_t k = begin; k < end; ++k) {
      if (classes[k] == kUndecided) [[unlikely]] {
        point_class[k] = class_at_border(grid, kernel, points.x[k], points.y[k], points.z[k]);
      }
      if (through && point_class[k] == PointClass::outlier &&
          facing->is_wall_from_behind(points.x[k], points.y[k], points.z[k])) {
        point_class[k] = PointClass::occluded;
      }
      if (point_class[k] != PointClass::used) ++mine[classes[k]];
    }
    mine[static_cast<std::size_t>(PointClass::used)] = end - begin - mine[1] - mine[2] - mine[3];
    counts[begin / kPiece] = mine;
  });
  std::array<std::uint64_t, 4> all{};
  for (const std::array<std::uint64_t, 4>& mine : counts) {
    for (std::size_t f = 0; f < 4; ++f) all[f] += mine[f];
  }
  return all;
}

void add_classes(const std::array<std::uint64_t, 4>& counts, Projection& projection) {
  projection.used += counts[static_cast<std::size_t>(PointClass::used)];
  projection.occluded += counts[static_cast<std::size_t>(PointClass::occluded)];
  projection.outlier += counts[static_cast<std::size_t>(PointClass::outlier)];
  projection.outside += counts[static_cast<std::size_t>(PointClass::outside)];
}

}  // namespace sparsha::pipeline
