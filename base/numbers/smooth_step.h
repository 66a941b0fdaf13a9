// A step without corners, for whatever fades from one value to another.
#pragma once

#include <algorithm>

namespace sparsha {

/// 0 up to 0, 1 from 1 on, and between them the cubic that begins and ends level.
[[nodiscard]] inline double smooth_step(double share) noexcept {
  const double s = std::clamp(share, 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

}  // namespace sparsha
