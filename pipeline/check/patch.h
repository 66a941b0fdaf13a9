// The point of a bilinear patch nearest to a given point, exactly. Unit: one cell, in x, y and z alike.
#pragma once

namespace sparsha::pipeline {

/// z(u, v) = z00 (1-u)(1-v) + z10 u (1-v) + z01 (1-u) v + z11 u v over the unit square.
struct Patch {
  double z00 = 0, z10 = 0, z01 = 0, z11 = 0;
};

struct PatchPoint {
  double u = 0, v = 0;
  double squared_distance = 0;  ///< cells^2
  double side = 0;              ///< > 0: the point lies above the patch's tangent plane at (u, v), towards the viewer
};

/// Nearest point of the patch to (x, y, z), given in the cell's own units with the patch over [0, 1]^2.
[[nodiscard]] PatchPoint closest_on_patch(const Patch& patch, double x, double y, double z) noexcept;

/// The same without polynomials: a golden-section search about each of 65 lines that lies nearer than those beside it,
/// and Newton's steps from its end. It judges the other.
[[nodiscard]] PatchPoint closest_on_patch_by_search(const Patch& patch, double x, double y, double z) noexcept;

}  // namespace sparsha::pipeline
