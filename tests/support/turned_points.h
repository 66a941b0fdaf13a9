// Points of tests that turn objects, and angles between directions.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Core>

namespace sparsha::test {

using Points = std::vector<Eigen::Vector3d>;

inline constexpr double kDegree = std::numbers::pi / 180.0;

inline double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) / kDegree;
}

inline Points turned(const Points& points, const Eigen::Matrix3d& turn) {
  Points out;
  for (const Eigen::Vector3d& p : points) out.emplace_back(turn * p);
  return out;
}

}  // namespace sparsha::test
