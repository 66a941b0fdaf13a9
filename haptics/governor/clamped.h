#pragma once

#include <Eigen/Core>

namespace sparsha::haptics {

/// At most `most_n` long, direction kept; requires numbers.
[[nodiscard]] inline Eigen::Vector3d clamped(const Eigen::Vector3d& force_n, double most_n) noexcept {
  const double magnitude = force_n.norm();
  return magnitude > most_n ? Eigen::Vector3d(force_n * (most_n / magnitude)) : force_n;
}

}  // namespace sparsha::haptics
