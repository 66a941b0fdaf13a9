// The points that a cross-check counts, relative to the lattice's origin and sorted into bands of node rows.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pipeline/base/thread_pool.h"
#include "pipeline/scene/depth_grid.h"

namespace sparsha::pipeline {

/// Band b holds the points nearest to rows [b * kRows, (b + 1) * kRows); points beyond the lattice go to the nearest
/// band.
class BandedPoints {
 public:
  static constexpr int kRows = 8;
  /// Writes x y z, metres relative to the lattice's origin, of those of the items [begin, end) that count; returns how
  /// many.
  using Source = std::function<std::size_t(std::size_t begin, std::size_t end, float* xyz)>;

  /// Asks `source` twice for every item, from several threads. The order within a band is the items'.
  BandedPoints(const Lattice& lattice, std::size_t items, const Source& source, ThreadPool& pool);

  [[nodiscard]] std::size_t size() const { return start_.back(); }
  [[nodiscard]] std::size_t bands() const { return start_.size() - 1; }
  /// x y z of all points, one after the other.
  [[nodiscard]] std::span<const float> xyz() const { return {xyz_.get(), 3 * size()}; }
  [[nodiscard]] const float* point(std::size_t n) const { return xyz_.get() + 3 * n; }
  /// Points of a band are numbers first(band) to first(band + 1) - 1.
  [[nodiscard]] std::size_t first(std::size_t band) const { return start_[band]; }

 private:
  std::vector<std::size_t> start_;
  std::unique_ptr<float[]> xyz_;
};

}  // namespace sparsha::pipeline
