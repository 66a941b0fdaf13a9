// The hand's path over a surface of 1 m x 1 m that the benchmarks share.
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace sparsha::protocol {

/// Metres per unit of t, mean.
inline constexpr double kPathSpeed = 0.348;

/// x = 0.5 + 0.37 sin(0.9 t + 0.3), y = 0.5 + 0.33 sin(1.3 t); metres.
inline Eigen::Vector2d place_on_path(double t) {
  return {0.5 + 0.37 * std::sin(0.9 * t + 0.3), 0.5 + 0.33 * std::sin(1.3 * t)};
}

}  // namespace sparsha::protocol
