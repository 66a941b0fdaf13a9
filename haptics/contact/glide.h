// The fast lane of the exact solver: a proxy that slides smoothly through the insides of cells and across their edges.
// It takes the same decisions as the general steps and hands over to them whenever something is out of the ordinary:
// creases, nodes, lift-off, indefinite Hessians, the border, cases within rounding.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/contact/bilinear_patch.h"
#include "haptics/contact/slide.h"
#include "haptics/contact/tangent_cone.h"

namespace sparsha::haptics {

enum class GlideEnd { rest, handed_over };

/// Slopes and coefficient where the proxy came to rest inside a cell, for whoever reports it.
struct RestPlace {
  bool known = false;
  double fs = 0.0;
  double ft = 0.0;
  double mu_dynamic = 0.0;
};

template <class Surface, bool kFriction>
class Glide {
 public:
  Glide(const Surface& surface, const CellVector& hip, double tolerance, int limit) noexcept
      : surface_(surface), hip_(hip), tolerance_(tolerance), limit_(limit) {}

  /// Slides `p`, which lies inside an inner cell with this patch, until it rests or the general steps must go on.
  GlideEnd run(CellPoint& p, BilinearPatch patch, bool& sticking, bool& may_stick_again, int& segments,
               RestPlace& place) noexcept {
    double hand_s = hip_.x - p.i;
    double hand_t = hip_.y - p.j;
    double s = p.s;
    double t = p.t;
    double z = p.z;
    // After an edge was crossed only steps further that way are taken here: +1 or -1 along the crossed coordinate.
    double inward_s = 0.0;
    double inward_t = 0.0;
    bool inside = true;
    CellCoefficients friction;
    if constexpr (kFriction) friction = surface_.coefficients(p.i, p.j);
    const auto keep = [&] { p.s = s, p.t = t, p.z = z; };
    const auto rest = [&] {
      keep();
      place = {true, patch.slope_s(s, t), patch.slope_t(s, t), kFriction ? friction.at(s, t) : 0.0};
      return GlideEnd::rest;
    };

    for (; segments < limit_; ++segments) {
      const CellVector w{hand_s - s, hand_t - t, hip_.z - z};
      const Pull pull(patch.slope_s(s, t), patch.slope_t(s, t), w);
      if (pull.normal > 0.0) break;
      if (!inside && (inward_s * w.x < 0.0 || inward_t * w.y < 0.0)) break;
      const double tangent_squared = pull.squared_tangent();
      const double press = -pull.normal;
      const double threshold = rest_tolerance(tolerance_, w);
      const auto rests = [&](double hold) {
        const double reach = hold + threshold * (1.0 + std::abs(pull.fs) + std::abs(pull.ft));
        return tangent_squared <= reach * reach &&
               std::sqrt(tangent_squared) - hold <= threshold * std::sqrt(pull.area);
      };

      // Rest, with |T| and mu |N| both times sqrt(area).
      double mu = 0.0;
      double hold = 0.0;
      if constexpr (kFriction) {
        if (sticking) {
          if (rests(surface_.mu_static(p.i, p.j, s, t) * press)) return rest();
          sticking = false;
        }
        mu = friction.at(s, t);
        hold = mu * press;
        if (may_stick_again) {
          may_stick_again = false;
          if (tangent_squared < kStickAgain * kStickAgain * hold * hold) {
            sticking = true;
            return rest();
          }
        }
      }
      if (rests(hold)) {
        if (inside) return rest();
        break;
      }

      // Newton, where it is safe and D falls as a good quadratic does: |k2|, k3 bound the cubic and quartic terms.
      const double hss = 1.0 + pull.fs * pull.fs;
      const double htt = 1.0 + pull.ft * pull.ft;
      const double hst = pull.fs * pull.ft - w.z * patch.c;
      const double diagonal = hss * htt;
      const double determinant = diagonal - hst * hst;
      if (!(determinant > kSafelyPositive * diagonal)) break;
      const double inverse = 1.0 / determinant;
      const double to_s = pull.bs * htt - pull.bt * hst;
      const double to_t = pull.bt * hss - pull.bs * hst;
      const double ds = to_s * inverse;
      const double dt = to_t * inverse;
      if (!inside && (inward_s * ds < 0.0 || inward_t * dt < 0.0)) break;
      const double rise = pull.fs * ds + pull.ft * dt;
      const double twist = patch.c * ds * dt;
      const double gain = pull.bs * ds + pull.bt * dt;
      if (!(std::max(std::abs(3.0 * rise * twist), 2.0 * twist * twist) <= 0.5 * gain)) break;

      // Cut at the first edge.
      double end = 1.0;
      int step_i = 0;
      int step_j = 0;
      double next_s = s + ds;
      double next_t = t + dt;
      if (is_near_edge(next_s)) {
        if (next_s > 0.0 && next_s < 1.0) break;
        step_i = ds > 0.0 ? 1 : -1;
        end = ((ds > 0.0 ? 1.0 : 0.0) - s) * determinant / to_s;
      }
      if (is_near_edge(next_t)) {
        if (next_t > 0.0 && next_t < 1.0) break;
        const double end_t = ((dt > 0.0 ? 1.0 : 0.0) - t) * determinant / to_t;
        if (end_t <= end) {
          end = end_t;
          step_i = 0;
          step_j = dt > 0.0 ? 1 : -1;
        }
      }
      if constexpr (kFriction) {
        const double tangent = std::sqrt(tangent_squared);
        const Slide slide(patch, pull, w, ds, dt, rise, twist, friction, s, t);
        double tau = slide.guess(tangent, hold, press, mu);
        if (tau < end) {
          if (!slide.stop(tau, end, kRootShare * threshold)) break;
          next_s = s + tau * ds;
          next_t = t + tau * dt;
          if (is_near_edge(next_s) || is_near_edge(next_t)) break;
          s = next_s;
          t = next_t;
          z = patch.height(s, t);
          ++segments;
          return rest();
        }
        // Far from the stop the excess at the edge need not be looked at.
        if (tau < kClearlyBeyond * end && !(slide.excess(end) > threshold)) break;
      }
      if (step_i == 0 && step_j == 0) {
        if (next_s == s && next_t == t) break;
        s = next_s;
        t = next_t;
        z = patch.height(s, t);
        inside = true;
        if constexpr (!kFriction) {
          // What a Newton step leaves of the gradient on a bilinear patch, exactly; |T| is no longer than it.
          const double left_s = twist * pull.fs + (rise + twist) * patch.c * dt;
          const double left_t = twist * pull.ft + (rise + twist) * patch.c * ds;
          if (left_s * left_s + left_t * left_t <= kRootShare * kRootShare * threshold * threshold) {
            ++segments;
            return rest();
          }
        }
        continue;
      }
      // Across an edge, away from nodes, into another inner cell.
      next_s = s + end * ds;
      next_t = t + end * dt;
      if (is_near_edge(step_i != 0 ? next_t : next_s) || !surface_.is_inner(p.i + step_i, p.j + step_j)) break;
      p.i += step_i;
      p.j += step_j;
      inside = false;
      inward_s = step_i;
      inward_t = step_j;
      s = step_i == 0 ? next_s : step_i > 0 ? 0.0 : 1.0;
      t = step_j == 0 ? next_t : step_j > 0 ? 0.0 : 1.0;
      hand_s = hip_.x - p.i;
      hand_t = hip_.y - p.j;
      patch = surface_.patch_inside(p.i, p.j);
      if constexpr (kFriction) friction = surface_.coefficients(p.i, p.j);
      z = patch.height(s, t);
    }
    keep();
    return GlideEnd::handed_over;
  }

 private:
  [[nodiscard]] static bool is_near_edge(double s) noexcept { return !(s >= kMargin && s <= 1.0 - kMargin); }

  static constexpr double kMargin = 1e-9;          // cells: nearer to an edge the general steps decide
  static constexpr double kClearlyBeyond = 3.0;    // times the segment's end
  static constexpr double kSafelyPositive = 1e-3;  // of the product of the Hessian's diagonal

  const Surface& surface_;
  CellVector hip_;
  double tolerance_;
  int limit_;
};

}  // namespace sparsha::haptics
