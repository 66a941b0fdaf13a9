// One origin for all scans of a scene, chosen from the set of points alone.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace sparsha::pipeline {

/// Keeps the points with the smallest hashes of their coordinates: a uniform sample that depends on the set of points
/// only, not on their order, and that merges. Constant memory.
class PointSample {
 public:
  void add(const Eigen::Vector3d& point) {
    const std::uint64_t h = hash(point);
    if (h < threshold_) keep(h, point);
  }
  /// Sampled coordinate of that rank (0 to 1) along an axis. The sample must not be empty.
  [[nodiscard]] double quantile(int axis, double rank) const;
  [[nodiscard]] bool empty() const { return kept_.empty(); }

 private:
  static constexpr std::size_t kSize = 4096;
  struct Entry {
    std::uint64_t hash;
    Eigen::Vector3d point;
  };
  static bool before(const Entry& a, const Entry& b);
  static std::uint64_t hash(const Eigen::Vector3d& point);
  void keep(std::uint64_t h, const Eigen::Vector3d& point);
  [[nodiscard]] std::vector<Entry> smallest() const;

  std::vector<Entry> kept_;
  std::uint64_t threshold_ = ~std::uint64_t{0};
};

/// The median of the sample in whole metres.
[[nodiscard]] Eigen::Vector3d common_origin(const PointSample& sample);

}  // namespace sparsha::pipeline
