// `euler_deg` of a rotation.
#pragma once

#include <Eigen/Core>

namespace sparsha::scene {

/// Angles about the fixed axes x, y and z, x first, degrees. Where y is 90 degrees, x is 0.
[[nodiscard]] Eigen::Vector3d euler_deg(const Eigen::Matrix3d& rotation);

}  // namespace sparsha::scene
