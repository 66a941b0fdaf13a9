// Noise and spacing of the front points, from small blocks chosen by a hash.
#pragma once

#include "pipeline/grid/project_extent.h"
#include "pipeline/grid/project_points.h"

namespace sparsha::pipeline {

struct CloudStatistics {
  double noise_m = 0.0;          ///< standard deviation of heights about local quadrics
  double point_spacing_m = 0.0;  ///< median of 1/sqrt(front points per square metre), each front point counting once
};

/// Depends neither on threads nor on the points' order.
[[nodiscard]] CloudStatistics sample_cloud(const OrientedPieces& pieces, const Extent& extent, ThreadPool& pool);

}  // namespace sparsha::pipeline
