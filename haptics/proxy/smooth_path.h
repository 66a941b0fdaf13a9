// The fast path of the exact solver on surfaces without creases: a proxy that slides over bicubic patches by Newton
// steps, across the edges of cells as if they were not there. It takes the same decisions as the general steps and
// hands over to them whenever something is out of the ordinary: lift-off, indefinite Hessians, long steps, the border.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/proxy/bicubic_patch.h"
#include "haptics/proxy/fast_path.h"
#include "haptics/proxy/friction_stop.h"
#include "haptics/proxy/hot.h"
#include "haptics/proxy/pair.h"

namespace sparsha::haptics {

/// Takes `p`, in contact in a deep cell, until it rests or the general steps must go on.
template <bool kFriction, CubicBasis kBasis>
class SmoothPath {
 public:
  SPARSHA_HOT SmoothPath(const BicubicSurface<kBasis>& surface, const CellVector& hip, double tolerance, CellPoint& p,
                         SolverState& state) noexcept
      : surface_(surface), hip_(hip), tolerance_(tolerance), p_(p), state_(state), bands_(surface.bands(p.i, p.j)) {
    i_ = p.i;
    j_ = p.j;
  }

  /// At most `limit` steps of half a cell. False also where p is not on this surface.
  [[nodiscard]] SPARSHA_HOT bool follow(int limit, RestPlace& place) noexcept {
    constexpr double kSame = 64.0 * std::numeric_limits<double>::epsilon();
    Look here;
    if (!look(p_, here) || !(std::abs(here.p.z - p_.z) <= kSame * (1.0 + std::abs(p_.z)))) return false;
    bool resting = false;
    for (int k = std::min(kMostSteps, limit); k > 0 && here.press >= 0.0; --k) {
      if (is_at_rest(here)) {
        resting = true;
        break;
      }
      Pair d;
      if (!plan(here, d)) break;
      const Step step = kFriction && mu_ > 0.0 ? slide(here, d) : descend(here, d);
      if (step == Step::none) break;
      ++state_.segments;
      resting = step == Step::to_rest;
      if (resting) break;
    }
    p_ = here.p;
    if (resting) place = {true, {-here.f.fs, -here.f.ft, 1.0}, mu_};
    return resting;
  }

 private:
  static constexpr int kMostSteps = 12;
  static constexpr int kMostTrials = 10;
  static constexpr double kNearRest = 1e-2;        // cells, above any tolerance: the excess is worth a closer look
  static constexpr double kLongest = 0.5;          // cells: the general steps take longer ways piece by piece
  static constexpr double kMiddle = 0.125;         // cells: of longer steps the middle is looked at
  static constexpr double kOvershoot = 0.1;        // of the slope of D at the step's start
  static constexpr double kSafelyPositive = 1e-3;  // of the product of the Hessian's diagonal

  /// First-order geometry of D = |hip - p|^2 / 2 at p; |T| and |N| are times sqrt(area), as in FastPath.
  struct Look {
    CellPoint p;
    PatchDerivatives f;
    Pair w, b;
    double wz, press, tangent, area;
  };

  /// False beyond the deep cells.
  [[nodiscard]] SPARSHA_HOT bool look(const CellPoint& p, Look& here) noexcept {
    if (p.i != i_ || p.j != j_) {
      if (!surface_.is_deep(p.i, p.j)) return false;
      bands_ = surface_.bands(p.i, p.j);
      i_ = p.i;
      j_ = p.j;
    }
    here.p = p;
    here.f = bands_.at(p.s, p.t);
    here.p.z = here.f.z;
    const Pair slope{here.f.fs, here.f.ft};
    here.w = Pair{hip_.x - p.i, hip_.y - p.j} - Pair{p.s, p.t};
    here.wz = hip_.z - here.f.z;
    here.press = dot(slope, here.w) - here.wz;
    here.b = here.w + slope * both(here.wz);
    const double turn = cross(here.b, slope);
    here.tangent = std::sqrt(dot(here.b, here.b) + turn * turn);
    here.area = 1.0 + dot(slope, slope);
    return true;
  }

  [[nodiscard]] SPARSHA_HOT bool is_at_rest(const Look& here) noexcept {
    if constexpr (kFriction) {
      const CellPoint& p = here.p;
      mu_ = surface_.mu_dynamic(p.i, p.j, p.s, p.t);
      if (state_.sticking) {
        if (is_within(here.tangent - surface_.mu_static(p.i, p.j, p.s, p.t) * here.press, here)) return true;
        state_.sticking = false;
      }
      const double hold = mu_ * here.press;
      if (state_.may_stick_again) {
        state_.may_stick_again = false;
        state_.sticking = here.tangent < kStickAgain * hold;
      }
      return state_.sticking || is_within(here.tangent - hold, here);
    }
    return is_within(here.tangent, here);
  }
  [[nodiscard]] SPARSHA_HOT bool is_within(double excess, const Look& here) const noexcept {
    return excess <= kNearRest && excess <= tolerance_at(here) * std::sqrt(here.area);
  }
  [[nodiscard]] SPARSHA_HOT double tolerance_at(const Look& here) const noexcept {
    return rest_tolerance(tolerance_, {here.w[0], here.w[1], here.wz});
  }

