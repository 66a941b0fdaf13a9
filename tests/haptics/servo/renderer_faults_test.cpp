// What the renderer makes of news, times, places and commands that cannot be.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "haptics/servo/haptic_renderer.h"
#include "haptics/state/stone_gives.h"
#include "haptics/window/surface.h"
#include "haptics/window/window.h"
#include "tests/haptics/servo/timed_hand.h"
#include "tests/support/servo_parts.h"
#include "tests/support/soft_stone.h"

namespace sparsha::haptics {
namespace {

TEST(HapticRenderer, NoNewsOfTheHandForTenMillisecondsNeedsFreeSpaceBeforeForce) {
  for (const int lost : {5, 9, 12, 100}) {
    TimedHand hand(window_on(sparsha::test::flat_scene()));
    hand.arm();
    ASSERT_GT(hand.press({0.0, 0.0, -0.002}).commanded_force_n[2], 1.0);
    DeviceSample stale = sample_at({0.0, 0.0, -0.002}, 0.0);
    stale.fresh = false;
    for (int i = 1; i <= lost; ++i) {
      const double force_n = vector_of(hand.go(stale).commanded_force_n).norm();
      ASSERT_TRUE(i < 7 ? force_n > 1.0 : force_n == 0.0) << i;
    }
    for (int i = 0; i < 100; ++i) hand.go({0.0, 0.0, -0.002});
    const double after = hand.renderer.state().commanded_force_n[2];
    if (lost < 10)
      EXPECT_GT(after, 1.0) << lost;
    else
      EXPECT_EQ(after, 0.0) << lost;
    hand.arm();
    EXPECT_GT(hand.press({0.0, 0.0, -0.002}).commanded_force_n[2], 1.0);
  }
}

TEST(HapticRenderer, AGapInTheHandsTimeIsAFaultAndMovesNoWindow) {
  TimedHand hand(window_on(sparsha::test::flat_scene(0.0, 101, 1.0)));
  Command scroll;
  scroll.scroll_m_per_s = {0.01, 0.0, 0.0};
  static_cast<void>(hand.renderer.apply(scroll));
  hand.arm();
  hand.press({0.0, 0.0, -0.002});
  const State before = hand.renderer.state();
  DeviceSample late = sample_at({0.0, 0.0, -0.002}, before.time_s + 1.0);
  hand.renderer.update(late, kPeriod_s);
  const State& state = hand.renderer.state();
  EXPECT_EQ(vector_of(state.commanded_force_n).norm(), 0.0);
  EXPECT_TRUE((state.flags & kFlagFault) != 0);
  EXPECT_NEAR(state.centre_m[0] - before.centre_m[0], 0.01 * kPeriod_s, 1e-12) << "one nominal tick's way";
  for (int i = 1; i < 100; ++i) {
    hand.renderer.update(sample_at({0.0, 0.0, -0.002}, late.time_s + i * kPeriod_s), kPeriod_s);
    ASSERT_EQ(vector_of(hand.renderer.state().commanded_force_n).norm(), 0.0) << "still in the stone";
  }
}

TEST(HapticRenderer, TimesThatGoBackwardsOrAreNoNumbersLastOneNominalTick) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  TimedHand hand(window_on(sparsha::test::flat_scene()));
  hand.arm();
  for (const double time_s : {kNan, -1.0, -1e300, -std::numeric_limits<double>::infinity(), kNan}) {
    hand.renderer.update(sample_at({0.0, 0.0, -0.002}, time_s), kPeriod_s);
    EXPECT_EQ(hand.renderer.record().period_s, kPeriod_s) << time_s;
    EXPECT_TRUE(vector_of(hand.renderer.state().commanded_force_n).allFinite());
    EXPECT_LE(hand.renderer.state().commanded_force_n[2], 8.0);
  }
}

TEST(HapticRenderer, AHandThatIsFartherThanAnyHandIsAFaultAndNoFreeSpace) {
  for (const double far : {11.0, -11.0, 1e12, -1e30, 1e308}) {
    TimedHand hand(window_on(sparsha::test::flat_scene()));
    for (int i = 0; i < 100; ++i) {
      const State& state = hand.go({0.0, 0.0, far});
      ASSERT_TRUE((state.flags & kFlagFault) != 0) << far;
      ASSERT_TRUE((state.flags & kFlagArmed) == 0);
    }
    for (int i = 0; i < 20; ++i) ASSERT_EQ(hand.go({0.0, 0.0, -0.002}).commanded_force_n[2], 0.0);
  }
}

TEST(HapticRenderer, CommandsThatAreNoNumbersOrBeyondTheDeviceDoNotReachTheHand) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  TimedHand hand(window_on(sparsha::test::flat_scene()));
  hand.arm();
  for (const double wish : {1e9, std::numeric_limits<double>::infinity(), kNan, -5.0}) {
    Command command;
    command.kind = Command::Kind::stiffness;
    command.stiffness_n_per_m = wish;
    static_cast<void>(hand.renderer.apply(command));
    const State& state = hand.go({0.0, 0.0, -0.001});
    EXPECT_GE(hand.renderer.state().stiffness_n_per_m, 0.0);
    EXPECT_LE(hand.renderer.state().stiffness_n_per_m, stiffness_limit(DeviceLimits{}, kPeriod_s));
    EXPECT_TRUE(vector_of(state.force_n).allFinite());
  }
  Command scroll;
  scroll.scroll_m_per_s = {0.0, kNan, 0.0};
  static_cast<void>(hand.renderer.apply(scroll));
  Command swap;
  swap.kind = Command::Kind::swap;
  swap.window = window_on(sparsha::test::flat_scene(), 0, 2);
  swap.move = true;
  swap.centre_m = {kNan, 0.0};
  static_cast<void>(hand.renderer.apply(swap));
  hand.arm();
  EXPECT_TRUE(std::isfinite(hand.renderer.state().centre_m[0]) && std::isfinite(hand.renderer.state().centre_m[1]));
}

TEST(HapticRenderer, ATickThatFailsAfterItsForceWasDecidedIsZeroAndFlaggedOnce) {
  TimedHand hand(window_on(sparsha::test::flat_scene()));
  hand.arm();
  ASSERT_GT(hand.press({0.0, 0.0, -0.002}).commanded_force_n[2], 1.0);
  hand.renderer.fail();
  hand.renderer.fail();
  EXPECT_EQ(hand.renderer.faults(), 1U);
  EXPECT_EQ(vector_of(hand.renderer.state().commanded_force_n).norm(), 0.0);
  EXPECT_TRUE((hand.renderer.state().flags & kFlagFault) != 0);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(hand.go({0.0, 0.0, -0.002}).commanded_force_n[2], 0.0);
}

}  // namespace
}  // namespace sparsha::haptics
