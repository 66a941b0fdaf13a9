// Points sorted into cubic cells: what lies within a given reach of a point is found without a tree.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/threads/context.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// Cells whose space diagonal is just below the reach: all points of a cell are within reach of each other, and points
/// within reach of each other lie at most two cells apart along each axis. Cells are ordered by z, y, x, points in a
/// cell by x, y, z, so that nothing depends on the order of the cloud. 16 bytes per point and 28 per cell, 64 bytes per
/// point more while they are sorted.
class CellOrder {
 public:
  struct Point {
    float x, y, z;
    std::uint32_t index;  ///< in the cloud
  };
  /// Cells [first, last).
  struct Range {
    std::size_t first = 0, last = 0;
  };

  /// `reach_m` > 0. Throws Cancelled.
  CellOrder(const Cloud& cloud, double reach_m, const Context& context);

  [[nodiscard]] std::size_t cells() const { return cells_.size(); }
  [[nodiscard]] std::span<const Point> points() const { return points_; }
  [[nodiscard]] std::span<const Point> points(std::size_t cell) const { return points({cell, cell + 1}); }
  [[nodiscard]] std::span<const Point> points(const Range& range) const {
    return std::span(points_).subspan(first_[range.first], first_[range.last] - first_[range.first]);
  }

  /// Finds the cells near one after the other, by 25 places that move forward with it.
  class Sweep {
   public:
    explicit Sweep(const CellOrder& order) : order_(order) {}
    /// Ranges that together hold every cell within two steps of `cell` along each axis, and no other. `cell` must not
    /// be below that of the call before.
    const std::array<Range, 25>& near(std::size_t cell);

   private:
    const CellOrder& order_;
    std::array<Range, 25> ranges_{};
    bool started_ = false;
  };

 private:
  /// z, y, x; whole numbers. Doubles, since one far point must not overflow anything.
  using Cell = std::array<double, 3>;

  void sort_points(const Cloud& cloud, double per_m, const Context& context);

  std::vector<Point> points_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> first_;  ///< point of each cell, and the end
};

/// Squared distance in float32, computed as FLANN does.
[[nodiscard]] inline float squared_distance(const CellOrder::Point& a, const CellOrder::Point& b) {
  const float dx = a.x - b.x;
  const float dy = a.y - b.y;
  const float dz = a.z - b.z;
  return (dx * dx + dy * dy) + dz * dz;
}

}  // namespace sparsha::pipeline
