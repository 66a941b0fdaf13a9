// The frame that parts and sounds are written in.
#pragma once

#include <Eigen/Core>

namespace sparsha::pipeline {

/// From the grid frame to the one that the scene's parts and sounds are written in: places on the object stay what they
/// are when it is scanned from another side.
using RegionFrame = Eigen::Matrix<double, 3, 4, Eigen::RowMajor | Eigen::DontAlign>;

}  // namespace sparsha::pipeline
