// The governor's times in loops that are not as planned: times are those of the ticks that come, and a gap is none.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "haptics/governor/governor.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

struct Loop {
  double real_hz, planned_hz;
};
constexpr Loop kSlow[] = {{851.0, 5000.0}, {851.0, 1000.0}, {1000.0, 4000.0}, {333.0, 1000.0}};
constexpr int kFirstTicks = 8;       // until the loop is known
constexpr double kBin = 1.045;       // of the meter: a sixteenth of an octave
constexpr double kArming_s = 0.050;  // docs/touch.md, "Governor"
constexpr double kWish_s = 0.120;

GovernorInput tick_of(const Loop& loop, const Vector3d& force_n, bool contact) {
  GovernorInput input;
  input.force_n = force_n;
  input.contact = contact;
  input.stiffness_n_per_m = 800.0;
  input.spring_energy_j = contact ? 0.5 * force_n.squaredNorm() / 800.0 : 0.0;
  input.normal = contact ? Vector3d(Vector3d::UnitZ()) : Vector3d(Vector3d::Zero());
  input.period_s = 1.0 / loop.real_hz;
  input.nominal_period_s = 1.0 / loop.planned_hz;
  return input;
}

/// A governor that has had the hand in the air for so many ticks of the loop.
Governor settled(const Loop& loop, int ticks = 400) {
  Governor governor{DeviceLimits{}};
  for (int k = 0; k < ticks; ++k) (void)governor.update(tick_of(loop, Vector3d::Zero(), false));
  return governor;
}

}  // namespace

TEST(Pace, ASteadySlowLoopArmsAfterFiftyMillisecondsAndNotLater) {
  for (const Loop& loop : kSlow) {
    Governor governor{DeviceLimits{}};
    const double period_s = 1.0 / loop.real_hz;
    double free_s = 0.0;
    bool armed = false;
    while (!armed && free_s < 1.0) {
      armed = governor.update(tick_of(loop, Vector3d::Zero(), false)).armed;
      free_s += period_s;
    }
    EXPECT_GE(free_s, kArming_s);
    EXPECT_LE(free_s, kArming_s + (kFirstTicks + 2) * period_s) << loop.real_hz << " of " << loop.planned_hz;
  }
}

TEST(Pace, ASteadySlowLoopLetsTheForceGrowByTheSlewLimitOfRealTime) {
  for (const Loop& loop : kSlow) {
    Governor governor = settled(loop);
    const double step_n = DeviceLimits{}.slew_n_per_s / loop.real_hz;
    EXPECT_NEAR(governor.update(tick_of(loop, {0, 0, 6}, true)).force_n.z(), std::min(6.0, step_n), 1e-12)
        << loop.real_hz << " of " << loop.planned_hz;
  }
}

TEST(Pace, AGapInASteadySlowLoopCountsAsOneOfItsTicks) {
  for (const Loop& loop : kSlow) {
    Governor governor = settled(loop);
    GovernorInput late = tick_of(loop, {0, 0, 8}, true);
    late.period_s = 9.0 / loop.real_hz;
    const double grown_n = governor.update(late).force_n.z();
    const double step_n = DeviceLimits{}.slew_n_per_s / loop.real_hz;
    EXPECT_GE(grown_n, step_n - 1e-12);
    EXPECT_LE(grown_n, kBin * step_n) << loop.real_hz << " of " << loop.planned_hz;
  }
}

TEST(Pace, GapsLongerThanAnyLoopAreNoPace) {
  const Loop broken{20.0, 1000.0};
  Governor governor = settled(broken, 49);
  EXPECT_FALSE(governor.update(tick_of(broken, {0, 0, 6}, true)).armed) << "49 ticks of a millisecond";
  governor.arm();
  EXPECT_NEAR(governor.update(tick_of(broken, {0, 0, 6}, true)).force_n.z(), 1.5, 1e-12) << "one planned tick's growth";
}

TEST(Pace, ANewWishIsFulfilledIn120MillisecondsOfRealTime) {
  for (const Loop& loop : kSlow) {
    Governor governor = settled(loop);
    for (int k = 0; k < 20; ++k) {
      (void)governor.stiffness(100.0, 1.0 / loop.planned_hz);
      (void)governor.update(tick_of(loop, {0, 0, 1}, true));
    }
    double taken_s = 0.0;
    while (governor.stiffness(200.0, 1.0 / loop.planned_hz) < 200.0 - 1e-9 && taken_s < 1.0) {
      (void)governor.update(tick_of(loop, {0, 0, 1}, true));
      taken_s += 1.0 / loop.real_hz;
    }
    EXPECT_GE(taken_s, kWish_s / kBin - 2.0 / loop.real_hz);
    EXPECT_LE(taken_s, kWish_s + 2.0 / loop.real_hz) << loop.real_hz << " of " << loop.planned_hz;
  }
}

TEST(Pace, ANewWishIsFulfilledAsFastForADeviceThatLooksEveryTenthTick) {
  const Loop loop{1000.0, 1000.0};
  Governor governor{DeviceLimits{}};
  governor.arm();
  int ticks = 0;
  const auto tick = [&](double wish_n_per_m) {
    const double stiffness_n_per_m = governor.stiffness(wish_n_per_m, 0.001);
    GovernorInput input = tick_of(loop, {0, 0, 1}, true);
    input.fresh = ticks++ % 10 == 0;
    (void)governor.update(input);
    return stiffness_n_per_m;
  };
  for (int k = 0; k < 3000; ++k) (void)tick(20.0);
  ASSERT_GT(governor.pace_s(0.001), 0.009) << "the case that is meant";
  double last = tick(40.0), steepest = 0.0;
  int taken = 1;
  for (; last < 40.0 - 1e-9 && taken < 1000; ++taken) {
    const double now = tick(40.0);
    steepest = std::max(steepest, now - last);
    last = now;
  }
  EXPECT_NEAR(taken, 120, 8);
  EXPECT_LT(steepest, 1.6 * 20.0 / 120.0);
}

TEST(Pace, ASteadySlowLoopDoesNotJitterAndOneWhoseTicksScatterDoes) {
  for (const Loop& loop : kSlow) EXPECT_FALSE(settled(loop).jitters()) << loop.real_hz << " of " << loop.planned_hz;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> late_s(0.0, 0.003);
  const Loop planned{1000.0, 1000.0};
  Governor governor{DeviceLimits{}};
  double before_s = 0.0;
  for (int k = 0; k < 2000; ++k) {
    GovernorInput input = tick_of(planned, Vector3d::Zero(), false);
    const double now_s = late_s(random);
    input.period_s = std::max(1e-4, 0.003 + now_s - before_s);
    before_s = now_s;
    (void)governor.update(input);
  }
  EXPECT_TRUE(governor.jitters());
}

}  // namespace sparsha::haptics::test
