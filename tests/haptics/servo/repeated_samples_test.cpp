// A loop of a kilohertz over a device that looks at the hand 100 to 1000 times a second, with jitter and looks that are
// lost, and repeats in between what it saw. The hand, its clock and its energy account (tests/support/touch_loop.h)
// share no code with the governor.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "tests/support/touch_loop.h"

namespace sparsha::test {
namespace {

constexpr double kMost_j = 0.001;  // in nine seconds, a tenth of what any hand may get
constexpr double kRates_hz[] = {100.0, 125.0, 200.0, 250.0, 333.0, 400.0, 500.0, 1000.0};

struct Rest {
  TouchResult result;
  bool ended = false;   ///< the force, in contact, while the device went on
  double end_s = -1.0;  ///< first tick without force after it stopped
  double low_m = 1.0;   ///< of the hand as measured over the last second before it stopped, along z
  double high_m = -1.0;
};

/// Presses a plane with about a newton and rests.
Rest rest(const TouchCase& c, const scene::ScenePointer& plane) {
  Rest rest;
  const double until_s = std::min(c.duration_s, c.stops_s);
  rest.result = touch(c, plane, [&](const haptics::DeviceSample& sample, const haptics::Record& record) {
    const haptics::State& state = record.state;
    const double t = sample.time_s;
    const bool none = state.commanded_force_n[2] == 0.0;
    if (t > 1.5 && t < until_s && none) rest.ended = true;
    if (t >= c.stops_s && none && rest.end_s < 0.0) rest.end_s = t;
    if (t < until_s - 1.0 || t >= until_s) return;
    rest.low_m = std::min(rest.low_m, sample.position_m.z());
    rest.high_m = std::max(rest.high_m, sample.position_m.z());
  });
  return rest;
}

std::string words(const TouchCase& c) {
  char text[200];
  std::snprintf(text, sizeof text, "%.0f Hz, jitter %.0f %%, %.0f %% lost, %.2f kg, %.1f N s/m, seed %d", c.sample_hz,
                100.0 * c.sample_jitter, 100.0 * c.lost, c.mass_kg, c.damping_n_s_per_m, static_cast<int>(c.seed));
  return text;
}

TouchCase at(double sample_hz, double jitter, double lost) {
  TouchCase c;
  c.sample_hz = sample_hz;
  c.sample_jitter = jitter;
  c.lost = lost;
  c.duration_s = 4.0;
  return c;
}

}  // namespace

TEST(RepeatedSamples, ARestingHandIsCarriedAtTheDevicesOwnPace) {
  const scene::ScenePointer plane = make_ground(Ground::plane);
  double worst_j = 0.0;
  double worst_m = 0.0;
  int runs = 0;
  for (const double hz : kRates_hz)
    for (const double jitter : {0.0, 0.2, 0.45})
      for (const double lost : {0.0, 0.1})
        for (const double mass_kg : {0.05, 0.5})
          for (const double damping : {1.0, 10.0}) {
            TouchCase c = at(hz, jitter, lost);
            c.mass_kg = mass_kg;
            c.damping_n_s_per_m = damping;
            c.seed = static_cast<std::uint64_t>(++runs);
            // Until then a heavy hand with little damping has come to rest about its own spring.
            c.duration_s = 9.0;
            const Rest found = rest(c, plane);
            EXPECT_FALSE(found.ended) << words(c);
            EXPECT_LE(found.result.delivered_j, kMost_j) << words(c);
            EXPECT_LE(found.high_m - found.low_m, 3.01 * c.encoder_step_m) << words(c);
            worst_j = std::max(worst_j, found.result.delivered_j);
            worst_m = std::max(worst_m, found.high_m - found.low_m);
          }
  std::printf("%d runs: at most %.2f mJ delivered, %.0f um of swing\n", runs, 1e3 * worst_j, 1e6 * worst_m);
}

TEST(RepeatedSamples, TheForceEndsSevenSamplesAfterTheDeviceStops) {
  const scene::ScenePointer plane = make_ground(Ground::plane);
  for (const double hz : kRates_hz)
    for (const double jitter : {0.0, 0.2, 0.45})
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        TouchCase c = at(hz, jitter, 0.0);
        c.seed = seed;
        c.stops_s = 3.0 + 0.0017 * static_cast<double>(seed);
        c.duration_s = 4.0;
        const Rest found = rest(c, plane);
        ASSERT_FALSE(found.ended) << words(c);
        // Its last look may be older than a period of its by twice the jitter; the median is one of bins of 4.4 %, in
        // whole ticks, and the tick that finds out is one more.
        const double median_s = 1.05 * std::ceil(1000.0 / hz + 0.5) / 1000.0;
        EXPECT_GT(found.end_s, c.stops_s) << words(c);
        EXPECT_LE(found.end_s - c.stops_s, std::max(0.007, 7.0 * median_s) + 0.0011) << words(c);
      }
}

}  // namespace sparsha::test
