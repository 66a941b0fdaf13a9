// The fast lane of the exact solver: a proxy that slides smoothly through the insides of cells and across their edges.
// It takes the same decisions as the general steps and hands over to them whenever something is out of the ordinary:
// creases, nodes, lift-off, indefinite Hessians, the border, cases within rounding.
#pragma once

#include <algorithm>
#include <cmath>

#include "haptics/contact/bilinear_patch.h"
#include "haptics/contact/tangent_cone.h"

namespace sparsha::haptics {

enum class GlideEnd { rest, handed_over };

template <class Surface, bool kFriction>
class Glide {
 public:
  Glide(const Surface& surface, const CellVector& hip, double tolerance, int limit) noexcept
      : surface_(surface), hip_(hip), tolerance_(tolerance), limit_(limit) {}

  /// Slides `p`, which lies inside an inner cell, until it rests or the general steps must go on.
  GlideEnd run(CellPoint& p, bool& sticking, bool& may_stick_again, int& segments) noexcept {
    Freedom entered_s = Freedom::both;
    Freedom entered_t = Freedom::both;
    BilinearPatch patch = surface_.patch(p.i, p.j);
    while (segments < limit_) {
      const CellVector w = hip_ - p;
      const Pull pull(patch.slope_s(p.s, p.t), patch.slope_t(p.s, p.t), w);
      if (pull.normal > 0.0 || !allows(entered_s, w.x) || !allows(entered_t, w.y)) return GlideEnd::handed_over;
      const bool inside = entered_s == Freedom::both && entered_t == Freedom::both;
      const double tangent_squared = pull.squared_tangent();
      const double press = -pull.normal;

      // Rest, with |T| and mu |N| both times sqrt(area).
      double mu = 0.0;
      if constexpr (kFriction) {
        if (sticking) {
          const double hold = surface_.mu_static(p.i, p.j, p.s, p.t) * press;
          if (tangent_squared <= hold * hold) return GlideEnd::rest;
          if (std::sqrt(tangent_squared) - hold <= rest_tolerance(w) * std::sqrt(pull.area)) return GlideEnd::rest;
          sticking = false;
        }
        mu = surface_.mu_dynamic(p.i, p.j, p.s, p.t);
        if (may_stick_again) {
          const double hold = kStickAgain * mu * press;
          may_stick_again = false;
          if (tangent_squared < hold * hold) {
            sticking = true;
            return GlideEnd::rest;
          }
        }
      }
      const double hold = mu * press;
      const double threshold = rest_tolerance(w);
      const double reach = hold + threshold * (1.0 + std::abs(pull.fs) + std::abs(pull.ft));
      if (tangent_squared <= reach * reach) {
        if (!inside) return GlideEnd::handed_over;
        if (std::sqrt(tangent_squared) - hold <= threshold * std::sqrt(pull.area)) return GlideEnd::rest;
      }

      // Newton, where it is safe.
      const double hss = 1.0 + pull.fs * pull.fs;
      const double htt = 1.0 + pull.ft * pull.ft;
      const double hst = pull.fs * pull.ft - w.z * patch.c;
      const double determinant = hss * htt - hst * hst;
      if (!(determinant > kSafelyPositive * hss * htt)) return GlideEnd::handed_over;
      const double inverse = 1.0 / determinant;
      const double ds = (pull.bs * htt - pull.bt * hst) * inverse;
      const double dt = (pull.bt * hss - pull.bs * hst) * inverse;
      if (!allows(entered_s, ds) || !allows(entered_t, dt)) return GlideEnd::handed_over;

      // Cut at the first edge.
      double end = 1.0;
      int step_i = 0;
      int step_j = 0;
      double s = p.s + ds;
      double t = p.t + dt;
      if (s < kMargin || s > 1.0 - kMargin) {
        if (s > 0.0 && s < 1.0) return GlideEnd::handed_over;
        step_i = ds > 0.0 ? 1 : -1;
        end = ((ds > 0.0 ? 1.0 : 0.0) - p.s) / ds;
      }
      if (t < kMargin || t > 1.0 - kMargin) {
        if (t > 0.0 && t < 1.0) return GlideEnd::handed_over;
        const double end_t = ((dt > 0.0 ? 1.0 : 0.0) - p.t) / dt;
        if (end_t <= end) {
          end = end_t;
          step_i = 0;
          step_j = dt > 0.0 ? 1 : -1;
        }
      }
      // D along the step is a quartic; its slope begins with k0 and, for Newton, -k0 tau.
      const double rise = pull.fs * ds + pull.ft * dt;
      const double twist = patch.c * ds * dt;
      const double k0 = -(pull.bs * ds + pull.bt * dt);
      const double k2 = 3.0 * rise * twist;
      const double k3 = 2.0 * twist * twist;
      if (-k0 + 2.0 * std::min(0.0, k2 * end) < 0.0) return GlideEnd::handed_over;
      const double fall = k0 - end * (k0 / 2.0 - end * (k2 / 3.0 + end * k3 / 4.0));
      if (!(fall <= kArmijo * k0)) return GlideEnd::handed_over;

      if constexpr (kFriction) {
        const Slide slide(surface_, p, patch, pull, w, ds, dt, rise, twist);
        double tau = slide.guess(std::sqrt(tangent_squared), hold, press, mu);
        if (!(tau < end)) {
          if (!(slide.excess(end) > threshold)) return GlideEnd::handed_over;
        } else {
          if (!slide.stop(tau, std::sqrt(tangent_squared) - hold, end, kRootShare * threshold))
            return GlideEnd::handed_over;
          const double stop_s = p.s + tau * ds;
          const double stop_t = p.t + tau * dt;
          if (is_near_edge(stop_s) || is_near_edge(stop_t)) return GlideEnd::handed_over;
          p.s = stop_s;
          p.t = stop_t;
          p.z = patch.height(stop_s, stop_t);
          ++segments;
          return GlideEnd::rest;
        }
      }
      if (step_i == 0 && step_j == 0) {
        if (s == p.s && t == p.t) return GlideEnd::handed_over;
        p.s = s;
        p.t = t;
        p.z = patch.height(s, t);
        entered_s = entered_t = Freedom::both;
        ++segments;
        continue;
      }
      // Across an edge, away from nodes, into another inner cell.
      s = p.s + end * ds;
      t = p.t + end * dt;
      if (is_near_edge(step_i != 0 ? t : s) || !surface_.is_inner(p.i + step_i, p.j + step_j))
        return GlideEnd::handed_over;
      p.i += step_i;
      p.j += step_j;
      if (step_i != 0) {
        p.s = step_i > 0 ? 0.0 : 1.0;
        p.t = t;
        entered_s = step_i > 0 ? Freedom::up : Freedom::down;
        entered_t = Freedom::both;
      } else {
        p.s = s;
        p.t = step_j > 0 ? 0.0 : 1.0;
        entered_s = Freedom::both;
        entered_t = step_j > 0 ? Freedom::up : Freedom::down;
      }
      patch = surface_.patch(p.i, p.j);
      p.z = patch.height(p.s, p.t);
      ++segments;
    }
    return GlideEnd::handed_over;
  }