  /// Newton; false where it is not safe.
  [[nodiscard]] SPARSHA_HOT bool plan(const Look& here, Pair& d) const noexcept {
    const PatchDerivatives& f = here.f;
    const double hss = 1.0 + f.fs * f.fs - here.wz * f.fss;
    const double htt = 1.0 + f.ft * f.ft - here.wz * f.ftt;
    const double hst = f.fs * f.ft - here.wz * f.fst;
    const double determinant = hss * htt - hst * hst;
    if (!(hss > 0.0 && determinant > kSafelyPositive * hss * htt)) return false;
    d = (here.b * Pair{htt, hss} - swapped(here.b) * both(hst)) * both(1.0 / determinant);
    return true;
  }

  [[nodiscard]] SPARSHA_HOT static double longest_of(Pair d) noexcept {
    return std::max(std::abs(d[0]), std::abs(d[1]));
  }

  /// p moved by less than a cell, written in the cell that it comes to.
  [[nodiscard]] SPARSHA_HOT static CellPoint moved(const CellPoint& p, Pair d) noexcept {
    CellPoint q = p;
    q.s += d[0];
    q.t += d[1];
    const auto carry = [](double& share, int& cell) {
      if (share < 0.0) share += 1.0, --cell;
      if (share > 1.0) share -= 1.0, ++cell;
    };
    carry(q.s, q.i);
    carry(q.t, q.j);
    return q;
  }

  enum class Step { none, on, to_rest };

  /// The step, or the first kLongest of it; none where D does not fall all the way as a good quadratic does.
  [[nodiscard]] SPARSHA_HOT Step descend(Look& here, Pair d) noexcept {
    double longest = longest_of(d);
    if (longest > kLongest) {
      d = d * both(kLongest / longest);
      longest = kLongest;
    }
    Look next;
    if (longest > kMiddle && !(look(moved(here.p, both(0.5) * d), next) && dot(next.b, d) > 0.0)) return Step::none;
    if (!look(moved(here.p, d), next) || !(-dot(next.b, d) <= kOvershoot * dot(here.b, d))) return Step::none;
    here = next;
    return Step::on;
  }

  /// To where the excess |T| - mu |N| passes zero on the step, by secants, or on by kLongest where it does not yet.
  [[nodiscard]] SPARSHA_HOT Step slide(Look& here, Pair d) noexcept {
    const CellPoint from = here.p;
    const double end = kLongest / std::max(kLongest, longest_of(d));
    const double tolerance = kRootShare * tolerance_at(here);
    // To first order |T| falls as the gradient does on a Newton step, and |N| as the slopes turn.
    const Pair turned = Pair{here.f.fss, here.f.ftt} * d + both(here.f.fst) * swapped(d);
    double before = 0.0;
    double excess_before = here.tangent - mu_ * here.press;
    double tau = excess_before / (here.tangent + mu_ * dot(turned, here.w));
    if (!(tau > 0.0)) return Step::none;
    tau = std::min(tau, end);
    Look next;
    for (int k = 0; k < kMostTrials; ++k) {
      if (!(tau > 0.0 && tau <= end && look(moved(from, both(tau) * d), next))) return Step::none;
      const double mu = surface_.mu_dynamic(next.p.i, next.p.j, next.p.s, next.p.t);
      const double excess = next.tangent - mu * std::max(0.0, next.press);
      const bool stops = std::abs(excess) <= tolerance;
      if (stops || (tau == end && excess > 0.0)) {
        here = next;
        mu_ = mu;
        return stops ? Step::to_rest : Step::on;
      }
      const double fall = (excess_before - excess) / (tau - before);
      if (!(fall > 0.0)) return Step::none;
      before = tau;
      excess_before = excess;
      tau = std::min(tau + excess / fall, end);
    }
    return Step::none;
  }

  const BicubicSurface<kBasis>& surface_;
  const CellVector& hip_;
  double tolerance_;
  CellPoint& p_;
  SolverState& state_;
  BicubicBands<kBasis> bands_;
  int i_ = 0;
  int j_ = 0;
  double mu_ = 0.0;
};

}  // namespace sparsha::haptics
