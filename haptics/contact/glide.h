// The fast lane of the exact solver: a proxy that slides smoothly through the insides of cells and across their edges.
// It takes the same decisions as the general steps and hands over to them whenever something is out of the ordinary:
// creases, nodes, lift-off, indefinite Hessians, the border, cases within rounding.
#pragma once

#include <algorithm>
#include <cmath>

#include "haptics/contact/bilinear_patch.h"
#include "haptics/contact/hot.h"
#include "haptics/contact/pair.h"
#include "haptics/contact/slide.h"

namespace sparsha::haptics {

enum class GlideEnd { rest, handed_over };

/// Where the proxy came to rest, for whoever reports it.
struct RestPlace {
  bool known = false;
  CellVector normal;  ///< of any length; on edges and nodes the mean of the touching patches'
  double mu_dynamic = 0.0;
};

/// What the solvers carry from step to step of one tick.
struct TickCourse {
  bool sticking = false;
  bool may_stick_again = false;  ///< a slipping proxy's first look at friction in this tick
  int segments = 0;
};

/// True when s and t are strictly inside the cell.
[[nodiscard]] inline bool is_strictly_inside(const CellPoint& p) noexcept {
  return std::min(p.s, p.t) > 0.0 && std::max(p.s, p.t) < 1.0;
}

/// Slides `p`, strictly inside an inner cell with this patch or on an edge of it, until it rests or the general steps
/// must go on. `inward`: after an edge was crossed only steps further that way are taken, +1 or -1 along s or t.
template <bool kFriction>
[[nodiscard]] SPARSHA_HOT inline GlideEnd glide(const BilinearSurface& surface, const CellVector& hip, double tolerance,
                                                int limit, CellPoint& p, BilinearPatch patch, Pair inward,
                                                TickCourse& course, RestPlace& place) noexcept {
  constexpr double kNearRest = 1e-2;        // cells, above any tolerance: the excess is worth a closer look
  constexpr double kMargin = 1e-9;          // cells: nearer to an edge the general steps decide
  constexpr double kClearlyBeyond = 3.0;    // times the segment's end
  constexpr double kSafelyPositive = 1e-3;  // of the product of the Hessian's diagonal
  constexpr double kExact = 1e5;            // cells: of longer pulls rounding leaves more than the tolerance
  const auto is_near_edge = [](Pair at) { return !(lowest(at) >= kMargin && highest(at) <= 1.0 - kMargin); };

  Pair at{p.s, p.t};
  double z = p.z;
  bool inside = dot(inward, inward) == 0.0;
  CellCoefficients friction;
  if constexpr (kFriction) friction = surface.coefficients(p.i, p.j);
  GlideEnd ending = GlideEnd::handed_over;

  for (; course.segments < limit; ++course.segments) {
    const Pair slope{patch.a, patch.b};
    const Pair grad = slope + both(patch.c) * swapped(at);
    const Pair w = Pair{hip.x - p.i, hip.y - p.j} - at;
    const double wz = hip.z - z;
    const double press = dot(grad, w) - wz;
    if (!(press >= 0.0) || dot(inward, w) < 0.0) break;
    const Pair b = w + grad * both(wz);
    const double turn = cross(b, grad);
    const double tangent = std::sqrt(dot(b, b) + turn * turn);
    const Pair squares = grad * grad;

    // Rest, with |T| and mu |N| both times sqrt(area). The closer look waits until the excess is small.
    const double area = 1.0 + (squares[0] + squares[1]);
    double mu = 0.0;
    double hold = 0.0;
    if constexpr (kFriction) {
      if (course.sticking) {
        const double held = tangent - surface.mu_static(p.i, p.j, at[0], at[1]) * press;
        if (held <= kNearRest && held <= rest_tolerance(tolerance, {w[0], w[1], wz}) * std::sqrt(area)) {
          ending = GlideEnd::rest;
          break;
        }
        course.sticking = false;
      }
      mu = friction.at(at[0], at[1]);
      hold = mu * press;
      if (course.may_stick_again) {
        course.may_stick_again = false;
        if (tangent < kStickAgain * hold) {
          course.sticking = true;
          ending = GlideEnd::rest;
          break;
        }
      }
    }
    const double excess = tangent - hold;
    if (excess <= kNearRest && excess <= rest_tolerance(tolerance, {w[0], w[1], wz}) * std::sqrt(area)) {
      if (inside) ending = GlideEnd::rest;
      break;
    }

    // Newton, where it is safe.
    const Pair h = both(1.0) + squares;
    const double hst = grad[0] * grad[1] - wz * patch.c;
    const double diagonal = h[0] * h[1];
    const double determinant = diagonal - hst * hst;
    if (!(determinant > kSafelyPositive * diagonal && kExact * determinant > tangent * diagonal)) break;
    const Pair d = b * swapped(h) - swapped(b) * both(hst);  // times the determinant
    if (dot(inward, d) < 0.0) break;

    // Cut at the first edge.
    const double whole = 1.0 / determinant;
    const Pair ahead{d[0] > 0.0 ? 1.0 - at[0] : at[0], d[1] > 0.0 ? 1.0 - at[1] : at[1]};
    const Pair ends = ahead / Pair{std::abs(d[0]), std::abs(d[1])};
    const double end = std::min(whole, lowest(ends));
    // On this piece D falls as a good quadratic does: its slope is gain (determinant tau - 1) + 3 rise twist tau^2 + 2
    // twist^2 tau^3.
    const double rise = dot(grad, d);
    const double twist = patch.c * (d[0] * d[1]);
    const double gain = dot(b, d);
    const double warp = twist * end;
    if (!(std::max(std::abs(3.0 * rise * warp), 2.0 * warp * warp) <= 0.5 * determinant * gain)) break;

    if constexpr (kFriction) {
      // If |T| fell linearly and mu |N| went on as it begins, the excess would fall so fast.
      const Pair mu_grad = Pair{friction.a, friction.b} + both(friction.c) * swapped(at);
      const double mu1 = dot(mu_grad, d);
      const Pair grad1 = both(patch.c) * swapped(d);
      const double press1 = dot(grad1, w);
      const double fall = determinant * tangent + (mu1 * press + mu * press1);
      const Slide slide{determinant,
                        b,
                        both(0.0) - (grad * both(twist) + grad1 * both(rise)),
                        both(0.0) - grad1 * both(twist),
                        grad,
                        grad1,
                        press,
                        press1,
                        -twist,
                        mu,
                        mu1,
                        friction.c * (d[0] * d[1])};
      if (excess < end * fall) {
        double tau = excess / fall;
        if (!slide.stop(tau, excess, end, kRootShare * tolerance)) break;
        const Pair next = at + both(tau) * d;
        if (is_near_edge(next)) break;
        at = next;
        z = patch.height(at[0], at[1]);
        ++course.segments;
        ending = GlideEnd::rest;
        break;
      }
      // Far from the stop the excess at the end need not be looked at.
      if (excess < kClearlyBeyond * end * fall &&
          !(slide.excess(end) > tolerance * (2.0 + std::abs(grad[0]) + std::abs(grad[1]))))
        break;
    }
    const Pair next = at + both(end) * d;
    if (end == whole) {
      if (is_near_edge(next) || (next[0] == at[0] && next[1] == at[1])) break;
      at = next;
      z = patch.height(at[0], at[1]);
      inside = true;
      inward = both(0.0);
      if constexpr (!kFriction) {
        // What a Newton step leaves of the gradient on a bilinear patch, exactly; |T| is no longer than it.
        const Pair left =
            (both(twist) * grad + both((rise + twist * whole) * patch.c) * swapped(d)) * both(whole * whole);
        if (dot(left, left) <= kRootShare * kRootShare * tolerance * tolerance) {
          ++course.segments;
          ending = GlideEnd::rest;
          break;
        }
      }
      continue;
    }
    // Across an edge, away from nodes, into another inner cell.
    const bool across_t = ends[1] <= ends[0];
    const double along = across_t ? next[0] : next[1];
    const bool up = (across_t ? d[1] : d[0]) > 0.0;
    const int step = up ? 1 : -1;
    const int i = p.i + (across_t ? 0 : step);
    const int j = p.j + (across_t ? step : 0);
    if (!(along >= kMargin && along <= 1.0 - kMargin) || !surface.is_inner(i, j)) break;
    const double side = up ? 0.0 : 1.0;
    const double way = up ? 1.0 : -1.0;
    p.i = i;
    p.j = j;
    at = across_t ? Pair{along, side} : Pair{side, along};
    inward = across_t ? Pair{0.0, way} : Pair{way, 0.0};
    inside = false;
    patch = surface.patch_inside(i, j);
    if constexpr (kFriction) friction = surface.coefficients(i, j);
    z = patch.height(at[0], at[1]);
  }
  p.s = at[0];
  p.t = at[1];
  p.z = z;
  if (ending == GlideEnd::rest)
    place = {true, {-patch.slope_s(p.s, p.t), -patch.slope_t(p.s, p.t), 1.0}, kFriction ? friction.at(p.s, p.t) : 0.0};
  return ending;
}

}  // namespace sparsha::haptics
