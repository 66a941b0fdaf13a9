// Points sorted into square bins around the lattice's nodes, so that a window of nodes is a few contiguous runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/base/thread_pool.h"
#include "pipeline/grid/project_buffer.h"
#include "pipeline/grid/project_points.h"
#include "pipeline/scene/depth_grid.h"

namespace sparsha::pipeline {

/// The lattice as the kernels see it: metres relative to the oriented points' origin. Bins reach `kMargin` nodes beyond
/// the lattice, so that a cropped grid is measured up to its border.
struct BinLattice {
  static constexpr int kMargin = 2;

  int nx = 0, ny = 0;  ///< nodes
  double spacing_m = 0.0;
  double x0_m = 0.0, y0_m = 0.0;  ///< node (0, 0)

  [[nodiscard]] int bins_x() const { return nx + 2 * kMargin; }
  [[nodiscard]] int bins_y() const { return ny + 2 * kMargin; }
  [[nodiscard]] std::size_t bin_count() const {
    return static_cast<std::size_t>(bins_x()) * static_cast<std::size_t>(bins_y());
  }
  /// Bin around node (i, j), -kMargin <= i < nx + kMargin.
  [[nodiscard]] std::size_t bin(int i, int j) const {
    return static_cast<std::size_t>(j + kMargin) * static_cast<std::size_t>(bins_x()) +
           static_cast<std::size_t>(i + kMargin);
  }
};

/// Points of bin b are [start[b], start[b + 1]), the highest first; equal heights by x, then y.
struct Bins {
  BinLattice lattice;
  Buffer<std::uint32_t> start;  ///< bin_count() + 1 values
  Buffer<float> top;            ///< highest z of each bin, -infinity when it is empty
  Buffer<float> x, y, z;        ///< metres relative to the oriented points' origin
  std::size_t points = 0;

  /// Zeros (infinities in `top`) beyond the arrays' ends, for vector reads.
  static constexpr std::size_t kReadAhead = 32;
};

/// `skip` (empty or one flag a point) names points that stay out. At most 2^32 - 1 points.
[[nodiscard]] Bins sort_into_bins(const OrientedPoints& points, const std::vector<std::uint8_t>& skip,
                                  const BinLattice& lattice, ThreadPool& pool);

}  // namespace sparsha::pipeline
