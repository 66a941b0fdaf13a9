// Asks before each search.
#include "pipeline/filter/cancellable_tree.h"

#include <vector>

#include <pcl/point_types.h>

#include "pipeline/scan/pcl_trees.hpp"

namespace sparsha::pipeline {
namespace {

class CancellableTree : public pcl::search::KdTree<pcl::PointXYZ> {
 public:
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

}  // namespace

std::shared_ptr<pcl::search::Search<pcl::PointXYZ>> cancellable_tree(const Progress& progress) {
  return std::make_shared<CancellableTree>(progress);
}

}  // namespace sparsha::pipeline
