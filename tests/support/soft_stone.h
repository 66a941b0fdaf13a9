// A hand deep in stone that gives it no force: fresh news came too late while it pressed, and it has not been in the
// air since. Made by the renderer itself, so that each consumer of its State is asked about the same thing.
#pragma once

#include <utility>

#include "haptics/servo/haptic_renderer.h"
#include "tests/support/servo_parts.h"

namespace sparsha::test {

class SoftStone {
 public:
  /// Raw forces beyond this are what nobody but a trace may show, newtons.
  static constexpr double kRaw_n = 10.0;

  explicit SoftStone(haptics::HapticWindow window)
      : renderer_(haptics::DeviceInfo{}, haptics::RendererOptions{}, std::move(window)) {
    for (int k = 0; k < 100; ++k) go({0.0, 0.0, 0.02});
    for (int k = 0; k < 400; ++k) go({0.0, 0.0, 0.0001 * (200 - k)});
    felt_ = renderer_.state();
    for (int k = 0; k < 30; ++k) go({0.0, 0.0, kDepth_m}, false);
    for (int k = 0; k < 100; ++k) go({0.0, 0.0, kDepth_m});
  }

  /// A millisecond later at another place, device frame.
  const haptics::State& go(const Eigen::Vector3d& place_m, bool fresh = true) {
    haptics::DeviceSample sample = haptics::sample_at(place_m, 0.001 * static_cast<double>(++tick_));
    sample.fresh = fresh;
    renderer_.update(sample, 0.001);
    return renderer_.state();
  }
  /// Along x, as deep as before.
  const haptics::State& stroke(double x_m) { return go({x_m, 0.0, kDepth_m}); }

  [[nodiscard]] const haptics::State& state() { return renderer_.state(); }
  /// Before the news stayed away: with the device's whole force.
  [[nodiscard]] const haptics::State& felt() const { return felt_; }
  haptics::HapticRenderer& renderer() { return renderer_; }

 private:
  static constexpr double kDepth_m = -0.02;  // 16 N at 800 N/m

  haptics::HapticRenderer renderer_;
  haptics::State felt_;
  std::uint64_t tick_ = 0;
};

}  // namespace sparsha::test
