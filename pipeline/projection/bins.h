// Points sorted into square bins around the lattice's nodes, so that a window of nodes is a few contiguous runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/buffer.h"
#include "pipeline/projection/points.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// The lattice as the kernels see it: metres relative to the oriented points' origin. Bins reach `kMargin` nodes beyond
/// the lattice, so that a cropped grid is measured up to its border.
struct BinLattice {
  static constexpr int kMargin = 3;

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

/// Which bin a point falls into. In float: a point on a border may go to either bin, the same one always.
struct BinLocator {
  explicit BinLocator(const BinLattice& lattice);

  /// False beyond the bins.
  [[nodiscard]] bool locate(float x, float y, int& column, int& row) const {
    const float u = (x - x_shift_m) * per_m;
    const float v = (y - y_shift_m) * per_m;
    if (!(u >= 0.0F && v >= 0.0F && u < columns && v < rows)) return false;
    column = static_cast<int>(u);
    row = static_cast<int>(v);
    return true;
  }

  float x_shift_m, y_shift_m, per_m, columns, rows;
};

/// Bins of rows [first_row, last_row) and columns [first_column, last_column), counted from the margin's first.
struct BinWindow {
  int first_row = 0, last_row = 0, first_column = 0, last_column = 0;

  [[nodiscard]] static BinWindow all(const BinLattice& lattice) { return {0, lattice.bins_y(), 0, lattice.bins_x()}; }
  /// Those around nodes alone.
  [[nodiscard]] static BinWindow nodes(const BinLattice& lattice) {
    return {BinLattice::kMargin, lattice.ny + BinLattice::kMargin, BinLattice::kMargin,
            lattice.nx + BinLattice::kMargin};
  }
};

/// Points of bin b are [start[b], start[b + 1]), the highest first; equal heights by x, then y.
struct Bins {
  BinLattice lattice;
  Buffer<std::uint32_t> start;  ///< bin_count() + 1 values, those of the window's rows set
  Buffer<float> x, y, z;        ///< metres relative to the oriented points' origin
  std::size_t points = 0;

  /// Beyond the arrays' ends, zeros and the last start again, for vector reads.
  static constexpr std::size_t kReadAhead = 32;
};

/// `skip` (empty or one flag per point) names points that stay out, and so do those beyond the window: bins of its rows
/// but not of its columns are empty, and memory of other rows is not touched. At most 2^32 - 1 points.
/// Memory comes from `store` when it is given.
[[nodiscard]] Bins sort_into_bins(const OrientedPoints& points, const std::vector<std::uint8_t>& skip,
                                  const BinLattice& lattice, const BinWindow& window, ThreadPool& pool,
                                  MemoryStore* store = nullptr);

/// Leaves one of equal points in each bin of the window's rows: a point told twice makes a surface no denser. Changes
/// no bit where all points differ.
void leave_out_repeats(Bins& bins, const BinWindow& window, ThreadPool& pool);

}  // namespace sparsha::pipeline
