// R = Rz Ry Rx, solved for its angles.
#include "scene/frame/euler.h"

#include <cmath>
#include <numbers>

namespace sparsha::scene {

Eigen::Vector3d euler_deg(const Eigen::Matrix3d& r) {
  const double degree = std::numbers::pi / 180.0, across = std::hypot(r(0, 0), r(1, 0));
  // Then only the sum of x and z is known.
  constexpr double kLocked = 1e-9;
  const bool locked = across < kLocked;
  const double x = locked ? 0.0 : std::atan2(r(2, 1), r(2, 2));
  const double y = std::atan2(-r(2, 0), across);
  const double z = locked ? std::atan2(-r(0, 1), r(1, 1)) : std::atan2(r(1, 0), r(0, 0));
  // Adding zero makes -0 a plain zero.
  return Eigen::Vector3d(x, y, z) / degree + Eigen::Vector3d::Zero();
}

}  // namespace sparsha::scene
