// Where friction stops a Newton step over one patch.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/proxy/bilinear_patch.h"
#include "haptics/proxy/hot.h"
#include "haptics/proxy/pair.h"

namespace sparsha::haptics {

inline constexpr double kStickAgain = 0.9;  // of mu_dynamic
inline constexpr double kRootShare = 0.25;  // of the rest tolerance: how well the stop is found

/// 1e-9 of a cell, or what the caller wants, and the rounding of w. The largest component bounds |w| from below.
[[nodiscard]] inline double rest_tolerance(double tolerance, const CellVector& w) noexcept {
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  return tolerance + kRounding * std::max(std::max(std::abs(w.x), std::abs(w.y)), std::abs(w.z));
}

/// The excess sqrt(area) (|T| - mu |N|) along a Newton step, by the share tau of its unscaled direction (the adjugate
/// of the Hessian times b), which spares the division by the determinant. All but |T| are polynomials, and of b = -grad
/// D exactly the share 1 - determinant tau is left but for the patch's twist.
struct FrictionStop {
  double determinant;
  Pair b, b2, b3;    ///< b (1 - determinant tau) + b2 tau^2 + b3 tau^3
  Pair grad, grad1;  ///< slopes
  double press, press1, press2;
  double mu, mu1, mu2;

  [[nodiscard]] SPARSHA_HOT double excess(double tau) const noexcept {
    const Pair at = both(tau);
    const Pair b_here = b * both(1.0 - determinant * tau) + both(tau * tau) * (b2 + at * b3);
    const double turn = cross(b_here, grad + at * grad1);
    const double press_here = press + tau * (press1 + tau * press2);
    return std::sqrt(dot(b_here, b_here) + turn * turn) - (mu + tau * (mu1 + tau * mu2)) * std::max(0.0, press_here);
  }

  /// The zero of the excess, which is `start` > 0 at tau = 0, from a guess; false when it is not found inside (0, end).
  [[nodiscard]] SPARSHA_HOT bool stop(double& tau, double start, double end, double tolerance) const noexcept {
    constexpr int kSteps = 6;
    for (int k = 0; k < kSteps; ++k) {
      if (!(tau > 0.0 && tau < end)) return false;
      // The excess, and its slope times |T|, where the hand presses.
      const Pair at = both(tau);
      const Pair b3_here = at * b3;
      const Pair b2_here = b2 + b3_here;
      const Pair b_here = b * both(1.0 - determinant * tau) + both(tau * tau) * b2_here;
      const Pair b_slope = at * (b2_here + b2_here + b3_here) - both(determinant) * b;
      const Pair grad_here = grad + at * grad1;
      const double turn = cross(b_here, grad_here);
      const double turn_slope = cross(b_slope, grad_here) + cross(b_here, grad1);
      const double press_here = press + tau * (press1 + tau * press2);
      const double mu_here = mu + tau * (mu1 + tau * mu2);
      const double hold_slope = (mu1 + 2.0 * tau * mu2) * press_here + mu_here * (press1 + 2.0 * tau * press2);
      const double tangent = std::sqrt(dot(b_here, b_here) + turn * turn);
      const double here = tangent - mu_here * std::max(0.0, press_here);
      const double slope = (dot(b_here, b_slope) + turn * turn_slope) - tangent * hold_slope;
      if (!(slope < 0.0)) return std::abs(here) <= tolerance;
      const double inverse = 1.0 / slope;
      const double step = here * tangent * inverse;
      // Newton, and as much again as the parabola through the start's value bends away from the tangent.
      const double bend = ((start - here) * tangent + slope * tau) / (tau * tau);
      tau -= step + bend * inverse * (step * step);
      if (std::abs(excess(tau)) <= tolerance) return tau > 0.0 && tau < end;
    }
    return false;
  }
};

}  // namespace sparsha::haptics
