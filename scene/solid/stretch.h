// Where a line is in a box.
#pragma once

#include <algorithm>
#include <limits>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sparsha::scene {

/// In lengths of the line's direction from its beginning; `last` below `first` where the line passes by.
struct Stretch {
  double first = 0.0;
  double last = std::numeric_limits<double>::infinity();
};

/// The slabs of the box one after the other (Kay & Kajiya 1986). `way`: not zero, or the stretch has no end. No
/// allocation.
[[nodiscard]] inline Stretch stretch_in(const Eigen::AlignedBox3d& box_m, const Eigen::Vector3d& from_m,
                                        const Eigen::Vector3d& way) noexcept {
  Stretch stretch;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box_m.min()[axis] - from_m[axis];
    const double high = box_m.max()[axis] - from_m[axis];
    if (way[axis] == 0.0) {
      if (low > 0.0 || high < 0.0) return {1.0, 0.0};
      continue;
    }
    const double a = low / way[axis];
    const double b = high / way[axis];
    stretch.first = std::max(stretch.first, std::min(a, b));
    stretch.last = std::min(stretch.last, std::max(a, b));
  }
  return stretch;
}

}  // namespace sparsha::scene
