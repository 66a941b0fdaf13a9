#include "emulator/person.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace sparsha::emulator {
namespace {

constexpr std::uint8_t kGreen = 2, kBlue = 4, kRed = 8;
constexpr std::uint8_t kCentre = 4;  ///< button
constexpr double kStep_s = 50e-6;
constexpr double kGravity_m_per_s2 = 9.80665;
/// After a longer pause the hand has long been where it wants to be.
constexpr double kLongestGap_s = 0.1;
// On the axis, metres.
constexpr double kFullyOut_m = 0.172, kFullyIn_m = 0.103, kInFront_m = 0.171, kHover_m = 0.158, kDeepest_m = 0.112;
constexpr double kWalk_m_per_s = 0.25;  ///< of the wish while homing

/// Presses with about a newton, strokes in circles, lifts; guided by what it feels. Clicks the grip's centre in the
/// air.
class PressAndStroke {
 public:
  Wish operator()(double dt_s, const Vec3& felt_n, const Vec3&) {
    time_s_ += dt_s;
    const double felt = std::hypot(felt_n[0], felt_n[1], felt_n[2]);
    constexpr double kLift_s = 0.6, kStroke_s = 2.0, kApproach_m_per_s = 0.04, kPress_n = 1.0;
    if (lifting_) {
      z_m_ = std::min(kHover_m, z_m_ + 2.0 * kApproach_m_per_s * dt_s);
      if (time_s_ > kLift_s) begin(false);
    } else if (!touching_) {
      z_m_ = std::max(kDeepest_m, z_m_ - kApproach_m_per_s * dt_s);
      touching_ = felt > 0.3;
      if (touching_) time_s_ = 0.0;
      if (!touching_ && z_m_ <= kDeepest_m) begin(true);
    } else {
      const double faster = std::clamp((felt - kPress_n) * 0.02, -0.02, 0.02);
      z_m_ = std::clamp(z_m_ + faster * dt_s, kDeepest_m, kHover_m);
      turn_rad_ += 2.0 * dt_s;
      if (time_s_ > kStroke_s) begin(true);
    }
    radius_m_ = std::min(0.012, radius_m_ + 0.01 * dt_s);
    constexpr double kClick_s = 0.3;
    const bool clicks = lifting_ && time_s_ < kClick_s;
    return {{radius_m_ * std::cos(turn_rad_), radius_m_ * std::sin(turn_rad_), z_m_},
            clicks ? kCentre : std::uint8_t{0}};
  }

 private:
  void begin(bool lifting) {
    lifting_ = lifting;
    touching_ = false;
    time_s_ = 0.0;
  }

  double time_s_ = 0.0, z_m_ = kHover_m, turn_rad_ = 0.0, radius_m_ = 0.0;
  bool lifting_ = false, touching_ = false;
};

class Person {
 public:
  explicit Person(PersonOptions options) : options_(std::move(options)) {
    if (!options_.explore) options_.explore = PressAndStroke{};
  }

  Grip operator()(const Felt& felt) {
    if (time_s_ < 0.0) time_s_ = felt.time_s;
    const double gap_s = std::max(0.0, felt.time_s - time_s_);
    time_s_ = felt.time_s;
    const double dt_s = std::min(gap_s, kLongestGap_s);
    wish(felt, dt_s);
    if (gap_s > kLongestGap_s) {
      place_m_ = wish_.place_m;
      velocity_ = {};
    }
    move(felt.force_n, dt_s);
    return {place_m_, wish_.buttons};
  }

 private:
  void wish(const Felt& felt, double dt_s) {
    if ((felt.lights & kBlue) != 0) {
      inwards_ = false;
      if (options_.weight_kg > 0.0) return let_go_and_hang(dt_s);
      wish_ = options_.explore(dt_s, felt.force_n, place_m_);
    } else if ((felt.lights & kGreen) != 0) {
      walk(kInFront_m, dt_s);
    } else if ((felt.lights & kRed) != 0) {
      if (walk(inwards_ ? kFullyIn_m : kFullyOut_m, dt_s)) inwards_ = !inwards_;
    }
  }

  /// As who calibrates a device: brings the grip to the middle, lets it go, hangs the weight on it.
  void let_go_and_hang(double dt_s) {
    constexpr double kMiddle_m = 0.140, kLetGoAfter_s = 1.0;
    if (walk(kMiddle_m, dt_s) || middle_s_ > 0.0) middle_s_ += dt_s;
    lets_go_ = middle_s_ > kLetGoAfter_s;
    hangs_ = middle_s_ > kLetGoAfter_s + options_.weight_after_s;
  }

  /// Towards a place on the axis; true once the hand is there.
  bool walk(double z_m, double dt_s) {
    const Vec3 goal{0.0, 0.0, z_m};
    Vec3 way{};
    for (std::size_t i = 0; i < 3; ++i) way[i] = goal[i] - wish_.place_m[i];
    const double length = std::hypot(way[0], way[1], way[2]);
    const double share = length > 0.0 ? std::min(1.0, kWalk_m_per_s * dt_s / length) : 0.0;
    for (std::size_t i = 0; i < 3; ++i) wish_.place_m[i] += share * way[i];
    wish_.buttons = 0;
    return std::abs(place_m_[2] - z_m) < 1e-3;
  }

  void move(const Vec3& force_n, double dt_s) {
    const int steps = std::max(1, static_cast<int>(std::ceil(dt_s / kStep_s)));
    const double step_s = dt_s / steps;
    const double stiffness = lets_go_ ? 0.0 : options_.stiffness_n_per_m;
    const double weight_kg = hangs_ ? options_.weight_kg : 0.0;
    const Vec3 weight_n{0.0, -weight_kg * kGravity_m_per_s2, 0.0};
    for (int step = 0; step < steps; ++step)
      for (std::size_t i = 0; i < 3; ++i) {
        const double pull = stiffness * (wish_.place_m[i] - place_m_[i]) - options_.damping_n_s_per_m * velocity_[i] +
                            force_n[i] + weight_n[i];
        velocity_[i] += step_s / (options_.mass_kg + weight_kg) * pull;
        place_m_[i] += step_s * velocity_[i];
      }
  }

  PersonOptions options_;
  double time_s_ = -1.0;
  Wish wish_{{0.0, 0.0, 0.1346}, 0};
  Vec3 place_m_{0.0, 0.0, 0.1346};
  Vec3 velocity_{};
  bool inwards_ = false;
  double middle_s_ = 0.0;  ///< since the grip was brought to the middle
  bool lets_go_ = false, hangs_ = false;
};

}  // namespace

Falcon::Hand make_person(PersonOptions options) {
  auto person = std::make_shared<Person>(std::move(options));
  return [person](const Felt& felt) { return (*person)(felt); };
}

}  // namespace sparsha::emulator
