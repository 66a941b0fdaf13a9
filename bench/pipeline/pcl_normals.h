// Normals as PCL's users find them.
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "pipeline/scan/cloud.h"

namespace sparsha::bench {

/// pcl::NormalEstimationOMP through `neighbours` points of a kd-tree.
[[nodiscard]] pcl::PointCloud<pcl::Normal> by_pcl_normals(const pipeline::Cloud& cloud, int neighbours,
                                                          unsigned threads);

/// Whether the function above was compiled with OpenMP; without, it runs on one thread whatever it is asked for.
[[nodiscard]] bool pcl_normals_have_threads();

}  // namespace sparsha::bench
