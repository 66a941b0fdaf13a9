// How far the scan's points lie from the surface, place by place, as the cross-check found it: coarse, for the eye.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "scene/depth_grid.h"

namespace sparsha::scene {

struct CheckMap {
  static constexpr int kMostNodes = 512;  ///< of a side
  Lattice lattice;                        ///< grid frame; coarser than level 0
  std::vector<float> error_m;             ///< mean distance of points about a node; NaN where there is no surface
  double high_m = 0.0;                    ///< 95 % of the points lie nearer

  /// At the nearest node; NaN outside.
  [[nodiscard]] float at(double x_m, double y_m) const {
    const double i = std::round((x_m - lattice.origin_m.x()) / lattice.spacing_m);
    const double j = std::round((y_m - lattice.origin_m.y()) / lattice.spacing_m);
    // Level 0 goes on by half a spacing beyond the outer nodes.
    if (!(i >= -1.0 && j >= -1.0 && i <= lattice.nx && j <= lattice.ny)) return std::numeric_limits<float>::quiet_NaN();
    const auto inside = [](double k, int n) { return k < 0.0 ? 0 : k > n - 1 ? n - 1 : static_cast<int>(k); };
    return error_m[lattice.index(inside(i, lattice.nx), inside(j, lattice.ny))];
  }
};

}  // namespace sparsha::scene
