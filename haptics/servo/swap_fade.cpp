#include "haptics/servo/swap_fade.h"

#include <algorithm>
#include <cmath>

#include "base/numbers/smooth_step.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;

constexpr double kDuration_s = 0.075;
constexpr double kAim_s = 0.105;
constexpr double kShortest_s = 0.020;
constexpr double kSettled_s = 0.300;    // since the swap; then a hand that slips does so by itself
constexpr double kSteep = 1.0;          // times its own stiffness is as much as a motion explains
constexpr double kSteepEdge = 1.5;      // likewise on a whole object, whose curved places turn the force as well
constexpr double kKick_n = 0.05;        // of a hand at rest there
constexpr double kWhole_n = 0.3;        // smaller changes take less time
constexpr double kNothing_n = 0.01;     // is not felt
constexpr double kStep_n = 0.034;       // most per tick
constexpr double kWholeStep_n = 0.045;  // with what the hand's own motion adds
constexpr double kLeastStep_n = 0.008;
constexpr double kTurn_rad = 0.065;  // most per tick
constexpr double kFelt_n = 0.05;     // of a smaller force nobody feels the direction
constexpr double kNear_m = 0.005;    // farther from where the swap was, the old surface says little

}  // namespace

bool SwapFade::is_felt(const Vector3d& old_n, const Vector3d& fresh_n) noexcept {
  return (fresh_n - old_n).norm() > kNothing_n;
}

void SwapFade::begin(const Vector3d& old_n, const Vector3d& fresh_n, const Vector3d& hand_m,
                     double stiffness_n_per_m) noexcept {
  watching_ = active_ || is_felt(old_n, fresh_n);
  since_swap_s_ = 0.0;
  begun_m_ = hand_m;
  fade(old_n, fresh_n, hand_m, stiffness_n_per_m, kDuration_s);
  felt_n_ = old_n;
}

void SwapFade::fade(const Vector3d& old_n, const Vector3d& fresh_n, const Vector3d& hand_m, double stiffness_n_per_m,
                    double duration_s) noexcept {
  fresh_n_ = fresh_n;
  stiffness_n_per_m_ = stiffness_n_per_m;
  last_m_ = hand_m;
  const double change_n = (fresh_n - old_n).norm();
  active_ = change_n > kNothing_n && std::isfinite(change_n) && stiffness_n_per_m > 0.0;
  if (!active_) return;
  const double old_length_n = old_n.norm();
  time_share_ = 0.0;
  duration_s_ = duration_s * std::min(1.0, change_n / kWhole_n);
  depth_m_ = old_length_n / stiffness_n_per_m;
  normal_ = old_length_n > 0.0 ? Vector3d(old_n / old_length_n) : Vector3d::Zero();
  place_m_ = hand_m + depth_m_ * normal_;
}

/// How much further the fade goes now: by time, as far as the force then neither steps nor turns much, and faster for a
/// hand that has gone away.
double SwapFade::step(const Vector3d& old_n, const Vector3d& way_n, double changed_n, double travel_m,
                      double period_s) const noexcept {
  const double share = smooth_step(time_share_);
  const double step_n = std::clamp(kWholeStep_n - changed_n, kLeastStep_n, kStep_n);
  double most = step_n / std::max(way_n.norm(), step_n);
  const Vector3d now_n = old_n + share * way_n;
  const double now = now_n.norm();
  if (now > kFelt_n) {
    const double across = (way_n - now_n * (way_n.dot(now_n) / (now * now))).norm();
    most = std::min(most, kTurn_rad * now / std::max(across, kTurn_rad * now));
  }
  double next = std::min(1.0, time_share_ + period_s / duration_s_);
  if (smooth_step(next) - share > most) {
    // The inverse of the smooth step near `share`, by bisection: monotone, so that it always ends.
    double low = time_share_;
    for (int k = 0; k < 20; ++k) {
      const double middle = 0.5 * (low + next);
      (smooth_step(middle) - share > most ? next : low) = middle;
    }
    next = low;
  }
  return next - time_share_ + travel_m / kNear_m;
}

Vector3d SwapFade::mean(const Vector3d& fresh_n, const Vector3d& hand_m, double stiffness_n_per_m,
                        double period_s) noexcept {
  if (!active_) return fresh_n;
  const double depth_m = std::clamp((place_m_ - hand_m).dot(normal_), 0.0, depth_m_);
  const Vector3d old_n = stiffness_n_per_m * depth_m * normal_;
  const Vector3d way_n = fresh_n - old_n;
  const bool far = !always_ && (hand_m - begun_m_).norm() > kNear_m;
  const double travel_m = far ? (hand_m - last_m_).norm() : 0.0;
  time_share_ += step(old_n, way_n, (fresh_n - fresh_n_).norm(), travel_m, period_s);
  active_ = time_share_ < 1.0;
  return active_ ? Vector3d(old_n + smooth_step(time_share_) * way_n) : fresh_n;
}

/// Did the new surface's force change by more than the hand's own motion explains? On the way to its new rest a hand
/// breaks loose from static friction or is let off a ridge.
bool SwapFade::jumps(const Vector3d& fresh_n, const Vector3d& hand_m, double stiffness_n_per_m,
                     const Explained& explained) const noexcept {
  const double moved_n = stiffness_n_per_m * (hand_m - last_m_).norm();
  const double stiffened_n = std::abs(stiffness_n_per_m - stiffness_n_per_m_) / stiffness_n_per_m * fresh_n.norm();
  return (fresh_n - fresh_n_).norm() > explained.still_n + explained.steepness * moved_n + stiffened_n;
}

Vector3d SwapFade::apply(const Vector3d& fresh_n, const Vector3d& hand_m, double stiffness_n_per_m,
                         double period_s) noexcept {
  if (!watching_ && !always_) return fresh_n;
  const bool after_swap = watching_;
  since_swap_s_ += period_s;
  watching_ = active_ || since_swap_s_ < kSettled_s;
  if (after_swap && since_swap_s_ < kSettled_s && stiffness_n_per_m > 0.0 && (hand_m - begun_m_).norm() < kNear_m &&
      jumps(fresh_n, hand_m, stiffness_n_per_m, {kSteep, kNothing_n})) {
    fade(felt_n_, fresh_n, last_m_, stiffness_n_per_m, std::clamp(kAim_s - since_swap_s_, kShortest_s, kDuration_s));
  } else if (always_ && knows_ && stiffness_n_per_m > 0.0 &&
             jumps(fresh_n, hand_m, stiffness_n_per_m, {kSteepEdge, kKick_n})) {
    begun_m_ = hand_m;
    fade(felt_n_, fresh_n, last_m_, stiffness_n_per_m, kDuration_s);
  }
  knows_ = true;
  felt_n_ = mean(fresh_n, hand_m, stiffness_n_per_m, period_s);
  fresh_n_ = fresh_n;
  stiffness_n_per_m_ = stiffness_n_per_m;
  last_m_ = hand_m;
  return felt_n_;
}

}  // namespace sparsha::haptics
