// A renderer that a test moves tick by tick.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include <Eigen/Core>

#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/window.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {

inline constexpr double kPeriod_s = 0.001;
inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

inline Eigen::Vector3d vector_of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// A renderer with a clock.
class TimedHand {
 public:
  explicit TimedHand(HapticWindow window, RendererOptions options = {})
      : renderer(DeviceInfo{}, options, std::move(window)) {}
  const State& go(const Eigen::Vector3d& device_m) {
    renderer.update(sample_at(device_m, kPeriod_s * static_cast<double>(tick_++)), kPeriod_s);
    return renderer.state();
  }
  const State& go(DeviceSample sample) {
    sample.time_s = kPeriod_s * static_cast<double>(tick_++);
    renderer.update(sample, kPeriod_s);
    return renderer.state();
  }
  /// 60 ms in the air arm the governor.
  void arm() {
    for (int i = 0; i < 60; ++i) go({0.0, 0.0, 0.02});
  }
  /// Slowly to a place, so that the slew limit does not show.
  const State& press(const Eigen::Vector3d& device_m, int ticks = 200) {
    const Eigen::Vector3d from = vector_of(renderer.state().device_m);
    for (int i = 1; i <= ticks; ++i) go(Eigen::Vector3d(from + (device_m - from) * (static_cast<double>(i) / ticks)));
    for (int i = 0; i < 20; ++i) go(device_m);
    return renderer.state();
  }

  HapticRenderer renderer;

 private:
  std::uint64_t tick_ = 0;
};

}  // namespace sparsha::haptics
