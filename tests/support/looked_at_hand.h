// A hand that a device looks at more seldom than the loop asks: in between the device repeats what it saw and calls it
// new. Mechanics (fourth order Runge-Kutta), looks and energy account are its own, and it knows the stone by formula.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "haptics/servo/haptic_renderer.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::test {

enum class Doing : std::uint8_t { resting, stroking, striking };

/// What is asked of a hand, and how it is looked at.
struct LookedAt {
  Doing doing = Doing::resting;
  double look_hz = 1000.0;
  double look_jitter = 0.0;  ///< of the time between two looks
  double lost = 0.0;         ///< share of the looks
  double step_m = 20e-6;     ///< of the encoder, each axis
  double loop_hz = 1000.0;
  double loop_jitter_s = 0.0;
  double mass_kg = 0.15;
  double damping_n_s_per_m = 2.0;
  double approach_m_per_s = 0.03;
  double tremor_m = 20e-6;  ///< at 9 Hz
  double seconds = 10.0;
  double undeclared_s = 0.002;
  bool says_so = false;  ///< repeats are told as such
  std::uint32_t seed = 1;

  [[nodiscard]] std::string words() const {
    constexpr std::array kDoing = {"rests", "strokes", "strikes"};
    return fmt::format("{} at {:.0f} Hz, jitter {:.2f}, lost {:.2f}, step {:.0f} um, {} kg, {} N s/m, seed {}",
                       kDoing[static_cast<std::size_t>(doing)], look_hz, look_jitter, lost, 1e6 * step_m, mass_kg,
                       damping_n_s_per_m, seed);
  }
};

struct Felt {
  double got_j = 0.0;    ///< most that the hand got beyond what the spring lost, from any moment of contact on
  double swing_m = 0.0;  ///< of the hand's depth in the last second
  double mean_n = 0.0;   ///< force in the last second
  double stiffness_n_per_m = 0.0;
  std::uint64_t repeated = 0;  ///< ticks that were found to be repeats
};

/// Waves of 3 mm over 70 mm, or a plane.
struct Stone {
  bool waves = false;
  [[nodiscard]] double height_m(double x, double y) const {
    return waves ? 0.003 * std::sin(90.0 * x) * std::cos(70.0 * y) : 0.0;
  }
  /// Of a point, below the tangent plane of the stone over it; zero outside.
  [[nodiscard]] double depth_m(const Eigen::Vector3d& p) const {
    const double dz = height_m(p.x(), p.y()) - p.z();
    if (!waves || dz <= 0.0) return std::max(0.0, dz);
    const double across = 0.27 * std::cos(90.0 * p.x()) * std::cos(70.0 * p.y());
    const double along = -0.21 * std::sin(90.0 * p.x()) * std::sin(70.0 * p.y());
    return dz / std::sqrt(1.0 + across * across + along * along);
  }
  /// 0.1 m wide; the device's origin is its middle.
  [[nodiscard]] scene::ScenePointer scene() const {
    return scene_of([stone = *this](double x, double y) { return stone.height_m(x - 0.05, y - 0.05); }, 401, 0.1, 401);
  }
};

using LookWatcher = std::function<void(const haptics::DeviceSample&, const haptics::Record&)>;

class LookedAtHand {
 public:
  LookedAtHand(const LookedAt& how, const Stone& stone) : how_(how), stone_(stone), random_(how.seed) {
    for (double& phase : phases_m_) phase = how_.step_m * chance();
    place_ = wish_m(0.0);
  }

  [[nodiscard]] Felt run(const scene::ScenePointer& scene, const LookWatcher& watch = {}) {
    haptics::DeviceInfo device;
    device.limits.undeclared_s = how_.undeclared_s;
    haptics::HapticRenderer renderer(device, haptics::RendererOptions{}, haptics::window_on(scene, 0, 1, false));
    double next_tick_s = 0.0;
    double next_look_s = 0.0;
    std::uint64_t looks = 0;
    std::uint64_t ticks = 0;
    Eigen::Vector3d seen = as_seen();
    std::uint64_t steps = 0;
    bool looked = false;  // since the last tick
    for (double t = 0.0; t < how_.seconds; t = kStep_s * static_cast<double>(++steps)) {
      if (t >= next_look_s) {
        if (chance() >= how_.lost) {
          seen = as_seen();
          looked = true;
        }
        next_look_s = (static_cast<double>(++looks) + how_.look_jitter * (2.0 * chance() - 1.0)) / how_.look_hz;
      }
      if (t >= next_tick_s) {
        haptics::DeviceSample sample = haptics::sample_at(seen, t);
        sample.fresh = std::exchange(looked, false) || !how_.says_so;
        renderer.update(sample, 1.0 / how_.loop_hz);
        if (watch) watch(sample, renderer.record());
        const auto& f = renderer.state().commanded_force_n;
        coming_.push_back({t + kDelay_s, {f[0], f[1], f[2]}});
        next_tick_s = static_cast<double>(++ticks) / how_.loop_hz + how_.loop_jitter_s * chance();
        if (t > how_.seconds - 1.0) forces_n_ += coming_.back().force_n.norm() / how_.loop_hz;
        if ((renderer.state().flags & haptics::kFlagRepeated) != 0) ++felt_.repeated;
      }
      while (!coming_.empty() && coming_.front().time_s <= t) {
        held_n_ = coming_.front().force_n;
        coming_.pop_front();
      }
      step(t);
      count(t, renderer.state().stiffness_n_per_m);
    }
    felt_.stiffness_n_per_m = renderer.state().stiffness_n_per_m;
    felt_.swing_m = std::max(0.0, highest_m_ - lowest_m_);
    felt_.mean_n = forces_n_;
    return felt_;
  }

