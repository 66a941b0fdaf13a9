#include "haptics/device/simulated/exploration_script.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/numbers/hash.h"

namespace sparsha::haptics {
namespace {

// How the simulated person moves, and what each value amounts to.
constexpr double kHoverHeight_m = 0.03;     // first height above the device's origin, where the surface is
constexpr double kLift_m = 0.025;           // above the last place that was touched
constexpr double kApproach_m_per_s = 0.05;  // 0.05 mm a tick: stone of 1 N/mm is noticed (kTouchForce_n) within three
constexpr double kTravel_m_per_s = 0.15;    // in the air, where nothing is met: three times the approach
constexpr double kTouchForce_n = 0.15;      // a fingertip notices this
constexpr double kForceGain_m_per_n_s = 0.02;  // intended depth per newton missing: a whole newton takes 20 mm/s
constexpr double kSearch_m_per_s = 0.08;       // downwards when the surface is lost: between approach and travel
constexpr double kLateralLimit_n = 2.0;        // a wall: slow down and climb
constexpr double kClimb_m_per_s = 0.04;        // up a wall: half the search
constexpr double kLongestApproach_s = 2.0;     // 10 cm at kApproach_m_per_s: no surface is there
constexpr double kDeepest_m = -0.2;            // nobody reaches through the table
constexpr double kStrike_m_per_s = 0.3;        // a knock: six times the approach
constexpr double kStruckForce_n = 0.4;      // the knock has met stone: above a touch, below the least press of a stroke
constexpr double kLongestStrike_s = 0.4;    // 12 cm at kStrike_m_per_s: past any surface below the hover
constexpr double kTourStroke_s = 2.6;       // one stroke and four strikes fit a run of 10 s
constexpr double kTourStrokeForce_n = 1.2;  // within the 0.6 to 2 N of other strokes
constexpr double kButton_s = 0.1;           // a click, much shorter than a hold

}  // namespace

ExplorationScript::ExplorationScript(std::uint64_t seed, double workspace_width_m, std::vector<TourStop> tour)
    : tour_(std::move(tour)),
      random_(seed),
      radius_m_(0.3 * workspace_width_m),
      target_m_(0.0, 0.0, kHoverHeight_m),
      goal_m_(target_m_) {
  phase_length_s_ = 0.3;
  if (const TourStop* first = stop()) goal_m_.head<2>() = first->at_m;
}

std::uint64_t ExplorationScript::buttons() const noexcept {
  const TourStop* now = stop();
  const double since_s = phase_s_ - 0.5 * phase_length_s_;
  const bool pressed = now != nullptr && phase_ == Phase::stroke && since_s >= 0.0 && since_s < kButton_s;
  return pressed ? now->buttons : 0;
}

// SplitMix64 (Steele, Lea, Flood 2014): the same numbers with every standard library.
double ExplorationScript::uniform(double low, double high) noexcept {
  const std::uint64_t bits = mix_bits(random_ += kGoldenStep);
  return low + (high - low) * (static_cast<double>(bits >> 11U) * 0x1.0p-53);
}

void ExplorationScript::enter(Phase phase) noexcept {
  phase_ = phase;
  phase_s_ = 0.0;
  switch (phase) {
    case Phase::hover: {
      if (const TourStop* next = stop()) {
        goal_m_ = {next->at_m.x(), next->at_m.y(), target_m_.z()};
        phase_length_s_ = 0.0;
        break;
      }
      const double angle = uniform(0.0, 2.0 * std::numbers::pi);
      const double radius = radius_m_ * std::sqrt(uniform(0.0, 1.0));
      goal_m_ = {radius * std::cos(angle), radius * std::sin(angle), target_m_.z()};
      phase_length_s_ = uniform(0.2, 0.4);
      break;
    }
    case Phase::approach:
      phase_length_s_ = kLongestApproach_s;
      break;
    case Phase::strike:
      phase_length_s_ = kLongestStrike_s;
      break;
    case Phase::press:
      wanted_force_n_ = stop() != nullptr ? kTourStrokeForce_n : uniform(0.6, 2.0);
      phase_length_s_ = uniform(0.3, 0.6);
      break;
    case Phase::stroke:
      if (const TourStop* now = stop()) {
        const Eigen::Vector2d way = now->to_m - target_m_.head<2>();
        phase_length_s_ = kTourStroke_s;
        speed_ = way.norm() / kTourStroke_s;
        heading_rad_ = std::atan2(way.y(), way.x());
        break;
      }
      speed_ = uniform(0.02, 0.08);
      heading_rad_ = uniform(0.0, 2.0 * std::numbers::pi);
      phase_length_s_ = uniform(2.5, 4.0);
      break;
    case Phase::lift:
      goal_m_ = target_m_;
      break;
  }
}

// Keeps the force across the surface near the wanted one by moving the intended depth.
void ExplorationScript::regulate(const Eigen::Vector3d& felt_force_n, double dt_s) noexcept {
  const double up_n = felt_force_n.z();
  const double lateral_n = std::hypot(felt_force_n.x(), felt_force_n.y());
  double rate = -kForceGain_m_per_n_s * (wanted_force_n_ - up_n);
  if (up_n < kTouchForce_n && lateral_n < kTouchForce_n) rate = -kSearch_m_per_s;
  if (lateral_n > kLateralLimit_n) rate = kClimb_m_per_s;
  target_m_.z() = std::max(kDeepest_m, target_m_.z() + std::clamp(rate, -kSearch_m_per_s, kClimb_m_per_s) * dt_s);
}

void ExplorationScript::hover(double dt_s) noexcept {
  const Eigen::Vector3d way = goal_m_ - target_m_;
  const double longest = kTravel_m_per_s * dt_s;
  if (way.norm() > longest) {
    target_m_ += way * (longest / way.norm());
    return;
  }
  target_m_ = goal_m_;
  if (phase_s_ < phase_length_s_) return;
  const TourStop* next = stop();
  enter(next != nullptr && next->kind == TourStop::Kind::strike ? Phase::strike : Phase::approach);
}

// Where a stroke goes: straight on in a tour, else wandering, and back before the workspace ends.
void ExplorationScript::steer(double dt_s) noexcept {
  if (stop() != nullptr) return;
  turn_rad_per_s_ += (uniform(-60.0, 60.0) - 2.0 * turn_rad_per_s_) * dt_s;
  const Eigen::Vector2d place = target_m_.head<2>();
  if (place.norm() > radius_m_) {  // come about, the shorter way
    const double home = std::atan2(-place.y(), -place.x());
    turn_rad_per_s_ = 4.0 * std::remainder(home - heading_rad_, 2.0 * std::numbers::pi);
  }
  heading_rad_ += turn_rad_per_s_ * dt_s;
}

const Eigen::Vector3d& ExplorationScript::advance(const Eigen::Vector3d& felt_force_n, const Eigen::Vector3d& hand_m,
                                                  double dt_s) noexcept {
  phase_s_ += dt_s;
  switch (phase_) {
    case Phase::hover:
      hover(dt_s);
      break;
    case Phase::approach:
      target_m_.z() -= kApproach_m_per_s * dt_s;
      if (felt_force_n.norm() > kTouchForce_n || phase_s_ >= phase_length_s_) enter(Phase::press);
      break;
    case Phase::strike:
      target_m_.z() -= kStrike_m_per_s * dt_s;
      if (felt_force_n.norm() > kStruckForce_n || phase_s_ >= phase_length_s_) enter(Phase::lift);
      break;
    case Phase::press:
      regulate(felt_force_n, dt_s);
      if (phase_s_ >= phase_length_s_) enter(Phase::stroke);
      break;
    case Phase::stroke: {
      regulate(felt_force_n, dt_s);
      steer(dt_s);
      const double lateral_n = std::hypot(felt_force_n.x(), felt_force_n.y());
      const double advance_m = speed_ * std::clamp(1.5 - lateral_n / kLateralLimit_n, 0.0, 1.0) * dt_s;
      target_m_.x() += advance_m * std::cos(heading_rad_);
      target_m_.y() += advance_m * std::sin(heading_rad_);
      if (phase_s_ >= phase_length_s_) enter(Phase::lift);
      break;
    }
    case Phase::lift:
      // Through the air from where the hand really is: the intended place lies below the surface.
      if (phase_s_ <= dt_s) goal_m_.z() = std::max(std::max(hand_m.z(), target_m_.z()) + kLift_m, kHoverHeight_m);
      target_m_.z() += kTravel_m_per_s * dt_s;
      if (target_m_.z() >= goal_m_.z()) {
        if (stop() != nullptr) ++next_;
        enter(Phase::hover);
        goal_m_.z() = target_m_.z();
      }
      break;
  }
  return target_m_;
}

}  // namespace sparsha::haptics
