// Aim, clearance and depth of the pointer's hand.
#include "viewer/hand.h"

#include <algorithm>
#include <cmath>

#include "scene/scene.h"
#include "viewer/frame.h"

namespace sparsha::viewer {
namespace {

Eigen::Quaterniond turn_of(const haptics::State& state) {
  return {state.turn[3], state.turn[0], state.turn[1], state.turn[2]};
}

constexpr double kPress_m = 0.003;
constexpr double kPress_n = 2.4;  // of a press without the wheel, whatever the stiffness
constexpr double kMost_n = 2.6;   // of a hand that is not moved, whatever the stone does under it
constexpr double kDeepest_m = 0.015;
constexpr double kWheel_m = 0.0005;       // one notch of the wheel
constexpr double kFollow_s = 0.06;        // the pressing hand's height follows so slowly that fine texture is felt
constexpr double kMostAgainst_m = 0.003;  // deeper than asked for, when a pressing hand is moved against a wall
constexpr double kClear_m = 0.002;        // a hand that moves across the stone stays so far above it
constexpr double kThere_m = 0.001;
constexpr double kDeviceFollow_s = 0.012;  // of the pointer device
constexpr double kAimFresh_s = 0.5;
constexpr double kStill_s = 0.25;

}  // namespace

std::optional<Eigen::Vector3d> meet_surface(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                                            const HeightAt& height_at, double above_m, double low_m, double high_m,
                                            double step_m) {
  constexpr double kFlattest = 1e-3;  // sine of the angle below which a ray meets nothing in reach
  constexpr double kMostSteps = 8192.0;
  if (!(direction.z() < -kFlattest) || !(step_m > 0.0) || !(high_m >= low_m)) return std::nullopt;
  const double room_m = 0.01 * (high_m - low_m) + 1e-3 * step_m;
  const double begin = std::max(0.0, (high_m + above_m + room_m - origin_m.z()) / direction.z());
  const double end = (low_m + above_m - room_m - origin_m.z()) / direction.z();
  if (!(end > begin)) return std::nullopt;
  const auto over = [&](double t) {
    const Eigen::Vector3d p = origin_m + t * direction;
    return p.z() - above_m - height_at(p.x(), p.y());
  };
  const double across_m = direction.head<2>().norm() * (end - begin);
  const double steps = std::clamp(std::ceil(across_m / step_m), 1.0, kMostSteps);
  double before = begin;
  for (double k = 1.0; k <= steps; ++k) {
    double after = begin + (end - begin) * k / steps;
    if (over(after) > 0.0) {
      before = after;
      continue;
    }
    for (int halving = 0; halving < 40; ++halving) {
      const double middle = 0.5 * (before + after);
      (over(middle) > 0.0 ? before : after) = middle;
    }
    return Eigen::Vector3d(origin_m + after * direction);
  }
  return std::nullopt;
}

void PointerHand::step(double x_m, double y_m) {
  forget_aim();
  moves();
  wanted_m_ += Eigen::Vector2d(x_m, y_m);
}

void PointerHand::raise(double steps) {
  hover_m_ = std::clamp(hover_m_ + steps * kWheel_m, -kDeepest_m, 2.0 * kHover_m);
}

void PointerHand::wheel(double steps) {
  if (!pressed_) return raise(steps);
  deeper_m_ = std::clamp(deeper_m_.value_or(kPress_m) - steps * kWheel_m, 0.0, kDeepest_m);
}

void PointerHand::press(bool down) {
  pressed_ = down;
  fresh_s_ = 0.0;
  moved_s_ = kLong_s;
}

double PointerHand::press_depth_m(const haptics::State& state) const {
  if (deeper_m_) return *deeper_m_;
  return state.stiffness_n_per_m > 0.0 ? std::min(kPress_m, kPress_n / state.stiffness_n_per_m) : kPress_m;
}

// No limit for a hand that is moved: it may be pushed against a wall. The wheel and the keys may ask for more.
double PointerHand::most_force_n(const haptics::State& state) const {
  if (moved_s_ < kStill_s) return 0.0;
  const double depth_m = pressed_ ? press_depth_m(state) : std::max(0.0, -hover_m_);
  return std::max(kMost_n, state.stiffness_n_per_m * depth_m + (kMost_n - kPress_n));
}

// The hand is where the mouse's ray meets the stone, or the height at which the hand hovers.
void PointerHand::follow_aim(const haptics::State& state, const scene::SceneDescription& scene, const Stage& stage,
                             const HeightAt& height_at) {
  if (!aim_ || fresh_s_ > kAimFresh_s || !(state.scale > 0.0)) return;
  const Eigen::Vector3d centre_m(state.centre_m[0], state.centre_m[1], state.centre_m[2]);
  if (!centre_m.allFinite()) return;
  double low_m = scene.height_min_m, high_m = scene.height_max_m;
  if (!(high_m >= low_m)) low_m = high_m = centre_m.z();
  constexpr double kSmoothShare = 1.0 / 400.0;  // of the window's width: half the distance of its nodes
  bool known = true;
  const auto known_at = [&](double x_m, double y_m) {
    const double height_m = height_at(x_m, y_m);
    known = known && std::isfinite(height_m);
    return std::isfinite(height_m) ? std::max(height_m, low_m) : height_m;  // beyond outlines it falls below all stone
  };
  const auto place =
      meet_surface(stage.to_grid_m(aim_->origin), aim_->direction, known_at, pressed_ ? 0.0 : hover_m_ / state.scale,
                   low_m, high_m, kSmoothShare * window_of(state, scene).width_m);
  if (place && known) wanted_m_ = state.scale * (turn_of(state) * (*place - centre_m)).head<2>();
}

// Critically damped, as the device is.
void PointerHand::follow_device(double seconds) {
  const double decay = std::exp(-seconds / kDeviceFollow_s);
  const Eigen::Vector3d away = device_m_ - sent_m_;
  const Eigen::Vector3d rise = velocity_ + away / kDeviceFollow_s;
  device_m_ = sent_m_ + (away + rise * seconds) * decay;
  velocity_ = (velocity_ - rise * (seconds / kDeviceFollow_s)) * decay;
}

void PointerHand::approach(double seconds, double reach_m, double depth_m, double against_m,
                           const std::function<double(const Eigen::Vector2d&)>& surface_m) {
  const Eigen::Vector2d from = device_m_.head<2>();
  const Eigen::Vector2d way = wanted_m_ - from;
  const double here_m = surface_m(wanted_m_);
  // A press begins when the hand is there.
  const bool presses = (pressed_ || hover_m_ < 0.0) && (sent_m_.head<2>() - wanted_m_).norm() < 1e-9 &&
                       (way.norm() < kThere_m || sent_m_.z() < here_m);
  if (presses || (pressed_ && sent_m_.z() < surface_m(sent_m_.head<2>()))) {
    sent_m_.head<2>() = wanted_m_;
    const double goal_m = here_m - (pressed_ ? depth_m : -hover_m_);
    sent_m_.z() += (1.0 - std::exp(-seconds / kFollow_s)) * (goal_m - sent_m_.z());
    sent_m_.z() = std::max(sent_m_.z(), goal_m - against_m);
  } else {
    // Over what lies between: up at once, across as far as the height allows, then down.
    constexpr int kPlaces = 48;
    const double least_m = std::min(kClear_m, std::max(hover_m_, 0.0));
    double clear_m = here_m + least_m, free_share = 1.0;
    for (int k = 0; k <= kPlaces; ++k) {
      const double share = static_cast<double>(k) / kPlaces;
      const double ground_m = surface_m(from + share * way) + least_m;
      clear_m = std::max(clear_m, ground_m);
      if (device_m_.z() < ground_m - 0.5 * least_m)
        free_share = std::min(free_share, std::max(k - 1, 0) / static_cast<double>(kPlaces));
    }
    sent_m_.head<2>() = from + free_share * way;
    if (free_share == 1.0) sent_m_.head<2>() = wanted_m_;
    const double goal_m = std::max(here_m + std::max(hover_m_, least_m), clear_m);
    const double share = goal_m > sent_m_.z() ? 1.0 : 1.0 - std::exp(-seconds / kFollow_s);
    sent_m_.z() += share * (goal_m - sent_m_.z());
  }
  sent_m_ = sent_m_.cwiseMax(-reach_m).cwiseMin(reach_m);
}

haptics::PointerSample PointerHand::update(double seconds, const haptics::State& state,
                                           const scene::SceneDescription& scene, const Stage& stage, double reach_m,
                                           const HeightAt& height_at) {
  follow_aim(state, scene, stage, height_at);
  fresh_s_ += seconds;
  moved_s_ += seconds;
  if (!wanted_m_.allFinite()) wanted_m_.setZero();
  wanted_m_ = wanted_m_.cwiseMax(-reach_m).cwiseMin(reach_m);
  bool known = true;
  const auto surface_m = [&](const Eigen::Vector2d& device_m) {
    if (state.tick == 0 || !(state.scale > 0.0)) return 0.0;
    if (before_m_)
      if (const double before = before_m_(device_m); std::isfinite(before)) return std::max(before, -reach_m);
    const double height_m =
        height_at(state.centre_m[0] + device_m.x() / state.scale, state.centre_m[1] + device_m.y() / state.scale);
    const double surface = state.scale * (height_m - state.centre_m[2]);
    known = known && std::isfinite(surface);
    return std::isfinite(surface) ? surface : 0.0;
  };
  if (!known_) {
    known_ = true;
    const double begin_m = surface_m(wanted_m_) + hover_m_;
    sent_m_ << wanted_m_, known ? std::clamp(begin_m, -reach_m, reach_m) : reach_m;
    device_m_ = sent_m_;
  }
  follow_device(seconds);
  const double stiffness = state.stiffness_n_per_m, depth_m = press_depth_m(state), most_n = most_force_n(state);
  const bool limited = most_n > 0.0 && stiffness > 0.0;
  const double against_m = limited ? std::clamp(most_n / stiffness - depth_m, 0.0, kMostAgainst_m) : kMostAgainst_m;
  // Over stone that is still read the hand stays where it is: what it would go down to may not be there.
  const Eigen::Vector3d before_m = sent_m_;
  approach(seconds, reach_m, depth_m, against_m, surface_m);
  if (!known) sent_m_ = before_m;
  haptics::PointerSample sample;
  sample.device_m = {sent_m_.x(), sent_m_.y(), sent_m_.z()};
  sample.sequence = ++sequence_;
  sample.most_force_n = most_n;
  sample.stiffness_n_per_m = stiffness;
  return sample;
}

}  // namespace sparsha::viewer
