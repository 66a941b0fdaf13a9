// Points as they follow each other in a file: what tells a picture of a depth camera from a cloud.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace sparsha::pipeline {

/// Some stretches of consecutive points, spread evenly over a file of `points` points.
class PointRuns {
 public:
  PointRuns() = default;
  explicit PointRuns(std::uint64_t points) : stride_(std::max<std::uint64_t>(kLength, points / kRuns)) {}

  /// The next point of the file.
  void add(const Eigen::Vector3d& point) {
    const std::uint64_t at = count_++ % stride_;
    if (at == 0) runs_.emplace_back();
    if (at < kLength) runs_.back().push_back(point);
  }
  [[nodiscard]] const std::vector<std::vector<Eigen::Vector3d>>& runs() const { return runs_; }

 private:
  static constexpr std::uint64_t kRuns = 16;
  static constexpr std::uint64_t kLength = 512;

  std::uint64_t stride_ = kLength;
  std::uint64_t count_ = 0;
  std::vector<std::vector<Eigen::Vector3d>> runs_;
};

[[nodiscard]] inline PointRuns runs_of(const std::vector<Eigen::Vector3d>& points) {
  PointRuns runs(points.size());
  for (const Eigen::Vector3d& p : points) runs.add(p);
  return runs;
}

}  // namespace sparsha::pipeline
