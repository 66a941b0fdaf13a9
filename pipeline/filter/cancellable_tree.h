// PCL's kd-tree for PCL's own filters, which know nothing of cancelling. For the files that call PCL only.
#pragma once

#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include "base/progress.h"

namespace sparsha::pipeline {

/// Every search throws Cancelled once that is asked for; PCL's filters search for each point. One thread.
class CancellableTree : public pcl::search::KdTree<pcl::PointXYZ> {
 public:
  /// Neighbours without order, as PCL's filters search by themselves.
  explicit CancellableTree(const Progress& progress) : KdTree(false), progress_(progress) {}

  using KdTree::nearestKSearch;
  using KdTree::radiusSearch;
  int nearestKSearch(const pcl::PointXYZ& point, int k, pcl::Indices& found,
                     std::vector<float>& squared_distances) const override {
    progress_.throw_if_cancelled();
    return KdTree::nearestKSearch(point, k, found, squared_distances);
  }
  int radiusSearch(const pcl::PointXYZ& point, double radius, pcl::Indices& found,
                   std::vector<float>& squared_distances, unsigned int most = 0) const override {
    progress_.throw_if_cancelled();
    return KdTree::radiusSearch(point, radius, found, squared_distances, most);
  }

 private:
  const Progress& progress_;
};

}  // namespace sparsha::pipeline
