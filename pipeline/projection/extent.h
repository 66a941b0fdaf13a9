// Where the object is: the bounds of supported points, so that far outliers cannot stretch the grid.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/points.h"

namespace sparsha::pipeline {

/// Metres relative to the oriented points' origin.
struct Extent {
  double xmin_m = 0.0, ymin_m = 0.0, xmax_m = 0.0, ymax_m = 0.0;
  double covered_area_m2 = 0.0;  ///< of the coarse cells that hold supported points
  std::uint64_t supported = 0;   ///< points in those cells
  std::uint64_t corners = 0;     ///< of triangles

  [[nodiscard]] double width_m() const { return xmax_m - xmin_m; }
  [[nodiscard]] double height_m() const { return ymax_m - ymin_m; }
};

/// How many points there are, and the box of those that are not far away.
struct PointTotals {
  std::uint64_t count = 0;
  Eigen::Array3f min_m = Eigen::Array3f::Constant(std::numeric_limits<float>::infinity());
  Eigen::Array3f max_m = -min_m;

  void add(const OrientedPoints& points) {
    count += points.count;
    min_m = min_m.min(points.min_m);
    max_m = max_m.max(points.max_m);
  }
};

/// A point supports the extent when it has neighbours in space within about two local point spacings; groups of cells
/// with less than a thousandth of the points that stand apart do not. Depends neither on threads nor on the points'
/// order. Throws Error{input} when there are no points.
[[nodiscard]] Extent supported_extent(const PointTotals& totals, const OrientedPieces& pieces, ThreadPool& pool);

/// Makes room for the vertices of faces. Vertices of a mesh may stand far apart, so most need no neighbours; but those
/// that lie farther outside than the object is long, are fewer than a thousandth of all, and have no compact triangle
/// of a thousandth of the mesh's area, are left out like outliers among points.
void include_faces(const OrientedPoints& points, const std::vector<std::array<std::uint32_t, 3>>& faces,
                   Extent& extent);

}  // namespace sparsha::pipeline
