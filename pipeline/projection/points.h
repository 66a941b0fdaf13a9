// The points of a cloud in the grid frame, each rounded once, as separate coordinate arrays for the kernels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/buffer.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// Coordinates of a cloud as they lie in memory: point k is at xyz[k * stride], metres relative to the cloud's origin.
struct RawPoints {
  const float* xyz = nullptr;
  std::size_t stride = 0;
  std::size_t count = 0;
};

/// Replaces the bytes that this process has found in a pass by those of all processes, in their order.
using JoinBytes = std::function<void(std::vector<std::byte>& bytes)>;

/// Hands over points in pieces, in any order, but the same points at every call: a cloud that lies on disk, or one
/// piece for a cloud in memory. Where several processes have a share of the points each, every one of them makes the
/// same passes, and joins what it has found before it goes on.
template <typename Points>
class PointPieces : public std::function<void(const std::function<void(const Points&)>& use)> {
 public:
  using std::function<void(const std::function<void(const Points&)>& use)>::function;

  /// `join` empty: this process has all points.
  void set_join(JoinBytes join) { join_ = std::move(join); }
  [[nodiscard]] bool joins() const { return join_ != nullptr; }

  /// What all processes have found, in their order.
  template <typename T>
  void join(std::vector<T>& values) const {
    static_assert(std::is_trivially_copyable_v<T>);
    if (!join_) return;
    std::vector<std::byte> bytes(values.size() * sizeof(T));
    if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    join_(bytes);
    values.resize(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
  }

  /// The sums of what all processes have counted, place by place.
  template <typename T>
  void add_up(std::vector<T>& counts) const {
    if (!join_) return;
    const std::size_t size = counts.size();
    join(counts);
    for (std::size_t k = size; k < counts.size(); ++k) counts[k % size] += counts[k];
    counts.resize(size);
  }

 private:
  JoinBytes join_;
};

using RawPieces = PointPieces<RawPoints>;

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
using OrientedPieces = PointPieces<OrientedPoints>;

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
