#include "haptics/device/steered/steering_script.h"

#include <algorithm>
#include <cmath>

namespace sparsha::haptics {
namespace {

constexpr double kHover_m = 0.03;         // first height above the device's origin, where the surface is
constexpr double kLift_m = 0.01;          // a lifted hand is so far above the last place that it touched
constexpr double kReachShare = 0.49;      // of the workspace's width, to each side
constexpr double kTouchForce_n = 0.1;     // a fingertip notices this
constexpr double kSearch_m_per_s = 0.06;  // downwards in the air: a touch is no blow
constexpr double kRise_m_per_s = 0.08;
constexpr double kForceGain_m_per_n_s = 0.03;  // intended depth per newton missing
constexpr double kLateralLimit_n = 1.5;        // a wall: the hand slows down and climbs
constexpr double kClimb_m_per_s = 0.06;
constexpr double kLead_m = 0.005;  // that the intended place is ahead of a hand that is held up

}  // namespace

SteeringScript::SteeringScript(double workspace_width_m)
    : reach_m_(kReachShare * workspace_width_m), target_m_(0.0, 0.0, kHover_m), touched_m_(0.0) {}

// A hand that a wall holds up waits for the climb instead of pressing ever harder.
void SteeringScript::go_across(const SteeringSample& wish, double lateral_n, const Eigen::Vector3d& hand_m,
                               double dt_s) noexcept {
  const Eigen::Vector2d wanted_m(std::clamp(wish.wanted_m[0], -reach_m_, reach_m_),
                                 std::clamp(wish.wanted_m[1], -reach_m_, reach_m_));
  const Eigen::Vector2d way_m = wanted_m - target_m_.head<2>();
  const double speed = wish.speed_m_per_s * std::clamp(2.0 - lateral_n / kLateralLimit_n, 0.0, 1.0);
  const double longest_m = std::max(0.0, speed) * dt_s;
  Eigen::Vector2d next_m = wanted_m;
  if (way_m.norm() > longest_m) next_m = target_m_.head<2>() + way_m * (longest_m / way_m.norm());
  const Eigen::Vector2d lead_m = next_m - hand_m.head<2>();
  const bool away = lead_m.dot(way_m) > 0.0 && lead_m.norm() > kLead_m;
  if (!away) target_m_.head<2>() = next_m;
}

void SteeringScript::go_down(const SteeringSample& wish, double up_n, double lateral_n, double hand_m,
                             double dt_s) noexcept {
  double rate = kForceGain_m_per_n_s * (up_n - wish.press_n);
  if (std::hypot(up_n, lateral_n) < kTouchForce_n)
    rate = -kSearch_m_per_s;
  else
    touched_m_ = hand_m;
  if (lateral_n > kLateralLimit_n) rate = kClimb_m_per_s;
  target_m_.z() += std::clamp(rate, -kSearch_m_per_s, kClimb_m_per_s) * dt_s;
}

const Eigen::Vector3d& SteeringScript::advance(const SteeringSample& wish, const Eigen::Vector3d& felt_force_n,
                                               const Eigen::Vector3d& hand_m, double dt_s) noexcept {
  if (wish.sequence == 0 || !std::isfinite(wish.wanted_m[0]) || !std::isfinite(wish.wanted_m[1])) return target_m_;
  const double lateral_n = std::hypot(felt_force_n.x(), felt_force_n.y());
  if (wish.armed == 0) {
    target_m_.z() += kRise_m_per_s * dt_s;
  } else if (!(wish.press_n > 0.0)) {
    const double way_m = touched_m_ + kLift_m - target_m_.z();
    const bool meets = felt_force_n.norm() >= kTouchForce_n;  // a hill in the way of the lifted hand
    if (meets) touched_m_ = std::max(touched_m_, hand_m.z());
    const double fastest_m = kRise_m_per_s * dt_s;
    target_m_.z() += std::clamp(meets ? std::max(way_m, fastest_m) : way_m, -fastest_m, fastest_m);
    go_across(wish, lateral_n, hand_m, dt_s);
  } else {
    go_down(wish, felt_force_n.z(), lateral_n, hand_m.z(), dt_s);
    go_across(wish, lateral_n, hand_m, dt_s);
  }
  target_m_.z() = std::clamp(target_m_.z(), -reach_m_, reach_m_);
  return target_m_;
}

}  // namespace sparsha::haptics
