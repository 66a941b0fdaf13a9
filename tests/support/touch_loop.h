// A hand that touches a surface through the renderer, with the delays, rates and losses that a real loop has. Its
// mechanics, its clock and its energy account share no code with the governor or with the simulated device.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "haptics/servo/haptic_renderer.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::test {

enum class Ground : std::uint8_t { plane, sphere, grating, relief };
inline constexpr std::array kGrounds = {Ground::plane, Ground::sphere, Ground::grating, Ground::relief};

inline const char* name_of(Ground ground) {
  constexpr std::array kNames = {"plane", "sphere", "grating", "relief"};
  return kNames[static_cast<std::size_t>(ground)];
}

/// Metres on a square of 0.1 m; device frame = grid frame about its middle.
inline double height_of(Ground ground, double x, double y) {
  const double u = x - 0.05;
  const double v = y - 0.05;
  switch (ground) {
    case Ground::plane:
      return 0.0;
    case Ground::sphere:
      return std::sqrt(0.0064 - std::min(0.0063, u * u + v * v)) - 0.08;
    case Ground::grating:
      return 0.00015 * std::sin(2.0 * std::numbers::pi * u / 0.004);
    case Ground::relief:
      return 0.003 * std::sin(90.0 * u) * std::cos(70.0 * v) + 0.0001 * std::sin(2000.0 * u) * std::sin(1700.0 * v);
  }
  return 0.0;
}

/// The least damping of hand and device that the test's device states, N s/m.
inline constexpr double kStatedDamping = 2.0;

/// The largest stiffness that docs/touch.md ("Governor") allows in a loop as planned: 0.8 of where a wall that answers
/// the delay and half a period late takes all of the damping.
inline double limit_n_per_m(double rate_hz, int declared_ticks = 1, double damping_n_s_per_m = kStatedDamping) {
  const double delay_s = std::max(declared_ticks / rate_hz, 0.001);
  return 0.8 * damping_n_s_per_m / (0.5 / rate_hz + delay_s);
}

/// What a vendor's service does to a force on its way to the motors. Its pages tell the order (gate, then damping) and
/// the settings, not when the gate closes: here when the hand turns back thrice within a tenth of a second, by more
/// than 0.1 mm each time, and for a tenth of a second after that.
struct ServiceFilters {
  double gate_gain = 1.0;          ///< of the force while the gate is closed; 1: no gate
  double damping_n_s_per_m = 0.0;  ///< against the hand's velocity as the service samples it
};

class ForceGate {
 public:
  /// The hand's place along an axis.
  void see(double time_s, double place_m) {
    constexpr double kSwing_m = 1e-4;
    constexpr double kWithin_s = 0.1;
    reach_m_ = rising_ ? std::max(reach_m_, place_m) : std::min(reach_m_, place_m);
    if (std::abs(place_m - reach_m_) > kSwing_m) {
      rising_ = !rising_;
      reach_m_ = place_m;
      turns_s_ = {turns_s_[1], turns_s_[2], time_s};
      if (turns_s_[2] - turns_s_[0] < kWithin_s) closed_until_s_ = time_s + kWithin_s;
    }
  }
  [[nodiscard]] bool closed(double time_s) const { return time_s < closed_until_s_; }

 private:
  double reach_m_ = 0.0, closed_until_s_ = -1.0;
  std::array<double, 3> turns_s_{-10.0, -5.0, -1.0};
  bool rising_ = false;
};

