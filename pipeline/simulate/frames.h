// Rotations between the frames of a simulation; free of the C library, so that they are the same everywhere.
#pragma once

#include <array>

#include <Eigen/Geometry>

#include "pipeline/simulate/simulate.h"

namespace sparsha::pipeline {

/// Rotation scan -> grid; the local frame of the surface differs from the grid frame by a translation only.
/// Throws Error{usage} when `up` is parallel to `look_from`.
[[nodiscard]] Eigen::Matrix3d grid_from_scan_rotation(const SimulationConfig& config);

/// A levelled scanner: its z is local y, its y points at the target's azimuth, its x to the right.
/// Columns are its axes in the local frame. Throws Error{usage} when the target is straight above or below.
[[nodiscard]] Eigen::Matrix3d local_from_station_rotation(const StationConfig& station);

/// scan = R * station + t.
struct StationPose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation_m;
};
[[nodiscard]] StationPose scan_from_station(const SimulationConfig& config, const StationConfig& station);

/// Unit quaternion x y z w of a rotation matrix, w >= 0.
[[nodiscard]] std::array<double, 4> quaternion_of(const Eigen::Matrix3d& rotation);

}  // namespace sparsha::pipeline
