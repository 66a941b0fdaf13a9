// The price of a delay that is assumed and not there: how soft the wall becomes under hands that stroke gratings.
#include "bench/haptics/softened.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "base/threads/thread_pool.h"
#include "bench/haptics/free_hand.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/window.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

struct Grating {
  double period_m, height_m;
};
constexpr std::array<Grating, 6> kGratings{
    {{0.001, 40e-6}, {0.002, 75e-6}, {0.004, 150e-6}, {0.006, 250e-6}, {0.010, 400e-6}, {0.020, 1000e-6}}};
constexpr std::array kUndeclared_s{0.0, 0.0007, 0.001, 0.002};
constexpr std::array kSpeeds_m_per_s{0.02, 0.05, 0.1};
constexpr std::array kDelays_s{0.001, 0.0017};
constexpr double kEncoder_m = 20e-6;

/// Share of the wished stiffness at the end of ten seconds of strokes of 20 mm. The loop is as late as the device
/// measures.
double share_left(const haptics::HapticWindow& window, double speed_m_per_s, double delay_s, double undeclared_s) {
  haptics::DeviceInfo device;
  device.limits.undeclared_s = undeclared_s;
  haptics::RendererOptions options;
  haptics::HapticRenderer renderer(device, options, window);
  const double wish = std::min(options.stiffness_n_per_m, haptics::stiffness_limit(device.limits, 0.001, delay_s));
  FreeHand hand;
  hand.delay_s = delay_s;
  const double depth_m = 1.0 / hand.grip_n_per_m + 1.0 / wish;
  const auto wanted = [&](double t) -> Vector3d {
    const double s = std::clamp((t - 0.15) / 0.8, 0.0, 1.0);
    const double z = 0.005 - s * s * (3.0 - 2.0 * s) * (0.005 + depth_m);
    if (t < 1.5) return {0.0, 0.0, z};
    const double way = speed_m_per_s * (t - 1.5);
    return {0.01 * std::asin(std::sin(std::numbers::pi * way / 0.02)) / (0.5 * std::numbers::pi), 0.0, z};
  };
  hand.position_m = wanted(0.0);
  double softest = 1.0;
  for (int tick = 0; tick < 11'500; ++tick) {
    const double t = 0.001 * tick;
    hand.go_on(t, wanted(t), wanted(t + 0.001));
    const Vector3d read_m = (hand.position_m / kEncoder_m).array().round() * kEncoder_m;
    haptics::DeviceSample sample = haptics::sample_at(read_m, t + 0.001);
    sample.delay_s = delay_s;
    renderer.update(sample, 0.001);
    const haptics::State& state = renderer.state();
    hand.write({state.commanded_force_n[0], state.commanded_force_n[1], state.commanded_force_n[2]}, t + 0.001);
    if (tick > 1'500) softest = std::min(softest, state.stiffness_n_per_m / wish);
  }
  return softest;
}

haptics::HapticWindow window_on(const Grating& grating) {
  return haptics::window_on(test::scene_of(
                                [&grating](double x, double) {
                                  return grating.height_m * std::sin(2.0 * std::numbers::pi * x / grating.period_m);
                                },
                                1001, 0.1, 1001),
                            0, 1, false);
}

}  // namespace

bool write_softened() {
  std::printf("| grating mm, height um | strokes m/s | delay ms |");
  for (const double undeclared_s : kUndeclared_s) std::printf(" %.1f ms undeclared |", 1e3 * undeclared_s);
  std::printf("\n| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Grating& grating : kGratings) {
    const haptics::HapticWindow window = window_on(grating);
    for (const double speed_m_per_s : kSpeeds_m_per_s)
      for (const double delay_s : kDelays_s) {
        std::array<double, kUndeclared_s.size()> shares{};
        ThreadPool().for_ranges(shares.size(), 1, [&](std::size_t k, std::size_t) {
          shares[k] = share_left(window, speed_m_per_s, delay_s, kUndeclared_s[k]);
        });
        std::printf("| %.0f, %.0f | %.2f | %.1f |", 1e3 * grating.period_m, 1e6 * grating.height_m, speed_m_per_s,
                    1e3 * delay_s);
        for (const double share : shares) std::printf(" %.2f |", share);
        std::printf("\n");
      }
  }
  return true;
}

}  // namespace sparsha::bench
