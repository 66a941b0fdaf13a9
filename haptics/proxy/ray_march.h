// Free space: the straight way from the proxy to the hand, cell by cell, with the exact root of ray and patch.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/proxy/bilinear_patch.h"

namespace sparsha::haptics {

/// The smallest tau in [0, end] at which the ray p + tau w dips below the patch; a value beyond `end` when it does not.
/// `leaving`: p is on the surface, the root tau = 0 is divided out.
[[nodiscard]] inline double ray_patch_hit(const BilinearPatch& patch, const CellPoint& p, const CellVector& w,
                                          double end, bool leaving) noexcept {
  constexpr double kMiss = std::numeric_limits<double>::infinity();
  const double g1 = w.z - patch.slope_s(p.s, p.t) * w.x - patch.slope_t(p.s, p.t) * w.y;
  const double g2 = -patch.c * w.x * w.y;
  const double g0 = leaving ? 0.0 : p.z - patch.height(p.s, p.t);
  if (g0 <= 0.0) {
    // On the surface: gap = tau (g1 + tau g2).
    if (g1 > 0.0) return g1 + end * g2 < 0.0 ? -g1 / g2 : kMiss;
    if (g1 < 0.0 || g2 < 0.0) return 0.0;
    return kMiss;
  }
  const double at_end = g0 + end * (g1 + end * g2);
  if (at_end >= 0.0) {
    if (g2 <= 0.0 || g1 >= 0.0 || -g1 >= 2.0 * g2 * end) return kMiss;
    if (g1 * g1 <= 4.0 * g2 * g0) return kMiss;
  }
  const double root = std::sqrt(std::max(0.0, g1 * g1 - 4.0 * g2 * g0));
  return std::min(2.0 * g0 / (root - g1), end);
}

/// The quick part of a march: over inner cells that the straight way surely clears. Leaves `p` in the cell where that
/// is no longer sure, at the border, or where the way ends.
inline void skim(const BilinearSurface& surface, const CellVector& hip, CellPoint& p, int& segments,
                 int limit) noexcept {
  const CellVector w = hip - p;
  const auto inverse = [](double x) { return 1.0 / std::max(std::abs(x), std::numeric_limits<double>::min()); };
  const double per_x = inverse(w.x);
  const double per_y = inverse(w.y);
  const double bend = -w.x * w.y;
  const int step_i = w.x > 0.0 ? 1 : -1;
  const int step_j = w.y > 0.0 ? 1 : -1;
  double left = 1.0;  // share of the way
  while (segments < limit && surface.is_inner(p.i, p.j)) {
    const BilinearPatch patch = surface.patch_inside(p.i, p.j);
    const double end_s = (w.x > 0.0 ? 1.0 - p.s : w.x < 0.0 ? p.s : 1.0) * per_x;
    const double end_t = (w.y > 0.0 ? 1.0 - p.t : w.y < 0.0 ? p.t : 1.0) * per_y;
    const bool across_t = end_t < end_s;
    const double end = across_t ? end_t : end_s;
    if (!(end < left)) return;
    const double s = across_t ? std::clamp(p.s + end * w.x, 0.0, 1.0) : (step_i > 0 ? 1.0 : 0.0);
    const double t = across_t ? (step_j > 0 ? 1.0 : 0.0) : std::clamp(p.t + end * w.y, 0.0, 1.0);
    const double z = p.z + end * w.z;
    // The gap is a parabola: between its ends it sags by at most a quarter of its bend.
    const double gap = std::min(p.z - patch.height(p.s, p.t), z - patch.height(s, t));
    if (!(gap > 0.25 * end * end * std::max(0.0, bend * patch.c))) return;
    left -= end;
    ++segments;
    p.z = z;
    p.s = across_t ? s : 1.0 - s;
    p.t = across_t ? 1.0 - t : t;
    (across_t ? p.j : p.i) += across_t ? step_j : step_i;
  }
}

/// What a march came to.
enum class MarchEnd { hand, surface, limit };

/// Moves `p`, feasible, along the straight way to the hand until it is there, meets the surface or has spent the
/// segments that are left. `leaving`: p lies on the surface and the way leads off it.
template <class Surface>
[[nodiscard]] MarchEnd march_to_hand(const Surface& surface, const CellVector& hip, CellPoint& p, bool leaving,
                                     int& segments, int limit) noexcept {
  while (segments < limit) {
    if constexpr (Surface::kHasFastPath) {
      if (!leaving) skim(surface, hip, p, segments, limit);
    }
    ++segments;
    const CellVector w = hip - p;
    // Where the ray leaves the cell.
    double end = 1.0;
    int step_i = 0;
    int step_j = 0;
    if (w.x > 0.0 && surface.has_high_s(p.i) && p.s + w.x > 1.0) {
      end = (1.0 - p.s) / w.x;
      step_i = 1;
    } else if (w.x < 0.0 && surface.has_low_s(p.i) && p.s + w.x < 0.0) {
      end = p.s / -w.x;
      step_i = -1;
    }
    double end_t = 2.0;
    if (w.y > 0.0 && surface.has_high_t(p.j) && p.t + w.y > 1.0) {
      end_t = (1.0 - p.t) / w.y;
      step_j = 1;
    } else if (w.y < 0.0 && surface.has_low_t(p.j) && p.t + w.y < 0.0) {
      end_t = p.t / -w.y;
      step_j = -1;
    }
    if (end_t < end)
      end = end_t, step_i = 0;
    else
      step_j = 0;

    bool clear = false;
    if constexpr (!Surface::kHasFastPath)
      clear = !leaving && surface.is_below(p.i, p.j, std::min(p.z, p.z + end * w.z));
    const auto patch = clear ? typename Surface::Patch{} : surface.patch(p.i, p.j);
    const double hit = clear ? std::numeric_limits<double>::infinity() : ray_patch_hit(patch, p, w, end, leaving);
    leaving = false;
    if (hit <= end) {
      p.s += hit * w.x;
      p.t += hit * w.y;
      surface.keep_in_cell(p);
      p.z = patch.height(p.s, p.t);
      return MarchEnd::surface;
    }
    p.s += end * w.x;
    p.t += end * w.y;
    surface.keep_in_cell(p);
    const double floor = clear ? -std::numeric_limits<double>::infinity() : patch.height(p.s, p.t);
    if (step_i == 0 && step_j == 0) {
      // At the hand; rounding may have put it a hair below the patch.
      p.z = std::max(hip.z, floor);
      return hip.z < floor ? MarchEnd::surface : MarchEnd::hand;
    }
    p.z = std::max(p.z + end * w.z, floor);
    if (step_i != 0) {
      p.i += step_i;
      p.s = step_i > 0 ? 0.0 : 1.0;
    } else {
      p.j += step_j;
      p.t = step_j > 0 ? 0.0 : 1.0;
    }
  }
  return MarchEnd::limit;
}

}  // namespace sparsha::haptics
