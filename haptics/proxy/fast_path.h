// The fast path of the exact solver: a proxy that slides smoothly through the insides of cells and across their edges.
// It takes the same decisions as the general steps and hands over to them whenever something is out of the ordinary:
// creases, nodes, lift-off, indefinite Hessians, the border, cases within rounding.
#pragma once

#include <algorithm>
#include <cmath>

#include "haptics/proxy/bilinear_patch.h"
#include "haptics/proxy/friction_stop.h"
#include "haptics/proxy/hot.h"
#include "haptics/proxy/pair.h"

namespace sparsha::haptics {

enum class FastPathEnd { rest, handed_over };

/// Where the proxy came to rest, for whoever reports it.
struct RestPlace {
  bool known = false;
  CellVector normal;  ///< of any length; on edges and nodes the mean of the touching patches'
  double mu_dynamic = 0.0;
};

/// What the solvers carry from step to step of one tick.
struct SolverState {
  bool sticking = false;
  bool may_stick_again = false;  ///< a slipping proxy's first look at friction in this tick
  int segments = 0;
};

/// True when s and t are strictly inside the cell.
[[nodiscard]] inline bool is_strictly_inside(const CellPoint& p) noexcept {
  return std::min(p.s, p.t) > 0.0 && std::max(p.s, p.t) < 1.0;
}

/// Takes `p`, strictly inside an inner cell with this patch or on an edge of it, until it rests or the general steps
/// must go on. `inward`: after an edge was crossed only steps further that way are taken, +1 or -1 along s or t.
template <bool kFriction>
class FastPath {
 public:
  SPARSHA_HOT FastPath(const BilinearSurface& surface, const CellVector& hip, double tolerance, CellPoint& p,
                       const BilinearPatch& patch, Pair inward, SolverState& state) noexcept
      : surface_(surface),
        hip_(hip),
        tolerance_(tolerance),
        p_(p),
        patch_(patch),
        inward_(inward),
        state_(state),
        at_{p.s, p.t},
        z_(p.z),
        inside_(dot(inward, inward) == 0.0) {
    if constexpr (kFriction) friction_ = surface.coefficients(p.i, p.j);
  }

  [[nodiscard]] SPARSHA_HOT FastPathEnd follow(int limit, RestPlace& place) noexcept {
    for (; state_.segments < limit; ++state_.segments) {
      Pull pull;
      Step step;
      if (!look(pull) || is_at_rest(pull) || !plan(pull, step)) break;
      if constexpr (kFriction) {
        if (!passes_friction(pull, step)) break;
      }
      if (step.end == step.whole ? !arrive(pull, step) : !cross_edge(step)) break;
    }
    p_.s = at_[0];
    p_.t = at_[1];
    p_.z = z_;
    if (ending_ == FastPathEnd::rest)
      place = {true,
               {-patch_.slope_s(p_.s, p_.t), -patch_.slope_t(p_.s, p_.t), 1.0},
               kFriction ? friction_.at(p_.s, p_.t) : 0.0};
    return ending_;
  }

 private:
  static constexpr double kNearRest = 1e-2;        // cells, above any tolerance: the excess is worth a closer look
  static constexpr double kMargin = 1e-9;          // cells: nearer to an edge the general steps decide
  static constexpr double kClearlyBeyond = 3.0;    // times the segment's end
  static constexpr double kSafelyPositive = 1e-3;  // of the product of the Hessian's diagonal
  static constexpr double kExact = 1e5;            // cells: of longer pulls rounding leaves more than the tolerance

  /// What the hand pulls with, and what holds against it.
  struct Pull {
    Pair grad, w, b, squares;
    double wz, press, tangent;
    double mu = 0.0;
    double excess;
  };
  /// The Newton step `d` over this patch, in shares of it: `whole` is all of it, `end` where the first edge cuts it.
  struct Step {
    Pair d, ends;
    double whole, end, rise, twist, determinant;
  };

  [[nodiscard]] static bool is_near_edge(Pair at) noexcept {
    return !(lowest(at) >= kMargin && highest(at) <= 1.0 - kMargin);
  }

