// Where friction stops a straight slide over one patch.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/contact/bilinear_patch.h"
#include "haptics/contact/tangent_cone.h"

namespace sparsha::haptics {

inline constexpr double kStickAgain = 0.9;  // of mu_dynamic
inline constexpr double kRootShare = 0.25;  // of the rest tolerance: how well the stop is found

/// 1e-9 of a cell, or what the caller wants, and the rounding of w. The largest component bounds |w| from below.
[[nodiscard]] inline double rest_tolerance(double tolerance, const CellVector& w) noexcept {
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  return tolerance + kRounding * std::max(std::max(std::abs(w.x), std::abs(w.y)), std::abs(w.z));
}

/// The excess sqrt(area) (|T| - mu |N|) along a straight segment of one patch; all but |T| are polynomials.
class Slide {
 public:
  /// From (s, t) by (ds, dt); `rise` and `twist` are the first and second order of the height along it.
  Slide(const BilinearPatch& patch, const Pull& pull, const CellVector& w, double ds, double dt, double rise,
        double twist, const CellCoefficients& friction, double s, double t) noexcept
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
        normal1_(-patch.c * (dt * w.x + ds * w.y)),
        mu_(friction.at(s, t)),
        mu1_(ds * (friction.a + friction.c * t) + dt * (friction.b + friction.c * s)),
        mu2_(friction.c * ds * dt) {}

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

  /// The same and its derivative by tau, where the hand presses.
  [[nodiscard]] double excess_and_slope(double tau, double& slope) const noexcept {
    const double x = w_.x - tau * ds_;
    const double y = w_.y - tau * dt_;
    const double z = w_.z - tau * (rise_ + tau * twist_);
    const double z1 = -(rise_ + 2.0 * tau * twist_);
    const double fs = fs_ + tau * fs1_;
    const double ft = ft_ + tau * ft1_;
    const double bs = x + fs * z;
    const double bt = y + ft * z;
    const double bs1 = fs1_ * z + fs * z1 - ds_;
    const double bt1 = ft1_ * z + ft * z1 - dt_;
    const double cross = bs * ft - bt * fs;
    const double cross1 = (bs1 * ft - bt1 * fs) + (bs * ft1_ - bt * fs1_);
    const double press = -(normal_ + tau * (normal1_ + tau * twist_));
    const double press1 = -(normal1_ + 2.0 * tau * twist_);
    const double mu = mu_ + tau * (mu1_ + tau * mu2_);
    const double mu1 = mu1_ + 2.0 * tau * mu2_;
    const double tangent = std::sqrt(bs * bs + bt * bt + cross * cross);
    slope = (bs * bs1 + bt * bt1 + cross * cross1) / tangent - (mu1 * press + mu * press1);
    return tangent - mu * std::max(0.0, press);
  }

  /// Where the excess would vanish if |T| fell to zero linearly and mu |N| went on as it begins.
  [[nodiscard]] double guess(double tangent, double hold, double press, double mu) const noexcept {
    return (tangent - hold) / (tangent + mu1_ * press - mu * normal1_);
  }

  /// Newton from the guess; false when it does not settle inside (0, end).
  [[nodiscard]] bool stop(double& tau, double end, double tolerance) const noexcept {
    constexpr int kSteps = 6;
    for (int k = 0; k < kSteps; ++k) {
      if (!(tau > 0.0 && tau < end)) return false;
      double slope;
      const double here = excess_and_slope(tau, slope);
      if (std::abs(here) <= tolerance) return true;
      if (!(slope < 0.0)) return false;
      tau -= here / slope;
    }
    return false;
  }

 private:
  CellVector w_;
  double fs_, ft_, ds_, dt_, rise_, twist_, fs1_, ft1_, normal_, normal1_, mu_, mu1_, mu2_;
};

}  // namespace sparsha::haptics
