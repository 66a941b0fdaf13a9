// Devices of 100 to 4000 Hz that lose samples and say so: a hand that rests goes on being carried. The hand, its clock
// and its energy account (tests/support/touch_loop.h) share no code with the governor.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "tests/support/touch_loop.h"

namespace sparsha::test {
namespace {

constexpr double kMost_j = 0.010;  // in ten seconds
constexpr double kRates_hz[] = {100.0, 200.0, 333.0, 400.0, 500.0, 851.0, 1000.0, 4000.0};

struct Rest {
  TouchResult result;
  bool disarmed = false;  ///< in contact
  double low_m = 1.0;     ///< of the measured hand over the last second, along z
  double high_m = -1.0;
};

/// Presses a plane with about a newton and rests.
Rest rest(const TouchCase& c, const scene::ScenePointer& plane) {
  Rest rest;
  rest.result = touch(c, plane, [&](const haptics::DeviceSample& sample, const haptics::Record& record) {
    const haptics::State& state = record.state;
    if (state.contact != 0 && (state.flags & haptics::kFlagArmed) == 0) rest.disarmed = true;
    if (state.time_s < c.duration_s - 1.0) return;
    rest.low_m = std::min(rest.low_m, sample.position_m.z());
    rest.high_m = std::max(rest.high_m, sample.position_m.z());
  });
  return rest;
}

std::string words(const TouchCase& c) {
  char text[160];
  std::snprintf(text, sizeof text, "%.0f Hz planned %.0f, %.0f %% lost, %.2f kg, %.1f N s/m, seed %d", c.rate_hz,
                c.configured_hz, 100.0 * c.lost, c.mass_kg, c.damping_n_s_per_m, static_cast<int>(c.seed));
  return text;
}

}  // namespace

TEST(SlowSamples, ARestingHandIsCarriedWhateverTheRateWhenOneSampleInTenIsLost) {
  const scene::ScenePointer plane = make_ground(Ground::plane);
  double worst_j = 0.0;
  double worst_m = 0.0;
  int runs = 0;
  for (const double rate_hz : kRates_hz)
    for (const bool planned : {true, false})
      for (const double mass_kg : {0.05, 0.15, 0.5})
        for (const double damping : {1.0, 2.0, 10.0})
          for (std::uint64_t seed = 1; seed <= 2; ++seed) {
            TouchCase c;
            c.rate_hz = rate_hz;
            c.configured_hz = planned ? rate_hz : 1000.0;
            c.lost = 0.1;
            c.told_lost = true;
            c.mass_kg = mass_kg;
            c.damping_n_s_per_m = damping;
            c.seed = seed;
            c.duration_s = 6.0;
            const Rest found = rest(c, plane);
            ++runs;
            EXPECT_FALSE(found.disarmed) << words(c);
            EXPECT_LE(found.result.delivered_j, kMost_j) << words(c);
            EXPECT_LE(found.high_m - found.low_m, 3.0 * c.encoder_step_m) << words(c);
            worst_j = std::max(worst_j, found.result.delivered_j);
            worst_m = std::max(worst_m, found.high_m - found.low_m);
          }
  std::printf("%d runs: at most %.2f mJ delivered, %.0f um of swing\n", runs, 1e3 * worst_j, 1e6 * worst_m);
}

TEST(SlowSamples, AStrokingHandGetsLittleEnergyWhateverTheRateWhenOneSampleInTenIsLost) {
  const scene::ScenePointer relief = make_ground(Ground::relief);
  double worst_j = 0.0;
  for (const double rate_hz : kRates_hz)
    for (const bool planned : {true, false})
      for (const double mass_kg : {0.05, 0.5})
        for (const double damping : {0.3, 2.0}) {
          TouchCase c;
          c.ground = Ground::relief;
          c.stroke = true;
          c.rate_hz = rate_hz;
          c.configured_hz = planned ? rate_hz : 1000.0;
          c.lost = 0.1;
          c.told_lost = true;
          c.mass_kg = mass_kg;
          c.damping_n_s_per_m = damping;
          const TouchResult result = touch(c, relief);
          EXPECT_LE(result.delivered_j, kMost_j) << words(c);
          worst_j = std::max(worst_j, result.delivered_j);
        }
  std::printf("at most %.2f mJ delivered\n", 1e3 * worst_j);
}

TEST(SlowSamples, ThreeSamplesLostInARowTakeNothingFromTheForceOfASlowDevice) {
  const scene::ScenePointer plane = make_ground(Ground::plane);
  for (const double rate_hz : {100.0, 200.0, 333.0, 400.0}) {
    haptics::DeviceInfo info;
    info.limits.delay_ticks = 1;
    info.limits.least_damping_n_s_per_m = kStatedDamping;
    haptics::RendererOptions options;
    options.rate_hz = rate_hz;
    haptics::HapticRenderer renderer(info, options, haptics::window_on(plane, 0, 1, false));
    std::uint64_t tick = 0;
    const auto force_n = [&](double z_m, bool fresh) {
      haptics::DeviceSample sample =
          haptics::sample_at(Eigen::Vector3d(0, 0, z_m), static_cast<double>(tick++) / rate_hz);
      sample.fresh = fresh;
      renderer.update(sample, 1.0 / rate_hz);
      return renderer.state().commanded_force_n[2];
    };
    const auto ticks = [&](double seconds) { return static_cast<int>(seconds * rate_hz); };
    for (int k = 0; k < ticks(0.3); ++k) static_cast<void>(force_n(0.01, true));
    double pressed_n = 0.0;
    for (int k = 0; k < ticks(1.0); ++k) pressed_n = force_n(-0.002, true);
    ASSERT_GT(pressed_n, 0.1) << rate_hz;
    for (const int lost : {1, 2, 3, 6}) {
      for (int k = 0; k < lost; ++k) EXPECT_EQ(force_n(-0.002, false), pressed_n) << rate_hz << " Hz, " << k;
      EXPECT_NEAR(force_n(-0.002, true), pressed_n, 1e-9 * pressed_n) << rate_hz << " Hz after " << lost;
    }
    for (int k = 0; k < 8; ++k) static_cast<void>(force_n(-0.002, false));
    EXPECT_EQ(renderer.state().commanded_force_n[2], 0.0) << rate_hz << " Hz: stale";
    for (int k = 0; k < 10; ++k) static_cast<void>(force_n(-0.002, false));
    for (int k = 0; k < 3; ++k) static_cast<void>(force_n(-0.002, true));
    EXPECT_EQ(renderer.state().commanded_force_n[2], 0.0) << rate_hz << " Hz: nobody knew where the hand was";
  }
}

}  // namespace sparsha::test