/// How the loop really is, and what the device says of itself.
struct TouchCase {
  Ground ground = Ground::plane;
  bool stroke = false;           ///< else hold
  double strike_m_per_s = 0.0;   ///< > 0: a blow at this speed instead of a gentle approach
  double mass_kg = 0.15;         ///< of hand and device
  double damping_n_s_per_m = 2;  ///< towards the intended place
  double grip_n_per_m = 300.0;   ///< the spring that the hand is
  double wish_n_per_m = 800.0;
  double rate_hz = 1000.0;        ///< real
  double configured_hz = 1000.0;  ///< planned
  double jitter_s = 0.0;          ///< a tick comes late by up to so much
  double lost = 0.0;              ///< share of ticks without news of the hand
  bool told_lost = false;         ///< they come as samples that are not fresh; else not at all
  double sample_hz = 0.0;         ///< > 0: the device looks at the hand so often and repeats what it saw in between
  double sample_jitter = 0.0;     ///< of the time between two looks, one comes later or earlier by up to this share
  double stops_s = 1e9;           ///< from then on it looks no more
  double delay_s = 0.001;         ///< from the writing of a force to the hand
  int declared_ticks = 1;         ///< what the device says of that
  double told_delay_s = 0.0;      ///< what it says that it measures of that, in each sample; 0: nothing
  bool governed = true;           ///< else the wished spring reaches the hand, up to 8 N
  double duration_s = 10.0;
  double encoder_step_m = 20e-6;
  std::uint64_t seed = 1;
  std::optional<haptics::DeviceInfo> device;  ///< else the test's own
  std::optional<ServiceFilters> service;      ///< between loop and motors
};

struct TouchResult {
  /// Most that reached the hand beyond what the spring held then, as the motors had it, from any moment on.
  double reached_j = 0.0;
  double gated = 0.0;         ///< share of the ticks in contact in which the service's gate was closed
  double delivered_j = 0.0;   ///< most that the hand got beyond what the spring gave back, from any moment on
  double swing_m = 0.0;       ///< of the hand along z over the last two seconds
  double calm_s = -1.0;       ///< strikes: when the last swing of more than three encoder steps ended, after contact
  double altered = 0.0;       ///< share of ticks in contact whose force is off by more than 1 % of wish * depth
  double static_share = 0.0;  ///< mean force over governed stiffness * depth in the last second
  double stiffness_n_per_m = 0.0;
  bool fault = false;  ///< a gap of over 10 ms in contact: force ends until the hand has been in the air
};

/// Sees each tick: what the renderer was given and what it made of it.
using TickWatcher = std::function<void(const haptics::DeviceSample&, const haptics::Record&)>;

/// What the device says of itself.
inline haptics::DeviceInfo device_of(const TouchCase& c) {
  if (c.device) return *c.device;
  haptics::DeviceInfo info;
  info.name = "test hand";
  info.limits.delay_ticks = c.declared_ticks;
  info.limits.least_damping_n_s_per_m = kStatedDamping;
  // A loop that is as it says can say so.
  if (c.delay_s <= c.declared_ticks / c.configured_hz + 1e-9) info.limits.undeclared_s = 0.0;
  return info;
}

