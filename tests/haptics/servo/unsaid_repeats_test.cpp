// A loop of a kilohertz over a device that looks at the hand 100 to 1000 times a second and repeats in between what it
// saw, without saying so.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <vector>

#include "tests/support/looked_at_hand.h"

namespace sparsha::test {
namespace {

constexpr double kMost_j = 0.010;  // in ten seconds

const scene::ScenePointer& scene_on(const Stone& stone) {
  static const scene::ScenePointer kPlane = Stone{false}.scene();
  static const scene::ScenePointer kWaves = Stone{true}.scene();
  return stone.waves ? kWaves : kPlane;
}

Felt feel(const LookedAt& how, const LookWatcher& watch = {}) {
  const Stone stone{how.doing == Doing::stroking};
  return LookedAtHand(how, stone).run(scene_on(stone), watch);
}

bool nightly() { return std::getenv("SPARSHA_NIGHTLY") != nullptr; }

}  // namespace

TEST(UnsaidRepeats, AHandGetsLittleEnergyWhateverTheLooks) {
  struct Worst {
    double got_j = 0.0;
    double swing_steps = 0.0;
    LookedAt how;
  };
  std::map<int, Worst> worst;
  const bool all = nightly();
  const std::vector<double> rates_hz = all ? std::vector{100.0, 125.0, 200.0, 250.0, 333.0, 500.0, 667.0, 851.0, 1000.0}
                                           : std::vector{100.0, 125.0, 200.0};
  std::uint32_t seed = 0;
  for (const double rate_hz : rates_hz)
    for (const double jitter : {0.0, 0.45})
      for (const double step_m : all ? std::vector{1e-6, 20e-6, 60e-6} : std::vector{20e-6})
        for (const double mass_kg : all ? std::vector{0.05, 0.5} : std::vector{0.05})
          for (const double damping : all ? std::vector{0.3, 2.0} : std::vector{0.3})
            for (const Doing doing : {Doing::resting, Doing::stroking, Doing::striking}) {
              LookedAt how;
              how.doing = doing;
              how.look_hz = rate_hz;
              how.look_jitter = jitter;
              how.step_m = step_m;
              how.mass_kg = mass_kg;
              how.damping_n_s_per_m = damping;
              how.seed = ++seed;
              const Felt felt = feel(how);
              EXPECT_LE(felt.got_j, kMost_j) << how.words();
              Worst& of_rate = worst[static_cast<int>(rate_hz) * 3 + static_cast<int>(doing)];
              of_rate.swing_steps = std::max(of_rate.swing_steps, felt.swing_m / step_m);
              if (felt.got_j > of_rate.got_j) of_rate.got_j = felt.got_j, of_rate.how = how;
            }
  for (const auto& [key, found] : worst)
    std::printf("%4d Hz %d: at most %.2f mJ, swing %.1f steps (%s)\n", key / 3, key % 3, 1e3 * found.got_j,
                found.swing_steps, found.how.words().c_str());
}

TEST(UnsaidRepeats, AHandThatRestsKeepsItsForceAndSwingsLittle) {
  for (const double rate_hz : {100.0, 200.0, 500.0})
    for (const double step_m : {1e-6, 20e-6, 60e-6}) {
      LookedAt how;
      how.look_hz = rate_hz;
      how.step_m = step_m;
      how.seconds = 5.0;
      how.tremor_m = 0.0;
      if (how.approach_m_per_s / rate_hz < 2.5 * step_m) continue;  // too coarse to tell a look from a step
      std::uint64_t without_force = 0;
      const Felt felt = feel(how, [&](const haptics::DeviceSample& sample, const haptics::Record& record) {
        if (sample.time_s > 2.0 && record.state.commanded_force_n[2] <= 0.0) ++without_force;
      });
      EXPECT_GT(felt.repeated, 1000U) << how.words();
      EXPECT_EQ(without_force, 0U) << how.words();
      EXPECT_LE(felt.swing_m, std::max(100e-6, 5.0 * step_m)) << how.words();
      how.says_so = true;
      EXPECT_GT(felt.mean_n, 0.9 * feel(how).mean_n) << how.words();
      EXPECT_GT(felt.mean_n, 0.3) << how.words();
    }
}

TEST(UnsaidRepeats, ADeviceThatLooksEachTickHasNone) {
  for (const double step_m : {1e-6, 20e-6, 60e-6})
    for (const double approach_m_per_s : {0.005, 0.03, 0.2})
      for (const Doing doing : {Doing::resting, Doing::stroking, Doing::striking}) {
        LookedAt how;
        how.doing = doing;
        how.step_m = step_m;
        how.approach_m_per_s = approach_m_per_s;
        how.seconds = 4.0;
        EXPECT_EQ(feel(how).repeated, 0U) << how.words();
      }
}

TEST(UnsaidRepeats, AReplayGivesTheSameForcesToTheLastBit) {
  LookedAt how;
  how.doing = Doing::stroking;
  how.look_hz = 160.0;
  how.look_jitter = 0.3;
  how.seconds = 4.0;
  std::vector<haptics::DeviceSample> samples;
  std::vector<haptics::Record> records;
  const Felt felt = feel(how, [&](const haptics::DeviceSample& sample, const haptics::Record& record) {
    samples.push_back(sample);
    records.push_back(record);
  });
  ASSERT_GT(felt.repeated, 1000U);
  haptics::DeviceInfo device;
  device.limits.undeclared_s = how.undeclared_s;
  haptics::HapticRenderer replayed(device, haptics::RendererOptions{},
                                   haptics::window_on(scene_on(Stone{true}), 0, 1, false));
  std::size_t differing = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const haptics::State& state = records[k].state;
    haptics::RecordedTick tick;
    tick.centre_m = {state.centre_m[0], state.centre_m[1], state.centre_m[2]};
    tick.stiffness_n_per_m = state.stiffness_n_per_m;
    tick.period_s = records[k].period_s;
    tick.nominal_period_s = records[k].nominal_period_s;
    tick.flags = state.flags;
    replayed.replay(samples[k], tick);
    if (replayed.state().commanded_force_n != state.commanded_force_n || replayed.state().flags != state.flags)
      ++differing;
  }
  EXPECT_EQ(differing, 0U);
}

}  // namespace sparsha::test
