// Carved elements of the relief as heights in closed form, metres; where an element is not, its height falls away below
// the ground, so that elements are joined by their maximum.
#pragma once

namespace sparsha::pipeline {

/// Maximum with a rounded joint of width `soft` in height.
[[nodiscard]] double soft_max(double a, double b, double soft);

/// 0 below `low`, 1 above `high`, smooth between.
[[nodiscard]] double smooth_ramp(double low, double high, double x);

/// A pointed petal along +u from `root` to `tip`.
struct Petal {
  double root, tip;   ///< along the axis
  double half_width;  ///< at its widest
  double base, rise;  ///< height at the root; added towards the middle
  double droop;       ///< taken away towards the tip
};
/// Height at (u, v), v across the axis: hollow between a raised rim and a midrib, with fine ribs.
[[nodiscard]] double petal_z(const Petal& petal, double u, double v);

/// `count` petals around the origin, the first at `phase` of a sector; angle in turns.
[[nodiscard]] double petal_ring_z(const Petal& petal, int count, double phase, double radius, double angle_turns);

/// Half balls of radius `ball` on a circle of radius `ring`.
[[nodiscard]] double bead_ring_z(double ball, double ring, int count, double radius, double angle_turns);

/// Round moulding: half a circle of `half_width` about distance 0, `z` high.
[[nodiscard]] double torus_z(double z, double half_width, double distance);

/// Lotus pod: a low drum with seeds.
[[nodiscard]] double pod_z(double drum_radius, double z, double radius, double angle_turns);

}  // namespace sparsha::pipeline
