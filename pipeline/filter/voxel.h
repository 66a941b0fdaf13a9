// One point a voxel: the centroid of the points in it, as pcl::VoxelGrid has it, without its overflow of indices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_set>

#include <Eigen/Core>

#include "base/threads/progress.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// Replaces the points by their voxels' centroids, colours and intensities by their means, ordered by z, y, x of the
/// voxel. Voxels are multiples of `leaf_m` in the scan frame, counted in 64 bits. Sums are exact, so that the result
/// does not depend on the order of the points. Throws Error{usage} when the leaf is below the points' own precision.
void thin_to_voxels(Cloud& cloud, double leaf_m, Progress& progress);

/// The same for points that come one after the other, relative to `origin_m`; memory grows with the voxels only.
class VoxelThinner {
 public:
  VoxelThinner(const Eigen::Vector3d& origin_m, double leaf_m, bool colour, bool intensity);
  ~VoxelThinner();
  VoxelThinner(const VoxelThinner&) = delete;
  VoxelThinner& operator=(const VoxelThinner&) = delete;

  /// x, y, z in metres. Throws Error{usage} when the leaf is below the point's precision.
  void add(const float* xyz, std::uint32_t rgba, float intensity);
  [[nodiscard]] std::size_t voxels() const;
  /// The thinned cloud; to be called once, at the end.
  [[nodiscard]] Cloud finish();

 private:
  class Implementation;
  template <bool kColour, bool kIntensity>
  class Sums;
  std::unique_ptr<Implementation> implementation_;
};

/// How many voxels points fall in, within a percent, in less than 2 MB: those with the smallest hashes are counted.
class VoxelCounter {
 public:
  VoxelCounter(const Eigen::Vector3d& origin_m, double leaf_m) : origin_m_(origin_m), leaf_m_(leaf_m) {}

  /// x, y, z in metres, relative to the origin.
  void add(const float* xyz);
  [[nodiscard]] std::uint64_t voxels() const { return static_cast<std::uint64_t>(hashes_.size()) << halvings_; }

 private:
  static constexpr std::size_t kMost = 30'000;  // whose standard error is 0.8 %

  Eigen::Vector3d origin_m_;
  double leaf_m_;
  std::unordered_set<std::uint64_t> hashes_;  ///< below 2^(64 - halvings)
  unsigned halvings_ = 0;
};

}  // namespace sparsha::pipeline
