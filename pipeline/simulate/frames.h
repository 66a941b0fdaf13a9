// Rotations between the frames of a simulation; free of the C library, so that they are the same everywhere.
#pragma once

#include <Eigen/Geometry>

#include "pipeline/simulate/simulate.h"

namespace sparsha::pipeline {

/// Rotation scan -> grid; the local frame of the surface differs from the grid frame by a translation only.
/// Throws Error{usage} when `up` is parallel to `look_from`.
[[nodiscard]] Eigen::Matrix3d grid_from_scan_rotation(const SimulationConfig& config);

}  // namespace sparsha::pipeline
