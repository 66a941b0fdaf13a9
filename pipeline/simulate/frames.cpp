// Frames of placement and stations.
#include "pipeline/simulate/frames.h"

#include <cmath>

#include "base/error.h"

namespace sparsha::pipeline {
namespace {

double length(const Eigen::Vector3d& v) { return std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()); }

}  // namespace

Eigen::Matrix3d grid_from_scan_rotation(const SimulationConfig& config) {
  if (!(length(config.look_from) > 0.0) || !(length(config.up) > 0.0)) {
    throw usage_error("a direction of the placement is zero", "expected a vector with a length");
  }
  const Eigen::Vector3d z = config.look_from / length(config.look_from);
  const Eigen::Vector3d across = (config.up / length(config.up)).cross(z);
  if (!(length(across) > 1e-6)) {
    throw usage_error("the placement's up is parallel to its look_from", "expected two directions");
  }
  const Eigen::Vector3d x = across / length(across);
  Eigen::Matrix3d rotation;
  rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
  return rotation;
}

Eigen::Matrix3d local_from_station_rotation(const StationConfig& station) {
  Eigen::Vector3d forward = station.target_m - station.position_m;
  const double distance = length(forward);
  forward.y() = 0.0;
  if (!(length(forward) > 1e-3 * distance)) {
    throw usage_error("a station's target is straight above or below it",
                      "expected a scanner that looks at the surface");
  }
  forward /= length(forward);
  Eigen::Matrix3d rotation;
  rotation.col(0) = forward.cross(Eigen::Vector3d::UnitY());
  rotation.col(1) = forward;
  rotation.col(2) = Eigen::Vector3d::UnitY();
  return rotation;
}

StationPose scan_from_station(const SimulationConfig& config, const StationConfig& station) {
  const Eigen::Matrix3d scan_from_local = grid_from_scan_rotation(config).transpose();
  return {scan_from_local * local_from_station_rotation(station),
          scan_from_local * station.position_m + config.origin_m};
}

std::array<double, 4> quaternion_of(const Eigen::Matrix3d& r) {
  // Shepperd 1978: divide by the largest component.
  const double trace = r(0, 0) + r(1, 1) + r(2, 2);
  int largest = 3;
  double most = trace;
  for (int axis = 0; axis < 3; ++axis) {
    if (r(axis, axis) > most) {
      most = r(axis, axis);
      largest = axis;
    }
  }
  std::array<double, 4> q{};
  if (largest == 3) {
    const double s = 2.0 * std::sqrt(1.0 + trace);
    q = {(r(2, 1) - r(1, 2)) / s, (r(0, 2) - r(2, 0)) / s, (r(1, 0) - r(0, 1)) / s, 0.25 * s};
  } else {
    const int j = (largest + 1) % 3;
    const int k = (largest + 2) % 3;
    const double s = 2.0 * std::sqrt(1.0 + r(largest, largest) - r(j, j) - r(k, k));
    q[static_cast<std::size_t>(largest)] = 0.25 * s;
    q[static_cast<std::size_t>(j)] = (r(j, largest) + r(largest, j)) / s;
    q[static_cast<std::size_t>(k)] = (r(k, largest) + r(largest, k)) / s;
    q[3] = (r(k, j) - r(j, k)) / s;
  }
  if (q[3] < 0.0) {
    for (double& component : q) component = -component;
  }
  return q;
}

}  // namespace sparsha::pipeline
