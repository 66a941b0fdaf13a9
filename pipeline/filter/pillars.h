// Round pillars in a scan: what is left without walls and floors, cluster by cluster, as cylinders.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "base/threads/progress.h"

namespace sparsha::pipeline {

/// A cylinder that was seen from at least one side. Frame and metres of the points it was found in.
struct Pillar {
  Eigen::Vector3d from_m = Eigen::Vector3d::Zero();  ///< the ends of its axis, as far as points reach
  Eigen::Vector3d to_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
};

/// Planes that hold much of the points go first (RANSAC, pcl::SampleConsensusModelPlane); the rest falls into clusters
/// (pcl::EuclideanClusterExtraction), and in each cylinders are looked for (RANSAC, pcl::SampleConsensusModelCylinder)
/// that are at least two and a half times as long as their radius. Seeded: the same points give the same pillars, in no
/// particular order. Some ten thousand points are enough; fewer than a hundred give none. Throws Cancelled.
[[nodiscard]] std::vector<Pillar> find_pillars(const std::vector<Eigen::Vector3d>& points_m, Progress& progress);

}  // namespace sparsha::pipeline
