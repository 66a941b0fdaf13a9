// The frame that parts and sounds are written in, and how far a place is inside one of them.
#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Core>

#include "base/numbers/smooth_step.h"

namespace sparsha::scene {

/// From the grid frame to the one that the scene's parts and sounds are written in: places on the object stay what they
/// are when it is scanned from another side.
using RegionFrame = Eigen::Matrix<double, 3, 4, Eigen::RowMajor | Eigen::DontAlign>;

/// At the hand: what a part changes of the touch changes over so wide a border, half of it on either side, so that no
/// force jumps there.
inline constexpr double kBorder_m = 0.002;

/// 1 inside `box_m` (xmin ymin xmax ymax), 0 outside, a smooth step over `width_m` across its border.
[[nodiscard]] inline double share_inside(const std::array<double, 4>& box_m, double x_m, double y_m, double width_m) {
  const double inside_m = std::min({x_m - box_m[0], y_m - box_m[1], box_m[2] - x_m, box_m[3] - y_m});
  return smooth_step(0.5 + inside_m / width_m);
}

}  // namespace sparsha::scene
