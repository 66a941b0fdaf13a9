// Which part of a level a hand reaches at once, and how much it is magnified.
#pragma once

#include <algorithm>

#include "scene/depth_grid.h"

namespace sparsha::scene {

/// Width of a desktop device's workspace, metres: what pictures and offline paths assume where no device is known.
inline constexpr double kDeskWorkspace_m = 0.1;

/// Nodes a side of a window where `levels.window` is `wanted`; levels that have fewer are touched as a whole.
[[nodiscard]] inline int window_nodes(int wanted) {
  constexpr int kSmallest = 8;
  return std::max(kSmallest, wanted);
}

/// Width of a window of nx x ny nodes, grid frame, metres: that of its longer side.
[[nodiscard]] inline double window_width_m(int nx, int ny, double spacing_m) {
  return std::max(1, std::max(nx, ny) - 1) * spacing_m;
}

/// The same of a window of a level that may reach beyond it: what lies there is not counted.
[[nodiscard]] inline double window_width_m(int nx, int ny, const Lattice& level) {
  return window_width_m(std::min(nx, level.nx), std::min(ny, level.ny), level.spacing_m);
}

/// Device metres a grid metre where a window of `levels.window` nodes of a level fills a workspace of `workspace_m`.
[[nodiscard]] inline double level_scale(int wanted, const Lattice& level, double workspace_m) {
  const int most = window_nodes(wanted);
  return workspace_m / window_width_m(most, most, level);
}

}  // namespace sparsha::scene
