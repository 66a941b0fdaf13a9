// The box of an object without its far outliers.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace sparsha::pipeline {

/// Corners of the 1st to 99th percentile box, metres: a far outlier says nothing about the object.
struct InnerBox {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
};
[[nodiscard]] InnerBox inner_box(const std::vector<Eigen::Vector3d>& points_m);

}  // namespace sparsha::pipeline