  /// False where the hand does not press, or pulls back across the edge.
  [[nodiscard]] SPARSHA_HOT bool look(Pull& pull) const noexcept {
    const Pair slope{patch_.a, patch_.b};
    pull.grad = slope + both(patch_.c) * swapped(at_);
    pull.w = Pair{hip_.x - p_.i, hip_.y - p_.j} - at_;
    pull.wz = hip_.z - z_;
    pull.press = dot(pull.grad, pull.w) - pull.wz;
    if (!(pull.press >= 0.0) || dot(inward_, pull.w) < 0.0) return false;
    pull.b = pull.w + pull.grad * both(pull.wz);
    const double turn = cross(pull.b, pull.grad);
    pull.tangent = std::sqrt(dot(pull.b, pull.b) + turn * turn);
    pull.squares = pull.grad * pull.grad;
    return true;
  }

  /// True when the path ends here, with or without rest. |T| and mu |N| are both times sqrt(area). The closer look
  /// waits until the excess is small.
  [[nodiscard]] SPARSHA_HOT bool is_at_rest(Pull& pull) noexcept {
    const double area = 1.0 + (pull.squares[0] + pull.squares[1]);
    double hold = 0.0;
    if constexpr (kFriction) {
      if (state_.sticking) {
        const double held = pull.tangent - surface_.mu_static(p_.i, p_.j, at_[0], at_[1]) * pull.press;
        if (is_within(held, pull, area)) {
          ending_ = FastPathEnd::rest;
          return true;
        }
        state_.sticking = false;
      }
      pull.mu = friction_.at(at_[0], at_[1]);
      hold = pull.mu * pull.press;
      if (state_.may_stick_again) {
        state_.may_stick_again = false;
        if (pull.tangent < kStickAgain * hold) {
          state_.sticking = true;
          ending_ = FastPathEnd::rest;
          return true;
        }
      }
    }
    pull.excess = pull.tangent - hold;
    if (!is_within(pull.excess, pull, area)) return false;
    if (inside_) ending_ = FastPathEnd::rest;
    return true;
  }

  [[nodiscard]] SPARSHA_HOT bool is_within(double excess, const Pull& pull, double area) const noexcept {
    return excess <= kNearRest &&
           excess <= rest_tolerance(tolerance_, {pull.w[0], pull.w[1], pull.wz}) * std::sqrt(area);
  }

  /// Newton, cut at the first edge; false where it is not safe.
  [[nodiscard]] SPARSHA_HOT bool plan(const Pull& pull, Step& step) const noexcept {
    const Pair h = both(1.0) + pull.squares;
    const double hst = pull.grad[0] * pull.grad[1] - pull.wz * patch_.c;
    const double diagonal = h[0] * h[1];
    step.determinant = diagonal - hst * hst;
    if (!(step.determinant > kSafelyPositive * diagonal && kExact * step.determinant > pull.tangent * diagonal))
      return false;
    step.d = pull.b * swapped(h) - swapped(pull.b) * both(hst);  // times the determinant
    if (dot(inward_, step.d) < 0.0) return false;
    step.whole = 1.0 / step.determinant;
    const Pair ahead{step.d[0] > 0.0 ? 1.0 - at_[0] : at_[0], step.d[1] > 0.0 ? 1.0 - at_[1] : at_[1]};
    step.ends = ahead / Pair{std::abs(step.d[0]), std::abs(step.d[1])};
    step.end = std::min(step.whole, lowest(step.ends));
    // On this piece D falls as a good quadratic does: its slope is gain (determinant tau - 1) + 3 rise twist tau^2 + 2
    // twist^2 tau^3.
    step.rise = dot(pull.grad, step.d);
    step.twist = patch_.c * (step.d[0] * step.d[1]);
    const double gain = dot(pull.b, step.d);
    const double warp = step.twist * step.end;
    return std::max(std::abs(3.0 * step.rise * warp), 2.0 * warp * warp) <= 0.5 * step.determinant * gain;
  }

