// Normals as PCL's users find them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/cloud.h"

namespace sparsha::bench {

/// pcl::NormalEstimationOMP through `neighbours` points of a kd-tree; one normal per point.
[[nodiscard]] std::vector<Eigen::Vector3f> by_pcl_normals(const pipeline::Cloud& cloud, int neighbours,
                                                          unsigned threads);

/// Whether the function above was compiled with OpenMP; without, it runs on one thread whatever it is asked for.
[[nodiscard]] bool pcl_normals_have_threads();

}  // namespace sparsha::bench
