// Eigen's vectors to and from the plain arrays of State.
#pragma once

#include <array>

#include <Eigen/Core>

namespace sparsha::haptics {

[[nodiscard]] inline std::array<double, 3> to_array(const Eigen::Vector3d& v) noexcept { return {v.x(), v.y(), v.z()}; }
[[nodiscard]] inline Eigen::Vector3d to_vector(const std::array<double, 3>& v) noexcept { return {v[0], v[1], v[2]}; }

}  // namespace sparsha::haptics
