#include "pipeline/scan/viewpoint.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

/// No turn where the quaternion is zero or no number, as of programs that do not know.
Eigen::Quaterniond turn_of(const Viewpoint& viewpoint) {
  const Eigen::Quaterniond turn(viewpoint[3], viewpoint[4], viewpoint[5], viewpoint[6]);
  const double length = turn.norm();
  return std::isfinite(length) && length > 0.0 ? turn.normalized() : Eigen::Quaterniond::Identity();
}

Eigen::Vector3d place_of(const Viewpoint& viewpoint) { return {viewpoint[0], viewpoint[1], viewpoint[2]}; }

}  // namespace

std::string viewpoint_doubt(const Viewpoint& viewpoint) {
  constexpr double kTurned = 1e-6;  // radians
  const Eigen::Quaterniond turn = turn_of(viewpoint);
  const Eigen::Vector3d place = place_of(viewpoint);
  if (place.isZero(0.0) && turn.angularDistance(Eigen::Quaterniond::Identity()) < kTurned) return {};
  return fmt::format(
      "its VIEWPOINT {:.6g} is not applied to the points{}; if they are in the scanner's own frame, 'pose: "
      "{{translate: [{:.9g}, "
      "{:.9g}, {:.9g}], quaternion: [{:.9g}, {:.9g}, {:.9g}, {:.9g}]}}' of the scan in the configuration moves them "
      "(translate in metres)",
      fmt::join(viewpoint, " "), place.isZero(0.0) ? "" : ", its place alone is used, as the scanner's", place.x(),
      place.y(), place.z(), turn.x(), turn.y(), turn.z(), turn.w());
}

bool is_viewpoint(const Viewpoint& viewpoint, const Eigen::Matrix4d& pose, double metres) {
  constexpr double kLike = 1e-4;  // of a turn in radians, and of the distance, as few decimals leave
  const Eigen::Vector3d place = place_of(viewpoint) * metres;
  const Eigen::Matrix3d turn = turn_of(viewpoint).toRotationMatrix();
  return (pose.topLeftCorner<3, 3>() - turn).cwiseAbs().maxCoeff() <= kLike &&
         (pose.topRightCorner<3, 1>() - place).norm() <= kLike * std::max(place.norm(), 1.0);
}

}  // namespace sparsha::pipeline
