// The points of a cloud in the grid frame, each rounded once, as separate coordinate arrays for the kernels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pipeline/base/thread_pool.h"
#include "pipeline/grid/project_buffer.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// Coordinates of a cloud as they lie in memory: point k is at xyz[k * stride], metres relative to the cloud's origin.
struct RawPoints {
  const float* xyz = nullptr;
  std::size_t stride = 0;
  std::size_t count = 0;
};

/// The only place of the projection that sees PCL.
[[nodiscard]] RawPoints raw_points(const Cloud& cloud);

/// x, y, z in metres, grid frame, relative to `origin_m`. Points whose coordinates do not fit a float lie at kFarAway.
struct OrientedPoints {
  static constexpr float kFarAway = 3e38F;

  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  std::size_t count = 0;
  Buffer<float> x, y, z;
  Eigen::Array3f min_m, max_m;  ///< of the points that are not far away; min > max when there are none
};

/// grid = scan_to_grid * scan in double, minus an origin that far outliers cannot move (medians of a sample chosen by a
/// hash of the coordinates), then rounded to float. Depends neither on threads nor on the points' order.
[[nodiscard]] OrientedPoints orient_points(const RawPoints& raw, const Eigen::Vector3d& cloud_origin_m,
                                           const Eigen::Matrix4d& scan_to_grid, ThreadPool& pool);

}  // namespace sparsha::pipeline
