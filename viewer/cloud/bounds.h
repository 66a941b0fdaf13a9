// Bounds of an object among its strays.
#pragma once

#include <span>

#include <Eigen/Core>

namespace sparsha::viewer {

struct Bounds {
  Eigen::Vector3f low = Eigen::Vector3f::Zero();
  Eigen::Vector3f high = Eigen::Vector3f::Zero();

  [[nodiscard]] bool contains(const Eigen::Vector3f& p) const {
    return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
  }
};

/// Of the points that lie, along every axis, between the half percent at either end or a quarter of that range beyond.
/// Exact where there are no strays farther out. There must be points.
[[nodiscard]] Bounds bounds_of(std::span<const Eigen::Vector3f> points);

}  // namespace sparsha::viewer
