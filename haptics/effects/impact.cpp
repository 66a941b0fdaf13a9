#include "haptics/effects/impact.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sparsha::haptics {
namespace {

constexpr double kLeast_m_per_s = 0.015;  // slower touches do not ring
constexpr double kMost_m_per_s = 0.5;     // faster ones not louder
constexpr double kDeparture_s = 0.020;    // of a hand that has left, and how far
constexpr double kDeparture_m = 0.0005;
constexpr double kLongDeparture_s = 0.100;  // then the surface has gone from under the hand
constexpr double kSilent_n = 0.01;
constexpr double kMostCyclesPerTick = 0.3;
constexpr double kPeriodShare = 0.05;  // of a new period in the mean

}  // namespace

void Impact::reset() noexcept {
  amplitude_n_ = 0.0;
  free_s_ = 0.0;
  touched_ = false;
}

void Impact::watch_departure(const Input& input) noexcept {
  if (input.contact) {
    free_s_ = 0.0;
    away_m_ = 0.0;
    touched_ = true;
    left_m_ = input.hand_m;
    left_normal_ = input.normal;
    return;
  }
  free_s_ += std::min(input.period_s, input.pace_s);
  away_m_ = std::max(away_m_, (input.hand_m - left_m_).dot(left_normal_));
}

void Impact::begin(const Input& input) noexcept {
  const bool departed =
      free_s_ >= kDeparture_s && (!touched_ || away_m_ >= kDeparture_m || free_s_ >= kLongDeparture_s);
  const double speed = std::min(input.approach_m_per_s, kMost_m_per_s);
  if (!departed || input.material == nullptr || !(speed >= kLeast_m_per_s)) return;
  // Slow loops cannot ring so fast, and hold each force for longer: they ring lower and softer.
  const double frequency_hz = std::min(input.material->frequency_hz, kMostCyclesPerTick / period_s_);
  radians_per_s_ = 2.0 * std::numbers::pi * frequency_hz;
  decay_per_s_ = input.material->decay_per_s;
  const double slower = frequency_hz / input.material->frequency_hz;
  amplitude_n_ = input.material->force_per_speed_n_s_per_m * speed * slower * slower;
  budget_j_ = 0.5 * scene::kLightestHand_kg * speed * speed;
  time_s_ = 0.0;
  left_j_ = budget_j_;
  mean_n_ = 0.0;
}

/// Subtracts half of the ring's work, which may go into the hand: which half of a cycle meets which way of the hand
/// depends on the device's delay, which is not known.
void Impact::spend(const Input& input) noexcept {
  const double way_m = std::abs((input.hand_m - last_m_).dot(input.normal));
  left_j_ -= 0.5 * way_m * mean_n_;
  if (!(left_j_ > 0.0)) amplitude_n_ = 0.0;
}

double Impact::update(const Input& input) noexcept {
  const double period_s = std::max(input.period_s, 0.1 * input.pace_s);
  period_s_ = period_s_ > 0.0 ? period_s_ + kPeriodShare * (period_s - period_s_) : input.pace_s;
  if (input.touch) begin(input);
  watch_departure(input);
  double ring_n = 0.0;
  if (!input.contact) amplitude_n_ = 0.0;
  if (amplitude_n_ > 0.0 && time_s_ > 0.0) spend(input);
  if (amplitude_n_ > 0.0) {
    // In the middle of the time that the device holds it.
    const double t = time_s_ + 0.5 * period_s_;
    const double decayed_n = amplitude_n_ * std::exp(-decay_per_s_ * t);
    const double share = std::sqrt(std::sqrt(left_j_ / budget_j_));
    ring_n = std::max(-input.pressed_n, share * decayed_n * std::sin(radians_per_s_ * t));
    mean_n_ += (std::abs(ring_n) - mean_n_) * std::min(1.0, period_s * radians_per_s_ / (2.0 * std::numbers::pi));
    time_s_ += period_s;
    if (share * decayed_n <= kSilent_n) amplitude_n_ = 0.0;
  }
  last_m_ = input.hand_m;
  return ring_n;
}

}  // namespace sparsha::haptics