  /// False when friction stops the proxy on this step (it then rests there), or might.
  [[nodiscard]] SPARSHA_HOT bool passes_friction(const Pull& pull, const Step& step) noexcept {
    // If |T| fell linearly and mu |N| went on as it begins, the excess would fall so fast.
    const Pair mu_grad = Pair{friction_.a, friction_.b} + both(friction_.c) * swapped(at_);
    const double mu1 = dot(mu_grad, step.d);
    const Pair grad1 = both(patch_.c) * swapped(step.d);
    const double press1 = dot(grad1, pull.w);
    const double fall = step.determinant * pull.tangent + (mu1 * pull.press + pull.mu * press1);
    const FrictionStop friction_stop{step.determinant,
                                     pull.b,
                                     both(0.0) - (pull.grad * both(step.twist) + grad1 * both(step.rise)),
                                     both(0.0) - grad1 * both(step.twist),
                                     pull.grad,
                                     grad1,
                                     pull.press,
                                     press1,
                                     -step.twist,
                                     pull.mu,
                                     mu1,
                                     friction_.c * (step.d[0] * step.d[1])};
    if (pull.excess < step.end * fall) {
      double tau = pull.excess / fall;
      if (!friction_stop.stop(tau, pull.excess, step.end, kRootShare * tolerance_)) return false;
      const Pair next = at_ + both(tau) * step.d;
      if (!is_near_edge(next)) rest_at(next);
      return false;
    }
    // Far from the stop the excess at the end need not be looked at.
    return pull.excess >= kClearlyBeyond * step.end * fall ||
           friction_stop.excess(step.end) > tolerance_ * (2.0 + std::abs(pull.grad[0]) + std::abs(pull.grad[1]));
  }

  SPARSHA_HOT void rest_at(Pair next) noexcept {
    at_ = next;
    z_ = patch_.height(at_[0], at_[1]);
    ++state_.segments;
    ending_ = FastPathEnd::rest;
  }

  /// The whole step, inside the cell; false when the path ends with it.
  [[nodiscard]] SPARSHA_HOT bool arrive(const Pull& pull, const Step& step) noexcept {
    const Pair next = at_ + both(step.end) * step.d;
    if (is_near_edge(next) || (next[0] == at_[0] && next[1] == at_[1])) return false;
    at_ = next;
    z_ = patch_.height(at_[0], at_[1]);
    inside_ = true;
    inward_ = both(0.0);
    if constexpr (!kFriction) {
      // What a Newton step leaves of the gradient on a bilinear patch, exactly; |T| is no longer than it.
      const Pair left =
          (both(step.twist) * pull.grad + both((step.rise + step.twist * step.whole) * patch_.c) * swapped(step.d)) *
          both(step.whole * step.whole);
      if (dot(left, left) <= kRootShare * kRootShare * tolerance_ * tolerance_) {
        ++state_.segments;
        ending_ = FastPathEnd::rest;
        return false;
      }
    }
    return true;
  }

  /// To the edge and across it, away from nodes, into another inner cell; false where that cannot be.
  [[nodiscard]] SPARSHA_HOT bool cross_edge(const Step& step) noexcept {
    const Pair next = at_ + both(step.end) * step.d;
    const bool across_t = step.ends[1] <= step.ends[0];
    const double along = across_t ? next[0] : next[1];
    const bool up = (across_t ? step.d[1] : step.d[0]) > 0.0;
    const int i = p_.i + (across_t ? 0 : up ? 1 : -1);
    const int j = p_.j + (across_t ? (up ? 1 : -1) : 0);
    if (!(along >= kMargin && along <= 1.0 - kMargin) || !surface_.is_inner(i, j)) return false;
    const double side = up ? 0.0 : 1.0;
    const double way = up ? 1.0 : -1.0;
    p_.i = i;
    p_.j = j;
    at_ = across_t ? Pair{along, side} : Pair{side, along};
    inward_ = across_t ? Pair{0.0, way} : Pair{way, 0.0};
    inside_ = false;
    patch_ = surface_.patch_inside(i, j);
    if constexpr (kFriction) friction_ = surface_.coefficients(i, j);
    z_ = patch_.height(at_[0], at_[1]);
    return true;
  }

  const BilinearSurface& surface_;
  const CellVector& hip_;
  double tolerance_;
  CellPoint& p_;
  BilinearPatch patch_;
  Pair inward_;
  SolverState& state_;
  Pair at_;
  double z_;
  bool inside_;
  CellCoefficients friction_;
  FastPathEnd ending_ = FastPathEnd::handed_over;
};

}  // namespace sparsha::haptics
