// The points of a cloud in the grid frame, each rounded once, as separate coordinate arrays for the kernels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "base/thread_pool.h"
#include "pipeline/projection/buffer.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// Coordinates of a cloud as they lie in memory: point k is at xyz[k * stride], metres relative to the cloud's origin.
struct RawPoints {
  const float* xyz = nullptr;
  std::size_t stride = 0;
  std::size_t count = 0;
};

/// Hands over all points in pieces, in any order, but the same points at every call: a cloud that lies on disk, or one
/// piece for a cloud in memory.
using RawPieces = std::function<void(const std::function<void(const RawPoints&)>& use)>;

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

/// The same points as RawPieces, oriented.
using OrientedPieces = std::function<void(const std::function<void(const OrientedPoints&)>& use)>;

/// An origin in the grid frame that far outliers cannot move: medians of a sample of the `count` points, chosen by a
/// hash of the coordinates. Depends neither on threads nor on the points' order.
[[nodiscard]] Eigen::Vector3d robust_origin(std::uint64_t count, const RawPieces& pieces,
                                            const Eigen::Vector3d& cloud_origin_m, const Eigen::Matrix4d& scan_to_grid,
                                            ThreadPool& pool);

/// The same in two steps: the sample, x, y and z of each point, does not depend on the orientation.
[[nodiscard]] std::vector<float> origin_sample(std::uint64_t count, const RawPieces& pieces, ThreadPool& pool);
[[nodiscard]] Eigen::Vector3d origin_of_sample(const std::vector<float>& sample, const Eigen::Vector3d& cloud_origin_m,
                                               const Eigen::Matrix4d& scan_to_grid);

/// grid = scan_to_grid * scan in double, minus `origin_m`, then rounded to float. Memory comes from `store` when it is
/// given.
[[nodiscard]] OrientedPoints orient_points(const RawPoints& raw, const Eigen::Vector3d& cloud_origin_m,
                                           const Eigen::Matrix4d& scan_to_grid, const Eigen::Vector3d& origin_m,
                                           ThreadPool& pool, MemoryStore* store = nullptr);

}  // namespace sparsha::pipeline
