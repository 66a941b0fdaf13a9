// Groups of points that lie close together (Rusu 2009, Euclidean cluster extraction), and the one to keep.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/threads/context.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/filters.h"

namespace sparsha::pipeline {

/// label[i] = number of point i's cluster; clusters are numbered by their first point. Points closer than the tolerance
/// (float32 distances, as FLANN computes them) are in one. Points of all threads and orders: the same clusters.
[[nodiscard]] std::vector<std::uint32_t> euclidean_clusters(const Cloud& cloud, double tolerance_m,
                                                            const Context& context);

/// The same by pcl::EuclideanClusterExtraction, from one point to the next; single-threaded. Throws
/// Cancelled.
[[nodiscard]] std::vector<std::uint32_t> euclidean_clusters_by_pcl(const Cloud& cloud, double tolerance_m,
                                                                   const Progress& progress);

struct KeptCluster {
  std::vector<std::uint8_t> keep;  ///< one per point
  std::uint64_t points = 0;
  std::uint64_t clusters = 0;  ///< in all
  std::uint64_t next = 0;      ///< points of the largest other one
  std::uint64_t alone = 0;     ///< points in clusters of one or two
  double away_m = 0.0;         ///< from nearest_to to the nearest point
};

/// Clusters that a triangle joins are one. Of equal ones that with the smallest point by x, y, z. The cloud must have
/// points.
[[nodiscard]] KeptCluster choose_cluster(const Cloud& cloud, const scene::KeepConfig& config, const Context& context);

}  // namespace sparsha::pipeline