/// One run on a window of 0.1 m, whose renderer `prepare` is shown first. A run of ten seconds takes some 30 ms.
inline TouchResult touch(const TouchCase& c, haptics::HapticWindow window, const TickWatcher& watch = {},
                         const std::function<void(haptics::HapticRenderer&)>& prepare = {}) {
  using Eigen::Vector3d;
  constexpr double kStep = 20e-6;
  const haptics::DeviceInfo info = device_of(c);
  haptics::RendererOptions options;
  options.rate_hz = c.configured_hz;
  options.stiffness_n_per_m = c.wish_n_per_m;
  haptics::HapticRenderer renderer(info, options, std::move(window));
  if (prepare) prepare(renderer);
  const double governed_n_per_m = std::min(
      c.wish_n_per_m, limit_n_per_m(c.configured_hz, info.limits.delay_ticks, info.limits.least_damping_n_s_per_m));

  const auto floor_m = [&](double x, double y) {
    return height_of(c.ground, x + 0.05, y + 0.05) - height_of(c.ground, 0.05, 0.05);
  };
  // Presses with about a newton, however soft the wall; the intended place follows the coarse shape under the hand.
  const double depth_m = 1.0 / c.grip_n_per_m + std::min(0.005, 1.0 / governed_n_per_m);
  const auto shape_m = [&](double x, double y) { return c.ground == Ground::grating ? 0.0 : floor_m(x, y); };
  const auto intended = [&](double t) -> Vector3d {
    constexpr double kHover = 0.01;
    constexpr double kBegin = 0.15;
    Vector3d place = Vector3d::Zero();
    if (c.strike_m_per_s > 0.0) {
      const double way = std::min(kHover + depth_m, c.strike_m_per_s * std::max(0.0, t - kBegin));
      place.z() = kHover - way;
      return place;
    }
    const double s = std::clamp((t - kBegin) / 0.8, 0.0, 1.0);
    const double share = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);  // minimum jerk
    if (c.stroke && t > 1.5) {
      const double w = t - 1.5;
      const double begin = std::min(1.0, w);
      place.x() = begin * 0.02 * std::sin(2.0 * std::numbers::pi * 0.45 * w);
      place.y() = begin * 0.01 * std::sin(2.0 * std::numbers::pi * 0.31 * w);
    }
    place.z() = kHover - share * (kHover + depth_m) + share * shape_m(place.x(), place.y());
    return place;
  };

  std::mt19937_64 random(c.seed);
  const auto uniform = [&] { return std::generate_canonical<double, 53>(random); };
  struct Force {
    double time_s;
    Vector3d force_n;
  };
  std::deque<Force> on_the_way;
  Vector3d held = Vector3d::Zero();
  Vector3d position = intended(0.0);
  Vector3d velocity = Vector3d::Zero();
  Vector3d measured = position;
  const auto see = [&] {
    for (int axis = 0; axis < 3; ++axis)
      measured[axis] = c.encoder_step_m * std::round(position[axis] / c.encoder_step_m);
  };
  ForceGate gate;
  double share = 1.0;  // of the command that the gate let through
  std::uint64_t gated = 0;
  double stored_least_j = std::numeric_limits<double>::infinity();
  TouchResult result;
  double work_j = 0.0;
  double least_j = std::numeric_limits<double>::infinity();
  double low = 1.0;
  double high = -1.0;
  std::uint64_t ticks = 0;
  std::uint64_t altered = 0;
  double force_sum = 0.0;
  double wanted_sum = 0.0;
  double touched_s = -1.0;
  // Strikes: extremes of the last 100 ms tell whether the hand still swings.
  std::deque<std::array<double, 2>> recent;
  std::uint64_t planned = 0;
  double next_tick_s = 0.0;
  std::uint64_t looks = 0;
  double next_look_s = 0.0;
  bool looked = false;  // since the last tick
  for (std::uint64_t step = 0; static_cast<double>(step) * kStep < c.duration_s; ++step) {
    const double t = static_cast<double>(step) * kStep;
    if (c.sample_hz > 0.0 && t >= next_look_s && t < c.stops_s) {
      if (uniform() >= c.lost) {
        see();
        looked = true;
      }
      next_look_s = (static_cast<double>(++looks) + c.sample_jitter * (2.0 * uniform() - 1.0)) / c.sample_hz;
    }
    if (t >= next_tick_s) {
      const bool repeated = c.sample_hz > 0.0;
      const bool lost = repeated ? !std::exchange(looked, false) : uniform() < c.lost;
      if (!lost || repeated || c.told_lost) {
        if (!lost && !repeated) see();
        haptics::DeviceSample sample = haptics::sample_at(measured, t);
        sample.fresh = !lost;
        sample.delay_s = c.told_delay_s;
        renderer.update(sample, 1.0 / c.configured_hz);
        if (watch) watch(sample, renderer.record());
        const haptics::State& state = renderer.state();
        const Vector3d told(state.commanded_force_n[0], state.commanded_force_n[1], state.commanded_force_n[2]);
        const Vector3d rendered(state.force_n[0], state.force_n[1], state.force_n[2]);
        const double stiffness = renderer.state().stiffness_n_per_m;
        Vector3d sent = told;
        if (!c.governed) {
          const double length = rendered.norm();
          const double whole = stiffness > 0.0 ? c.wish_n_per_m / stiffness : 0.0;
          sent = length > 0.0 ? Vector3d(rendered * std::min(whole, 8.0 / length)) : Vector3d::Zero();
        }
        on_the_way.push_back({t + c.delay_s, sent});
        result.stiffness_n_per_m = stiffness;
        const double spring_j = stiffness > 0.0 ? 0.5 * rendered.squaredNorm() / stiffness : 0.0;
        if (state.contact != 0 && touched_s < 0.0) touched_s = t;
        result.fault = result.fault || (touched_s >= 0.0 && (state.flags & haptics::kFlagFault) != 0);
        if (touched_s >= 0.0) {
          least_j = std::min(least_j, work_j + spring_j);
          result.delivered_j = std::max(result.delivered_j, work_j + spring_j - least_j);
          stored_least_j = std::min(stored_least_j, work_j + share * spring_j);
          result.reached_j = std::max(result.reached_j, work_j - stored_least_j);
        }
        if (state.contact != 0) {
          ++ticks;
          if (share < 1.0) ++gated;
          const Vector3d wanted =
              stiffness > 0.0 ? Vector3d(rendered * (governed_n_per_m / stiffness)) : Vector3d::Zero();
          if ((told - wanted).norm() > 0.01 * wanted.norm() + 1e-3) ++altered;
          if (t > c.duration_s - 1.0) {
            force_sum += told.norm();
            wanted_sum += wanted.norm();
          }
        }
      }
      // The next planned tick that is still to come, late by chance.
      const double period = 1.0 / c.rate_hz;
      do ++planned;
      while (static_cast<double>(planned) * period <= t);
      next_tick_s = static_cast<double>(planned) * period + c.jitter_s * uniform();
    }
    while (!on_the_way.empty() && on_the_way.front().time_s <= t) {
      held = on_the_way.front().force_n;
      on_the_way.pop_front();
      if (c.service) {
        gate.see(t, position.z());
        share = gate.closed(t) ? c.service->gate_gain : 1.0;
        held = share * held - c.service->damping_n_s_per_m * velocity;
      }
    }
    const Vector3d place = intended(t);
    const Vector3d place_velocity = (intended(t + kStep) - place) / kStep;
    const Vector3d pull =
        held - c.grip_n_per_m * (position - place) - c.damping_n_s_per_m * (velocity - place_velocity);
    velocity += pull * (kStep / c.mass_kg);
    position += velocity * kStep;
    work_j += held.dot(velocity) * kStep;
    if (t > c.duration_s - 2.0) {
      low = std::min(low, position.z());
      high = std::max(high, position.z());
    }
    if (c.strike_m_per_s > 0.0 && touched_s >= 0.0 && step % 50 == 0) {
      recent.push_back({t, position.z()});
      while (recent.front()[0] < t - 0.15) recent.pop_front();
      double least = 1.0;
      double most = -1.0;
      for (const auto& [when, z] : recent) least = std::min(least, z), most = std::max(most, z);
      if (most - least > 3.0 * c.encoder_step_m) result.calm_s = t - 0.15 - touched_s;
    }
  }
  result.swing_m = high - low;
  result.gated = ticks > 0 ? static_cast<double>(gated) / static_cast<double>(ticks) : 0.0;
  result.altered = ticks > 0 ? static_cast<double>(altered) / static_cast<double>(ticks) : 0.0;
  result.static_share = wanted_sum > 0.0 ? force_sum / wanted_sum : 0.0;
  return result;
}

/// `scene`: of make_ground().
inline TouchResult touch(const TouchCase& c, const scene::ScenePointer& scene, const TickWatcher& watch = {}) {
  return touch(c, haptics::window_on(scene, 0, 1, false), watch);
}

inline scene::ScenePointer make_ground(Ground ground) {
  return scene_of([ground](double x, double y) { return height_of(ground, x, y); }, 401, 0.1, 401);
}

}  // namespace sparsha::test