 private:
  /// The excess sqrt(area) (|T| - mu |N|) along a straight segment of one patch; all but |T| are polynomials.
  class Slide {
   public:
    Slide(const Surface& surface, const CellPoint& p, const BilinearPatch& patch, const Pull& pull, const CellVector& w,
          double ds, double dt, double rise, double twist) noexcept
        : w_(w),
          fs_(pull.fs),
          ft_(pull.ft),
          ds_(ds),
          dt_(dt),
          rise_(rise),
          twist_(twist),
          fs1_(patch.c * dt),
          ft1_(patch.c * ds),
          normal_(pull.normal),
          normal1_(-patch.c * (dt * w.x + ds * w.y)) {
      surface.mu_dynamic_along(p, ds, dt, mu_, mu1_, mu2_);
    }
    [[nodiscard]] double excess(double tau) const noexcept {
      const double x = w_.x - tau * ds_;
      const double y = w_.y - tau * dt_;
      const double z = w_.z - tau * (rise_ + tau * twist_);
      const double fs = fs_ + tau * fs1_;
      const double ft = ft_ + tau * ft1_;
      const double bs = x + fs * z;
      const double bt = y + ft * z;
      const double cross = bs * ft - bt * fs;
      const double press = -(normal_ + tau * (normal1_ + tau * twist_));
      const double mu = mu_ + tau * (mu1_ + tau * mu2_);
      return std::sqrt(bs * bs + bt * bt + cross * cross) - mu * std::max(0.0, press);
    }
    /// Where the excess would vanish if |T| fell to zero linearly and mu |N| went on as it begins.
    [[nodiscard]] double guess(double tangent, double hold, double press, double mu) const noexcept {
      return (tangent - hold) / (tangent + mu1_ * press - mu * normal1_);
    }
    /// Secant from the guess; false when it does not settle inside (0, end).
    [[nodiscard]] bool stop(double& tau, double excess_at_zero, double end, double tolerance) const noexcept {
      double last = 0.0;
      double at_last = excess_at_zero;
      for (int k = 0; k < kSecants; ++k) {
        const double here = excess(tau);
        if (std::abs(here) <= tolerance) return true;
        const double next = tau - here * (tau - last) / (here - at_last);
        if (!(next > 0.0 && next < end)) return false;
        last = tau;
        at_last = here;
        tau = next;
      }
      return false;
    }

   private:
    CellVector w_;
    double fs_, ft_, ds_, dt_, rise_, twist_, fs1_, ft1_, normal_, normal1_;
    double mu_ = 0.0, mu1_ = 0.0, mu2_ = 0.0;
  };

  [[nodiscard]] static bool is_near_edge(double s) noexcept { return !(s >= kMargin && s <= 1.0 - kMargin); }

  [[nodiscard]] double rest_tolerance(const CellVector& w) const noexcept {
    return tolerance_ + kRounding * std::max({std::abs(w.x), std::abs(w.y), std::abs(w.z)});
  }

  static constexpr double kMargin = 1e-9;          // cells: nearer to an edge the general steps decide
  static constexpr double kSafelyPositive = 1e-3;  // of the product of the Hessian's diagonal
  static constexpr double kArmijo = 0.1;
  static constexpr double kStickAgain = 0.9;  // of mu_dynamic
  static constexpr double kRootShare = 0.25;  // of the rest tolerance
  static constexpr int kSecants = 8;
  static constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();

  const Surface& surface_;
  CellVector hip_;
  double tolerance_;
  int limit_;
};

}  // namespace sparsha::haptics
