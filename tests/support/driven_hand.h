// A hand on a whole object in memory that is where a test tells it to be.
#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/window.h"
#include "tests/support/servo_parts.h"

namespace sparsha::test {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using haptics::Command;
using haptics::HapticRenderer;
using haptics::HapticWindow;
using haptics::State;

inline HapticWindow window_of(const scene::ScenePointer& scene, std::uint64_t id = 1, double workspace_m = 0.1) {
  const scene::SceneDescription& description = scene->description();
  return haptics::load_window(
      *scene,
      haptics::plan_window(description, haptics::overview_level(description), Eigen::Vector2d::Zero(), workspace_m),
      id);
}

inline Vector3d vector(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }
inline Quaterniond turn_of(const State& s) { return {s.turn[3], s.turn[0], s.turn[1], s.turn[2]}; }

inline void turn(HapticRenderer& renderer, const Quaterniond& to) {
  Command command;
  command.kind = Command::Kind::turn;
  command.turn = to;
  static_cast<void>(renderer.apply(command));
}

/// A hand that is where it is told to be.
class Driven {
 public:
  explicit Driven(HapticWindow window)
      : renderer(haptics::DeviceInfo{}, haptics::RendererOptions{}, std::move(window)) {}
  void at(const Vector3d& hand_m) {
    time_s_ += 0.001;
    renderer.update(haptics::sample_at(hand_m, time_s_), 0.001);
    hand_ = hand_m;
  }
  void go(const Vector3d& to, double step_m = 0.0002) {
    const Vector3d from = hand_;
    const int steps = std::max(1, static_cast<int>((to - from).norm() / step_m));
    for (int k = 1; k <= steps; ++k) at(from + (to - from) * (static_cast<double>(k) / steps));
  }
  void stay(int ticks) {
    for (int k = 0; k < ticks; ++k) at(hand_);
  }
  [[nodiscard]] const State& state() const { return renderer.state(); }
  /// Grid frame, as the state of the last tick says it is.
  [[nodiscard]] Vector3d to_grid(const Vector3d& device_m) const {
    return vector(state().centre_m) + turn_of(state()).conjugate() * device_m / state().scale;
  }
  [[nodiscard]] Vector3d to_device(const Vector3d& grid_m) const {
    return state().scale * (turn_of(state()) * (grid_m - vector(state().centre_m)));
  }

  HapticRenderer renderer;

 private:
  Vector3d hand_ = Vector3d(0.0, 0.0, 0.03);
  double time_s_ = 0.0;
};

}  // namespace sparsha::test