 private:
  struct Coming {
    double time_s;
    Eigen::Vector3d force_n;
  };
  static constexpr double kStep_s = 50e-6;
  static constexpr double kDelay_s = 0.001;
  static constexpr double kGrip_n_per_m = 300.0;
  static constexpr double kAbove_m = 0.012;

  double chance() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }

  [[nodiscard]] Eigen::Vector3d as_seen() const {
    Eigen::Vector3d seen;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double phase_m = phases_m_[static_cast<std::size_t>(k)];
      seen[k] = how_.step_m * std::floor((place_[k] + phase_m) / how_.step_m);
    }
    return seen;
  }

  /// Where the person wants the hand to be: down to where the grip's spring presses with a newton, with a tremor.
  [[nodiscard]] Eigen::Vector3d wish_m(double t) const {
    const double speed = how_.doing == Doing::striking ? 0.3 : how_.approach_m_per_s;
    const double below_m = 1.0 / kGrip_n_per_m + 0.0015;
    Eigen::Vector3d wish = Eigen::Vector3d::Zero();
    if (how_.doing == Doing::stroking && t > 1.0) {
      const double since = t - 1.0;
      wish.x() = 0.025 * std::min(1.0, since) * std::sin(2.0 * std::numbers::pi * 0.5 * since);
      wish.y() = 0.015 * std::min(1.0, since) * std::sin(2.0 * std::numbers::pi * 0.37 * since);
    }
    const double down = std::clamp(speed * (t - 0.2) / (kAbove_m + below_m), 0.0, 1.0);
    const double share = how_.doing == Doing::striking ? down : down * down * (3.0 - 2.0 * down);
    wish.z() = kAbove_m - share * (kAbove_m + below_m) + share * stone_.height_m(wish.x(), wish.y());
    wish.z() += how_.tremor_m * std::sin(2.0 * std::numbers::pi * 9.0 * t);
    return wish;
  }

  void step(double t) {
    using Pair = std::array<Eigen::Vector3d, 2>;  // place, velocity
    const auto slope = [&](double when, const Pair& at) -> Pair {
      constexpr double kShort_s = 1e-5;
      const Eigen::Vector3d wish = wish_m(when);
      const Eigen::Vector3d wish_m_per_s = (wish_m(when + kShort_s) - wish) / kShort_s;
      return {at[1], Eigen::Vector3d(
                         (held_n_ - kGrip_n_per_m * (at[0] - wish) - how_.damping_n_s_per_m * (at[1] - wish_m_per_s)) /
                         how_.mass_kg)};
    };
    const auto plus = [](const Pair& at, const Pair& by, double dt) -> Pair {
      return {Eigen::Vector3d(at[0] + dt * by[0]), Eigen::Vector3d(at[1] + dt * by[1])};
    };
    const Pair from = {place_, speed_};
    const Pair a = slope(t, from);
    const Pair b = slope(t + 0.5 * kStep_s, plus(from, a, 0.5 * kStep_s));
    const Pair c = slope(t + 0.5 * kStep_s, plus(from, b, 0.5 * kStep_s));
    const Pair d = slope(t + kStep_s, plus(from, c, kStep_s));
    const Eigen::Vector3d before = place_;
    place_ += kStep_s / 6.0 * (a[0] + 2.0 * b[0] + 2.0 * c[0] + d[0]);
    speed_ += kStep_s / 6.0 * (a[1] + 2.0 * b[1] + 2.0 * c[1] + d[1]);
    work_j_ += held_n_.dot(place_ - before);
  }

  void count(double t, double stiffness_n_per_m) {
    const double depth_m = stone_.depth_m(place_);
    const double stored_j = 0.5 * stiffness_n_per_m * depth_m * depth_m;
    if (!touched_ && depth_m > 0.0) touched_ = true;
    if (touched_) {
      least_j_ = std::min(least_j_, work_j_ + stored_j);
      felt_.got_j = std::max(felt_.got_j, work_j_ + stored_j - least_j_);
    }
    if (t < how_.seconds - 1.0) return;
    lowest_m_ = std::min(lowest_m_, place_.z());
    highest_m_ = std::max(highest_m_, place_.z());
  }

  LookedAt how_;
  Stone stone_;
  std::mt19937 random_;
  std::array<double, 3> phases_m_{};
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d speed_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d held_n_ = Eigen::Vector3d::Zero();
  std::deque<Coming> coming_;
  bool touched_ = false;
  double work_j_ = 0.0;
  double least_j_ = std::numeric_limits<double>::infinity();
  double lowest_m_ = 1.0;
  double highest_m_ = -1.0;
  double forces_n_ = 0.0;
  Felt felt_;
};

}  // namespace sparsha::test
