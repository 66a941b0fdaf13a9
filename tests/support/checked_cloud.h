// Small clouds and projections for the tests of the cross-check and its report.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pipeline/projection/projection.h"
#include "pipeline/scan/cloud.h"
#include "tests/support/grids.h"

namespace sparsha::pipeline::testing {

inline Cloud cloud_of(const std::vector<Eigen::Vector3d>& points,
                      const Eigen::Vector3d& origin_m = Eigen::Vector3d::Zero()) {
  Cloud cloud;
  cloud.origin_m = origin_m;
  cloud.resize_points(points.size());
  for (std::size_t n = 0; n < points.size(); ++n)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      cloud.xyz1()[4 * n + static_cast<std::size_t>(axis)] = static_cast<float>(points[n][axis] - origin_m[axis]);
  return cloud;
}

inline Projection projection_of(scene::DepthGrid grid, std::size_t points) {
  Projection projection;
  projection.grid = std::move(grid);
  projection.point_class.assign(points, PointClass::used);
  projection.used = points;
  projection.point_spacing_m = projection.grid.lattice.spacing_m;
  return projection;
}

}  // namespace sparsha::pipeline::testing
