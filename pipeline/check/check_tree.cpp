// Wraps pcl::KdTreeFLANN so that PCL's headers are compiled once.
#include "pipeline/check/check_tree.h"

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

namespace sparsha::pipeline {

struct PointTree::Implementation {
  pcl::KdTreeFLANN<pcl::PointXYZ> tree{false};  // unsorted: nobody here asks for an order
  std::size_t size = 0;

  template <typename PointAt>
  void build(std::size_t count, const PointAt& point_at) {
    size = count;
    if (count == 0) return;
    auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
    cloud->resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      const float* p = point_at(k);
      (*cloud)[k] = pcl::PointXYZ(p[0], p[1], p[2]);
    }
    tree.setInputCloud(cloud);
  }
};

PointTree::PointTree(std::span<const float> xyz) : implementation_(std::make_unique<Implementation>()) {
  implementation_->build(xyz.size() / 3, [&](std::size_t k) { return xyz.data() + 3 * k; });
}

PointTree::PointTree(std::span<const float> xyz, std::span<const std::uint32_t> chosen)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->build(chosen.size(), [&](std::size_t k) { return xyz.data() + 3 * std::size_t{chosen[k]}; });
}

PointTree::~PointTree() = default;

std::size_t PointTree::size() const { return implementation_->size; }

bool PointTree::nearest(float x, float y, float z, Answer& answer) const {
  if (implementation_->size == 0) return false;
  return implementation_->tree.nearestKSearch(pcl::PointXYZ(x, y, z), 1, answer.index, answer.squared_m2) == 1;
}

void PointTree::within(float x, float y, float z, double radius_m, Answer& answer) const {
  answer.index.clear();
  answer.squared_m2.clear();
  if (implementation_->size == 0) return;
  implementation_->tree.radiusSearch(pcl::PointXYZ(x, y, z), radius_m, answer.index, answer.squared_m2);
}

}  // namespace sparsha::pipeline
