// A hand at rest on a surface while the surface is exchanged under it: how far the force steps and turns each tick and
// when it is calm. Its mechanics share no code with the renderer, the governor or the simulated device.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "haptics/servo/haptic_renderer.h"
#include "tests/support/servo_parts.h"

namespace sparsha::test {

struct RestingHand {
  double mass_kg = 0.15;
  double grip_n_per_m = 800.0;
  double damping_n_s_per_m = 8.0;
  double rate_hz = 1000.0;
  double wish_n_per_m = 800.0;
  double planned_hz = 0.0;  ///< of the servo; 0: as the real rate
};

/// Largest step and turn of the commanded force from one tick to the next after a swap.
struct SwapResult {
  double step_n = 0.0;
  double turn_deg = 0.0;   ///< where the force can be felt at all, before and after
  double settled_s = 0.0;  ///< from then on within 0.05 N of where the force ends
  double before_n = 0.0;
  double change_n = 0.0;  ///< from before the swap to the end
};

class HandAtRest {
 public:
  HandAtRest(const RestingHand& hand, haptics::HapticWindow window, haptics::RendererOptions options = {})
      : hand_(hand), renderer_(haptics::DeviceInfo{}, with(options, hand), std::move(window)) {}

  haptics::HapticRenderer& renderer() { return renderer_; }

  /// Puts the hand down at (x, y), device frame, with about `press_n`, and lets it come to rest.
  void put_down(double x_m, double y_m, double press_n) {
    intended_m_ = position_m_ = {x_m, y_m, 0.03};
    run(0.1);
    // Straight down until the surface carries half of the press, then on until all of it.
    for (int i = 0; i < 20'000 && force().norm() < press_n; ++i) {
      intended_m_.z() -= 0.00002;
      run(1.0 / hand_.rate_hz);
    }
    run(1.5);
  }

  /// Lets time pass; every tick is passed to `watch`.
  void run(double duration_s, const std::function<void(double)>& watch = {}) {
    constexpr double kStep = 20e-6;
    const auto steps = static_cast<int>(std::lround(duration_s / kStep));
    const auto per_tick = static_cast<int>(std::lround(1.0 / (hand_.rate_hz * kStep)));
    for (int i = 0; i < steps; ++i) {
      if (step_++ % static_cast<std::uint64_t>(per_tick) == 0) {
        held_n_ = told_n_;  // a tick on its way
        renderer_.update(haptics::sample_at(position_m_, static_cast<double>(step_) * kStep), 1.0 / planned_hz(hand_));
        told_n_ = force();
        if (watch) watch(static_cast<double>(i) * kStep);
      }
      const Eigen::Vector3d pull =
          held_n_ - hand_.grip_n_per_m * (position_m_ - intended_m_) - hand_.damping_n_s_per_m * velocity_;
      velocity_ += pull * (kStep / hand_.mass_kg);
      position_m_ += velocity_ * kStep;
      work_j_ += held_n_.dot(velocity_) * kStep;
    }
  }

  [[nodiscard]] Eigen::Vector3d force() const {
    const auto& f = renderer_.state().commanded_force_n;
    return {f[0], f[1], f[2]};
  }

  /// Done on the hand by the force so far.
  [[nodiscard]] double work_j() const { return work_j_; }

  /// Carries out `swap` and watches for half a second.
  SwapResult swap(const std::function<void(haptics::HapticRenderer&)>& exchange) {
    SwapResult result;
    result.before_n = force().norm();
    const Eigen::Vector3d before = force();
    Eigen::Vector3d last = before;
    std::vector<std::pair<double, Eigen::Vector3d>> forces;
    exchange(renderer_);
    run(0.5, [&](double t) {
      const Eigen::Vector3d now = force();
      result.step_n = std::max(result.step_n, (now - last).norm());
      constexpr double kFelt = 0.05;
      if (now.norm() > kFelt && last.norm() > kFelt) {
        const double cosine = std::clamp(now.normalized().dot(last.normalized()), -1.0, 1.0);
        result.turn_deg = std::max(result.turn_deg, std::acos(cosine) * 180.0 / std::numbers::pi);
      }
      last = now;
      forces.emplace_back(t, now);
    });
    Eigen::Vector3d end = Eigen::Vector3d::Zero();
    const auto tail = static_cast<std::ptrdiff_t>(forces.size() / 10);
    for (auto it = forces.end() - tail; it != forces.end(); ++it) end += it->second / static_cast<double>(tail);
    for (const auto& [t, f] : forces)
      if ((f - end).norm() > 0.05) result.settled_s = t + 1.0 / hand_.rate_hz;
    result.change_n = (end - before).norm();
    return result;
  }

 private:
  static double planned_hz(const RestingHand& hand) { return hand.planned_hz > 0.0 ? hand.planned_hz : hand.rate_hz; }
  static haptics::RendererOptions with(haptics::RendererOptions options, const RestingHand& hand) {
    options.rate_hz = planned_hz(hand);
    options.stiffness_n_per_m = hand.wish_n_per_m;
    return options;
  }

  RestingHand hand_;
  haptics::HapticRenderer renderer_;
  Eigen::Vector3d intended_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d told_n_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d held_n_ = Eigen::Vector3d::Zero();
  double work_j_ = 0.0;
  std::uint64_t step_ = 0;
};

}  // namespace sparsha::test
