// The points that a cross-check counts, relative to the lattice's origin and sorted into bands of node rows.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/threads/thread_pool.h"
#include "pipeline/check/check.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// Points of a cloud (relative to its origin) as the cross-check has them: relative to the lattice's, rounded once
/// more.
class ToLattice {
 public:
  ToLattice(const Eigen::Matrix4d& scan_to_grid, const Eigen::Vector3d& cloud_origin_m, const scene::Lattice& lattice)
      : linear_(scan_to_grid.topLeftCorner<3, 3>()),
        offset_(linear_ * cloud_origin_m + scan_to_grid.topRightCorner<3, 1>() - lattice.origin_m) {}

  /// Writes three floats.
  void operator()(const float* point, float* xyz) const {
    const double x = point[0], y = point[1], z = point[2];
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      xyz[axis] =
          static_cast<float>(linear_(axis, 0) * x + linear_(axis, 1) * y + linear_(axis, 2) * z + offset_[axis]);
    }
  }

 private:
  Eigen::Matrix3d linear_;
  Eigen::Vector3d offset_;
};

/// Band b holds the points nearest to rows [b * kRows, (b + 1) * kRows); points beyond the lattice go to the nearest
/// band.
class BandedPoints {
 public:
  static constexpr int kRows = 8;
  /// Writes x y z, metres relative to the lattice's origin, of those of the items [begin, end) that count; returns how
  /// many.
  using Source = std::function<std::size_t(std::size_t begin, std::size_t end, float* xyz)>;

  /// Asks `source` twice for every item, from several threads. The order within a band is the items'.
  BandedPoints(const scene::Lattice& lattice, std::size_t items, const Source& source, ThreadPool& pool);

  [[nodiscard]] std::size_t size() const { return start_.back(); }
  [[nodiscard]] std::size_t bands() const { return start_.size() - 1; }
  /// x y z of all points, one after the other.
  [[nodiscard]] std::span<const float> xyz() const { return {xyz_.get(), 3 * size()}; }
  [[nodiscard]] const float* point(std::size_t n) const { return xyz_.get() + 3 * n; }
  /// Points of a band are numbers first(band) to first(band + 1) - 1.
  [[nodiscard]] std::size_t first(std::size_t band) const { return start_[band]; }
  /// The same points for cross_check; this object must outlive them.
  [[nodiscard]] CountedPoints counted() const;

 private:
  std::vector<std::size_t> start_;
  std::unique_ptr<float[]> xyz_;
};

}  // namespace sparsha::pipeline
