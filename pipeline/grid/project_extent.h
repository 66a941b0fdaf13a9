// Where the object is: the bounds of supported points, so that far outliers cannot stretch the grid.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/base/thread_pool.h"
#include "pipeline/grid/project_points.h"

namespace sparsha::pipeline {

/// Metres relative to the oriented points' origin.
struct Extent {
  double xmin_m = 0.0, ymin_m = 0.0, xmax_m = 0.0, ymax_m = 0.0;
  double covered_area_m2 = 0.0;  ///< of the coarse cells that hold supported points
  std::uint64_t supported = 0;   ///< points in those cells

  [[nodiscard]] double width_m() const { return xmax_m - xmin_m; }
  [[nodiscard]] double height_m() const { return ymax_m - ymin_m; }
};

/// A point supports the extent when it has neighbours in space within about two local point spacings; groups of cells
/// with less than a thousandth of the points that stand apart do not. `fixed` (empty or one flag a point) marks
/// vertices of faces, which need no support. Throws Error{input} when there are no points.
[[nodiscard]] Extent supported_extent(const OrientedPoints& points, const std::vector<std::uint8_t>& fixed,
                                      ThreadPool& pool);

}  // namespace sparsha::pipeline
