// The configuration's blocks `grid` and `around`.
#pragma once

#include <array>
#include <optional>

namespace sparsha::scene {

struct GridConfig {
  int size = 0;                                   ///< nodes along the longer side; 0 = not given
  double spacing_m = 0.0;                         ///< 0 = not given; neither given = automatic
  std::optional<std::array<double, 4>> bounds_m;  ///< xmin ymin xmax ymax, grid frame
  std::optional<double> noise_m;                  ///< of the points across the surface; absent = estimated
  bool colour = false;                            ///< keep a colour layer when the scans have colour
  bool intensity = false;                         ///< keep an intensity layer when the scans have intensity
};

/// The block `around`: the whole object from all sides, see scene/charts.h. Has no keys yet.
struct AroundConfig {};

}  // namespace sparsha::scene
