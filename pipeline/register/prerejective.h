// Where one scan may lie on another, from descriptors alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "base/threads/context.h"
#include "pipeline/register/features.h"

namespace sparsha::pipeline {

struct PoseGuess {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< source to target
  double inliers = 0.0;  ///< share of the source's places that have theirs on the target
};

/// True when two poses of a scan whose places these are put them nearly together.
[[nodiscard]] bool nearly_same(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, const Eigen::Vector3d& middle,
                               double distance_m);

struct GuessLimits {
  double touch_m = 0.0;    ///< places that lie nearer are one
  double least_m = 0.0;    ///< edges of a sample are at least so long
  double apart_m = 0.0;    ///< guesses that differ by less are one
  std::size_t most = 10;   ///< guesses
  int samples = 0;         ///< that are drawn
  std::uint64_t seed = 0;  ///< the same result every time
};

/// The best guesses of pcl::SampleConsensusPrerejective that differ, best first. Throws Cancelled.
[[nodiscard]] std::vector<PoseGuess> guess_pair(const ScanFeatures& source, const ScanFeatures& target,
                                                const GuessLimits& limits, const Progress& progress);

/// How many descriptors of `a` and `b` are nearest to each other.
[[nodiscard]] std::size_t mutual_matches(const ScanFeatures& a, const ScanFeatures& b);

}  // namespace sparsha::pipeline
