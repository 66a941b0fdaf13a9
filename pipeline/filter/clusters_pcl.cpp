// PCL's clusters.
#include <pcl/point_types.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/impl/extract_clusters.hpp>

#include <algorithm>

#include "pipeline/filter/cancellable_tree.h"
#include "pipeline/filter/clusters.h"
#include "pipeline/scan/pcl_trees.hpp"

namespace sparsha::pipeline {

std::vector<std::uint32_t> euclidean_clusters_by_pcl(const Cloud& cloud, double tolerance_m, const Progress& progress) {
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setInputCloud(cloud.points);
  extraction.setSearchMethod(cancellable_tree(progress));
  extraction.setClusterTolerance(tolerance_m);
  std::vector<pcl::PointIndices> clusters;
  extraction.extract(clusters);
  std::sort(clusters.begin(), clusters.end(),
            [](const auto& a, const auto& b) { return a.indices.front() < b.indices.front(); });
  std::vector<std::uint32_t> label(cloud.size());
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    for (const pcl::index_t i : clusters[c].indices) label[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(c);
  }
  return label;
}

}  // namespace sparsha::pipeline
