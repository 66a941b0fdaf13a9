// Ground and paths for the haptic benchmarks, with their truth in closed form. Local frame, metres.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "haptics/surface/monge_surface.h"

namespace sparsha::bench {

/// A surface, a hand's path in it and, where it is known, where a frictionless proxy belongs.
struct HapticScene {
  std::string name;
  haptics::MongeSurface surface;
  std::vector<Eigen::Vector3d> hands;
  std::vector<Eigen::Vector3d> truth;  ///< empty: unknown
  double cells_per_tick = 0.0;         ///< mean
};

/// z = 0.05 sin(2 pi x) sin(2 pi y) over 1 m^2, the hand 2 mm along the normal under the path
/// x = 0.5 + 0.37 sin(0.9 t + 0.3), y = 0.5 + 0.33 sin(1.3 t).
[[nodiscard]] HapticScene sinusoid_scene(int nodes, double cells_per_tick, int ticks, bool friction);

/// Fractal stone (midpoint displacement, Hurst exponent 0.7), slopes of about 1, the hand 2 cells under the same path.
[[nodiscard]] HapticScene stone_scene(int nodes, double cells_per_tick, int ticks, bool friction, unsigned seed);

}  // namespace sparsha::bench
