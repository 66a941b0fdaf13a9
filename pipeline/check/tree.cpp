// Wraps pcl::KdTreeFLANN so that PCL's headers are compiled once.
#include "pipeline/check/tree.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "pipeline/scan/pcl_trees.hpp"

namespace sparsha::pipeline {

struct PointTree::Implementation {
  pcl::KdTreeFLANN<pcl::PointXYZ> tree{false};  // unsorted: nobody here asks for an order
  std::size_t size = 0;
};

PointTree::PointTree(std::span<const float> xyz) : implementation_(std::make_unique<Implementation>()) {
  implementation_->size = xyz.size() / 3;
  if (xyz.empty()) return;
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->resize(implementation_->size);
  for (std::size_t k = 0; k < implementation_->size; ++k) {
    (*cloud)[k] = pcl::PointXYZ(xyz[3 * k], xyz[3 * k + 1], xyz[3 * k + 2]);
  }
  implementation_->tree.setInputCloud(cloud);
}

PointTree::~PointTree() = default;

std::size_t PointTree::size() const { return implementation_->size; }

bool PointTree::nearest(float x, float y, float z, Answer& answer) const {
  if (implementation_->size == 0) return false;
  return implementation_->tree.nearestKSearch(pcl::PointXYZ(x, y, z), 1, answer.index, answer.squared_m2) == 1;
}

}  // namespace sparsha::pipeline
