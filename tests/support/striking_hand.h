// A hand that taps, through a loop with a delay and a rate of its own, and the share of a force's energy above a
// frequency. Mechanics, energy account and spectrum share no code with the renderer, the governor or the effects.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "haptics/servo/haptic_renderer.h"
#include "tests/support/servo_parts.h"

namespace sparsha::test {

struct StrikingHand {
  double mass_kg = 0.15;
  double damping_n_s_per_m = 2.0;
  double grip_n_per_m = 300.0;
  double speed_m_per_s = 0.1;  ///< down and up again
  double below_m = 0.001;      ///< the intended place goes so far under the surface
  double rate_hz = 1000.0;
  double delay_s = 0.001;
  double encoder_step_m = 20e-6;
  double wish_n_per_m = 800.0;
};

struct Strike {
  std::vector<double> force_n;    ///< commanded, along z, every tick from first contact to the end of the touch
  double approach_m_per_s = 0.0;  ///< of the hand at first contact
  double peak_s = 0.0;            ///< from contact to the largest force
  double given_j = 0.0;           ///< most that the hand got beyond what the spring gave back, from any moment on
  double least_n = 0.0;           ///< of the commanded force
};

/// One tap on a level surface at z = 0 of the device frame.
inline Strike strike(const StrikingHand& c, haptics::HapticWindow window) {
  using Eigen::Vector3d;
  constexpr double kStep = 20e-6;
  constexpr double kHover_m = 0.012;
  haptics::DeviceInfo info;
  haptics::RendererOptions options;
  options.rate_hz = c.rate_hz;
  options.stiffness_n_per_m = c.wish_n_per_m;
  haptics::HapticRenderer renderer(info, options, std::move(window));
  const double way_m = kHover_m + c.below_m;
  const auto intended = [&](double t) {
    const double gone = c.speed_m_per_s * std::max(0.0, t - 0.12);
    return kHover_m - (gone < way_m ? gone : std::max(0.0, 2.0 * way_m - gone));
  };
  struct Force {
    double time_s;
    double force_n;
  };
  std::deque<Force> on_the_way;
  Strike result;
  double z = kHover_m;
  double velocity = 0.0;
  double held = 0.0;
  double work_j = 0.0;
  double least_j = std::numeric_limits<double>::infinity();
  double touched_s = -1.0;
  double last_contact_s = -1.0;
  double peak_n = 0.0;
  double next_tick_s = 0.0;
  const double end_s = 0.12 + 2.0 * way_m / c.speed_m_per_s + 0.1;
  for (std::uint64_t step = 0; static_cast<double>(step) * kStep < end_s; ++step) {
    const double t = static_cast<double>(step) * kStep;
    if (t >= next_tick_s) {
      next_tick_s += 1.0 / c.rate_hz;
      const double measured = c.encoder_step_m > 0.0 ? c.encoder_step_m * std::round(z / c.encoder_step_m) : z;
      renderer.update(haptics::sample_at({0.0, 0.0, measured}, t), 1.0 / c.rate_hz);
      const haptics::State& state = renderer.state();
      const double told = state.commanded_force_n[2];
      on_the_way.push_back({t + c.delay_s, told});
      if (state.contact != 0 && touched_s < 0.0) {
        touched_s = t;
        result.approach_m_per_s = -velocity;
      }
      if (state.contact != 0) last_contact_s = t;
      if (touched_s >= 0.0) {
        const double spring_j =
            state.stiffness_n_per_m > 0.0 ? 0.5 * state.force_n[2] * state.force_n[2] / state.stiffness_n_per_m : 0.0;
        least_j = std::min(least_j, work_j + spring_j);
        result.given_j = std::max(result.given_j, work_j + spring_j - least_j);
        if (t - last_contact_s < 0.02) result.force_n.push_back(told);
        result.least_n = std::min(result.least_n, told);
        if (told > peak_n) {
          peak_n = told;
          result.peak_s = t - touched_s;
        }
      }
    }
    while (!on_the_way.empty() && on_the_way.front().time_s <= t) {
      held = on_the_way.front().force_n;
      on_the_way.pop_front();
    }
    const double aim = intended(t);
    const double aim_velocity = (intended(t + kStep) - aim) / kStep;
    velocity +=
        (held - c.grip_n_per_m * (z - aim) - c.damping_n_s_per_m * (velocity - aim_velocity)) * (kStep / c.mass_kg);
    z += velocity * kStep;
    work_j += held * velocity * kStep;
  }
  return result;
}

/// Of a signal's energy, everything below included, what lies above a frequency: a plain Fourier sum, padded with
/// zeros.
inline double share_above(const std::vector<double>& signal, double rate_hz, double above_hz) {
  constexpr int kLength = 2048;
  double all = 0.0;
  double high = 0.0;
  for (int bin = 0; bin <= kLength / 2; ++bin) {
    double even = 0.0;
    double odd = 0.0;
    for (std::size_t i = 0; i < signal.size() && i < kLength; ++i) {
      const double angle = 2.0 * std::numbers::pi * bin * static_cast<double>(i) / kLength;
      even += signal[i] * std::cos(angle);
      odd += signal[i] * std::sin(angle);
    }
    const double energy = (even * even + odd * odd) * (bin == 0 || bin == kLength / 2 ? 1.0 : 2.0);
    all += energy;
    if (bin * rate_hz / kLength >= above_hz) high += energy;
  }
  return all > 0.0 ? high / all : 0.0;
}

}  // namespace sparsha::test
