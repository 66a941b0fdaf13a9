// Filters that decide about one point at a time, so that they work on a cloud and on a stream of points alike.
#pragma once

#include <variant>

#include <Eigen/Core>

#include "scene/config/filters.h"

namespace sparsha::pipeline {

/// A plane that was found, and the side of it that goes.
struct PlaneCut {
  Eigen::Vector3d normal{0, 0, 1};  ///< length 1, from below to above
  double offset_m = 0.0;            ///< height above the plane = normal * p + offset, p relative to the cloud's origin
  double distance_m = 0.0;
  scene::RemovePlaneConfig::Side side = scene::RemovePlaneConfig::Side::below;
};

using PointTest = std::variant<scene::CropConfig, scene::PassConfig, PlaneCut>;

[[nodiscard]] inline bool keeps(const scene::CropConfig& crop, const Eigen::Vector3d& origin_m,
                                const Eigen::Vector3f& point) {
  const Eigen::Vector3d p = origin_m + point.cast<double>();
  return (p.array() >= crop.min_m.array()).all() && (p.array() <= crop.max_m.array()).all();
}

[[nodiscard]] inline bool keeps(const scene::PassConfig& pass, const Eigen::Vector3d& origin_m,
                                const Eigen::Vector3f& point) {
  const double coordinate = origin_m[pass.axis] + static_cast<double>(point[pass.axis]);
  return coordinate >= pass.min_m && coordinate <= pass.max_m;
}

/// Above the plane, metres.
[[nodiscard]] inline double height_m(const PlaneCut& cut, const Eigen::Vector3f& point) {
  return cut.normal.dot(point.cast<double>()) + cut.offset_m;
}

[[nodiscard]] inline bool keeps(const PlaneCut& cut, const Eigen::Vector3d& /*origin_m*/,
                                const Eigen::Vector3f& point) {
  const double height = height_m(cut, point);
  if (cut.side == scene::RemovePlaneConfig::Side::below) return height > cut.distance_m;
  if (cut.side == scene::RemovePlaneConfig::Side::above) return height < -cut.distance_m;
  return height > cut.distance_m || height < -cut.distance_m;
}

/// `point` is relative to `origin_m`, the cloud's.
[[nodiscard]] inline bool keeps(const PointTest& test, const Eigen::Vector3d& origin_m, const Eigen::Vector3f& point) {
  return std::visit([&](const auto& t) { return keeps(t, origin_m, point); }, test);
}

}  // namespace sparsha::pipeline
