// What all entrants run over: analytic surfaces, the hand's path under them and the true foot of the hand at every
// tick, none of which knows a solver. Local frame, metres; surfaces of 1 m x 1 m.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "haptics/surface/monge_surface.h"

namespace sparsha::protocol {

struct Ground {
  std::string name;
  std::function<double(double x, double y)> height;
  std::function<Eigen::Vector2d(double x, double y)> slope;
  double most_depth_m = 0.0;  ///< 0.7 of the smallest radius of a top: deeper hands have more than one foot
};

/// sinusoid (z = 0.05 sin(2 pi x) sin(2 pi y), the source paper's), plane, cap (of a ball of radius 1 m), ridge
/// (hyperbolic, top radius 40 mm), step (20 mm high, tanh, top radius 13 mm), stone (five octaves of waves, Hurst
/// exponent 0.9, the finest 31 mm long).
[[nodiscard]] std::vector<Ground> all_grounds();

/// 0.7 of the smallest radius of a top: how deep a hand may be and still have one foot. `margin_m` along the borders
/// does not count; the path keeps 0.13 m away from them.
[[nodiscard]] double deepest_m(const Ground& ground, double margin_m = 0.0);

/// The nodes of the grid: what every method is made from.
[[nodiscard]] haptics::MongeSurface sample(const Ground& ground, int nodes_per_side);

struct Course {
  std::vector<Eigen::Vector3d> hands;
  std::vector<Eigen::Vector3d> feet;  ///< where a frictionless proxy belongs
  std::size_t first = 0;              ///< the ticks before come down from free space
};

/// x = 0.5 + 0.37 sin(0.9 t + 0.3), y = 0.5 + 0.33 sin(1.3 t), mean speed `metres_per_tick`, the hand `depth_m` under
/// the foot along the surface's normal: the foot is the nearest point and a strict local minimum.
[[nodiscard]] Course make_course(const Ground& ground, double metres_per_tick, double depth_m, int ticks);

}  // namespace sparsha::protocol
