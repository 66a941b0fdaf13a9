// One step of descent of D = |hip - p|^2 / 2 on a cell: Newton direction, first minimum along it, border.
#pragma once

#include <algorithm>
#include <cmath>

#include "haptics/proxy/bilinear_patch.h"
#include "haptics/proxy/tangent_cone.h"

namespace sparsha::haptics {

/// A straight piece in a cell's (s, t).
struct Segment {
  double ds = 0.0;
  double dt = 0.0;
};

/// Newton on both coordinates where the Hessian is safely positive and the step keeps to the quadrant; else the
/// projection itself, which is the Gauss-Newton step. Along an edge the projection is the exact minimum.
[[nodiscard]] inline Segment descent_direction(const BilinearPatch& patch, const CellPoint&, const Pull& pull,
                                               const CellVector& w, const TangentProjection& tangent, Freedom s,
                                               Freedom t) noexcept {
  if (tangent.ds == 0.0 || tangent.dt == 0.0) return {tangent.ds, tangent.dt};
  // In the narrow curved valleys of steep cells the determinant is a small share of what it is the difference of: it is
  // written without that difference, and a very small share is still good.
  constexpr double kSafelyPositive = 1e-12;  // of the product of the diagonal
  const double hss = 1.0 + pull.fs * pull.fs;
  const double htt = 1.0 + pull.ft * pull.ft;
  const double bend = w.z * patch.c;
  const double hst = pull.fs * pull.ft - bend;
  const double determinant = pull.area + (2.0 * pull.fs * pull.ft - bend) * bend;
  if (determinant > kSafelyPositive * hss * htt) {
    const double inverse = 1.0 / determinant;
    const Segment newton{(pull.bs * htt - pull.bt * hst) * inverse, (pull.bt * hss - pull.bs * hst) * inverse};
    if (allows(s, newton.ds) && allows(t, newton.dt)) return newton;
  }
  return {tangent.ds, tangent.dt};
}

/// d D / d tau along a straight segment of a bilinear patch: a cubic without cancellation.
struct SegmentSlope {
  double k0, k1, k2, k3;

  SegmentSlope(const BilinearPatch& patch, const Pull& pull, const CellVector& w, const Segment& d) noexcept {
    const double rise = pull.fs * d.ds + pull.ft * d.dt;
    const double twist = patch.c * d.ds * d.dt;
    k0 = -(pull.bs * d.ds + pull.bt * d.dt);
    k1 = d.ds * d.ds + d.dt * d.dt + rise * rise - 2.0 * w.z * twist;
    k2 = 3.0 * rise * twist;
    k3 = 2.0 * twist * twist;
  }
  [[nodiscard]] double operator()(double tau) const noexcept { return k0 + tau * (k1 + tau * (k2 + tau * k3)); }
  /// D(tau) - D(0).
  [[nodiscard]] double change(double tau) const noexcept {
    return tau * (k0 + tau * (k1 / 2.0 + tau * (k2 / 3.0 + tau * (k3 / 4.0))));
  }
  [[nodiscard]] bool convex_to(double tau) const noexcept { return k1 + 2.0 * std::min(0.0, k2 * tau) >= 0.0; }
};

/// First zero of the slope in (low, high], where slope(low) < 0 <= slope(high): Newton kept in its bracket.
[[nodiscard]] inline double slope_zero(const SegmentSlope& slope, double low, double high) noexcept {
  double tau = 0.5 * (low + high);
  for (int i = 0; i < 60 && low < high; ++i) {
    const double value = slope(tau);
    (value < 0.0 ? low : high) = tau;
    const double curvature = slope.k1 + tau * (2.0 * slope.k2 + tau * 3.0 * slope.k3);
    double next = tau - value / curvature;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == tau) break;
    tau = next;
  }
  return tau;
}

/// How far along the segment, at most to `end`, D falls without ever rising on the way: nothing is jumped over.
/// A small overshoot of the first minimum is allowed when D falls enough and is convex there.
[[nodiscard]] inline double descent_length(const SegmentSlope& slope, double end) noexcept {
  constexpr double kArmijo = 0.1;
  if (slope.convex_to(end)) {
    if (slope.change(end) <= kArmijo * end * slope.k0) return end;
    return slope(end) > 0.0 ? slope_zero(slope, 0.0, end) : end;
  }
  // Between the zeros of its derivative the cubic slope is monotone: the first such piece that ends above zero holds
  // the first minimum.
  const double discriminant = slope.k2 * slope.k2 - 3.0 * slope.k3 * slope.k1;
  double low = 0.0;
  if (discriminant > 0.0) {
    const double root = std::sqrt(discriminant);
    const double first = slope.k1 / (-slope.k2 + std::copysign(root, -slope.k2));
    const double second = (-slope.k2 + std::copysign(root, -slope.k2)) / (3.0 * slope.k3);
    for (const double turn : {std::min(first, second), std::max(first, second)}) {
      if (!(turn > low && turn < end)) continue;
      if (slope(turn) >= 0.0) return slope_zero(slope, low, turn);
      low = turn;
    }
  }
  return slope(end) >= 0.0 ? slope_zero(slope, low, end) : end;
}

/// Share of the segment that lies inside the cell, at most 1.
template <class Surface>
[[nodiscard]] inline double length_in_cell(const Surface& surface, const CellPoint& p, const Segment& d) noexcept {
  double end = 1.0;
  if (p.s + d.ds > 1.0 && surface.has_high_s(p.i)) end = std::min(end, (1.0 - p.s) / d.ds);
  if (p.s + d.ds < 0.0 && surface.has_low_s(p.i)) end = std::min(end, -p.s / d.ds);
  if (p.t + d.dt > 1.0 && surface.has_high_t(p.j)) end = std::min(end, (1.0 - p.t) / d.dt);
  if (p.t + d.dt < 0.0 && surface.has_low_t(p.j)) end = std::min(end, -p.t / d.dt);
  return end;
}

/// p moved by tau d inside its cell; where the segment reaches an edge, exactly onto it.
template <class Surface>
[[nodiscard]] inline CellPoint moved(const Surface& surface, const CellPoint& p, const Segment& d, double tau,
                                     double end) noexcept {
  CellPoint q = p;
  q.s += tau * d.ds;
  q.t += tau * d.dt;
  if (tau == end && end < 1.0) {
    // The nearer edge in the direction of motion is the one that cut the segment.
    const double to_s = d.ds > 0.0 && surface.has_high_s(p.i)  ? (1.0 - p.s) / d.ds
                        : d.ds < 0.0 && surface.has_low_s(p.i) ? -p.s / d.ds
                                                               : 2.0;
    const double to_t = d.dt > 0.0 && surface.has_high_t(p.j)  ? (1.0 - p.t) / d.dt
                        : d.dt < 0.0 && surface.has_low_t(p.j) ? -p.t / d.dt
                                                               : 2.0;
    if (to_s <= end) q.s = d.ds > 0.0 ? 1.0 : 0.0;
    if (to_t <= end) q.t = d.dt > 0.0 ? 1.0 : 0.0;
  }
  surface.keep_in_cell(q);
  return q;
}

}  // namespace sparsha::haptics
