#include "haptics/servo/haptic_renderer.h"
#include "haptics/state/stone_gives.h"
#include "haptics/window/surface.h"
#include "haptics/window/window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/haptics/servo/timed_hand.h"
#include "tests/support/servo_parts.h"
#include "tests/support/soft_stone.h"

namespace sparsha::haptics {
namespace {

TEST(HapticRenderer, PutsTheDevicesOriginOnTheSurfaceAtTheWindowsCentre) {
  TimedHand hand(window_on(sparsha::test::flat_scene(0.25)));
  const State& state = hand.go({0.0, 0.0, 0.01});
  EXPECT_NEAR(state.centre_m[2], 0.25, 0.25 * 1e-7);  // heights are stored as floats
  EXPECT_NEAR(state.centre_m[0], 0.05, kEpsilon);
  EXPECT_EQ(state.contact, 0U);
  EXPECT_EQ(state.penetration_m, 0.0);
  EXPECT_EQ(vector_of(state.hip_m), vector_of(state.proxy_m));
}

TEST(HapticRenderer, PushesWithStiffnessTimesDepthInTheDeviceFrameAtAnyScale) {
  for (const double width_m : {1e-3, 0.1, 10.0, 1000.0}) {
    TimedHand hand(window_on(sparsha::test::flat_scene(0.0, 101, width_m)));
    hand.arm();
    const State& state = hand.press({0.001, 0.002, -0.002});
    EXPECT_NEAR(state.force_n[2], 800.0 * 0.002, 1e-9) << width_m;
    EXPECT_NEAR(state.penetration_m, 0.002, 1e-12) << width_m;
    EXPECT_NEAR(state.commanded_force_n[2], 800.0 * 0.002, 0.01 * 1.6) << width_m;
    EXPECT_EQ(state.contact, 1U);
    EXPECT_TRUE((state.flags & kFlagArmed) != 0);
  }
}

TEST(HapticRenderer, GivesNoForceBeforeTheHandHasBeenInFreeSpaceForFiftyMilliseconds) {
  TimedHand hand(window_on(sparsha::test::flat_scene()));
  for (int i = 0; i < 500; ++i) {
    const State& state = hand.go({0.0, 0.0, -0.003});  // starts inside the stone
    ASSERT_EQ(vector_of(state.commanded_force_n).norm(), 0.0);
    ASSERT_GT(state.force_n[2], 0.0) << "the renderer itself knows the force";
  }
  for (int i = 0; i < 40; ++i) hand.go({0.0, 0.0, 0.003});
  EXPECT_EQ(hand.go({0.0, 0.0, -0.001}).commanded_force_n[2], 0.0) << "40 ms are not enough";
  for (int i = 0; i < 60; ++i) hand.go({0.0, 0.0, 0.003});
  for (int i = 0; i < 10; ++i) hand.go({0.0, 0.0, -0.001});
  EXPECT_GT(hand.renderer.state().commanded_force_n[2], 0.5);
}

TEST(HapticRenderer, StoneGivesNothingAfterNewsThatStayedAwayThoughTheRawForceIsKnown) {
  sparsha::test::SoftStone stone(window_on(sparsha::test::flat_scene()));
  EXPECT_TRUE(stone_gives(stone.felt()));
  EXPECT_GT(vector_of(stone.felt().commanded_force_n).norm(), 7.9);
  for (int k = 0; k < 200; ++k) {
    const State& state = stone.stroke(1e-5 * k);
    ASSERT_GT(vector_of(state.force_n).norm(), stone.kRaw_n);
    ASSERT_EQ(vector_of(state.commanded_force_n).norm(), 0.0);
    ASSERT_EQ(state.contact, 1U);
    ASSERT_FALSE(stone_gives(state));
  }
}

TEST(HapticRenderer, TellsWhichShareOfTheForceTheHandIsGivenAndNoStrikeWithoutForce) {
  TimedHand hand(window_on(sparsha::test::flat_scene()));
  hand.arm();
  EXPECT_EQ(hand.renderer.state().given_share, 1.0) << "nothing is held back in the air";
  const State& resting = hand.press({0.0, 0.0, -0.002});
  EXPECT_NEAR(resting.given_share, 1.0, 0.01);
  // A watchdog's silence: the stone gives nothing until the hand has been in free space, and whoever asks is told so.
  hand.renderer.fail();
  EXPECT_EQ(hand.renderer.state().given_share, 0.0);
  int touches = 0;
  for (int k = 0; k < 400; ++k) {
    const State& state = hand.go({0.0, 0.0, k % 20 < 10 ? -0.003 : 0.0005});
    if (state.contact != 0) {
      // Of a soft wall: leaps between rests are those of a device that looks at the hand 100 times a second.
      ASSERT_GT(state.force_n[2], 0.01) << "traces still know the raw force";
      ASSERT_EQ(state.given_share, 0.0);
    }
    const auto& event = hand.renderer.event();
    if (event && event->kind == ContactEvent::Kind::touch) {
      ++touches;
      ASSERT_EQ(event->peak_force_n, 0.0) << "no click without a force";
    }
  }
  EXPECT_GT(touches, 10);
}

TEST(HapticRenderer, KnowsWhenStoneLastGaveAForceAndForgetsItNeitherInTheAirNorInAFault) {
  TimedHand hand(window_on(sparsha::test::flat_scene()));
  hand.arm();
  EXPECT_LT(hand.renderer.state().touched_s, 0.0) << "it has been in the air only";
  const State& state = hand.press({0.0, 0.0, -0.002});
  const double touched_s = state.time_s;
  EXPECT_EQ(state.touched_s, touched_s);
  for (int k = 0; k < 20; ++k) hand.go({0.0, 0.0, 0.003});
  EXPECT_EQ(state.touched_s, touched_s);
  EXPECT_GT(state.time_s, touched_s + 0.015);
  hand.renderer.fail();
  for (int k = 0; k < 20; ++k) {
    hand.go({0.0, 0.0, -0.003});
    ASSERT_EQ(state.contact, 1U);
    ASSERT_EQ(state.touched_s, touched_s) << "in the stone, which gives no force";
  }
}

TEST(HapticRenderer, AnswersNotANumberWithZeroForceAtOnceAndArmsAnew) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    TimedHand hand(window_on(sparsha::test::flat_scene()));
    hand.arm();
    const State before = hand.press({0.0, 0.0, -0.002});
    ASSERT_GT(before.commanded_force_n[2], 1.0);
    const State& fault = hand.go(Eigen::Vector3d(0.0, bad, -0.002));
    EXPECT_EQ(vector_of(fault.commanded_force_n).norm(), 0.0);
    EXPECT_TRUE((fault.flags & kFlagFault) != 0);
    EXPECT_TRUE((fault.flags & kFlagArmed) == 0);
    EXPECT_EQ(vector_of(fault.device_m), vector_of(before.device_m)) << "the last good place stays";
    EXPECT_TRUE(std::isfinite(fault.proxy_m[0]) && std::isfinite(fault.hip_m[1]));
    for (int i = 0; i < 100; ++i)
      ASSERT_EQ(vector_of(hand.go({0.0, 0.0, -0.002}).commanded_force_n).norm(), 0.0) << "still in the stone";
    hand.arm();
    EXPECT_GT(hand.press({0.0, 0.0, -0.002}).commanded_force_n[2], 1.0);
    EXPECT_EQ(hand.renderer.faults(), 1U);
  }
}

TEST(HapticRenderer, HoldsTheForceOverSamplesWithoutNewsForSevenMillisecondsAndGoesOnWithTheNext) {
  TimedHand hand(window_on(sparsha::test::flat_scene()));
  hand.arm();
  hand.press({0.0, 0.0, -0.002});
  DeviceSample stale = sample_at({0.0, 0.0, -0.002}, 0.0);
  stale.fresh = false;
  const Eigen::Vector3d before_n = vector_of(hand.renderer.state().commanded_force_n);
  for (int k = 1; k < 7; ++k) {
    const State& lost = hand.go(stale);
    EXPECT_EQ(vector_of(lost.commanded_force_n), before_n) << k;
    EXPECT_TRUE((lost.flags & kFlagStale) != 0);
  }
  const State& state = hand.go(stale);
  EXPECT_EQ(vector_of(state.commanded_force_n).norm(), 0.0);
  EXPECT_TRUE((state.flags & kFlagStale) != 0);
  EXPECT_TRUE((state.flags & kFlagFault) == 0);
  EXPECT_TRUE((hand.go({0.0, 0.0, -0.002}).flags & kFlagStale) == 0);
}

TEST(HapticRenderer, GivesNoForceWhenUnpluggedOrNotHomed) {
  TimedHand hand(window_on(sparsha::test::flat_scene()));
  hand.arm();
  hand.press({0.0, 0.0, -0.002});
  DeviceSample gone = sample_at({0.0, 0.0, -0.002}, 0.0);
  gone.connected = false;
  EXPECT_EQ(vector_of(hand.go(gone).commanded_force_n).norm(), 0.0);
  EXPECT_TRUE((hand.renderer.state().flags & kFlagFault) != 0);
  DeviceSample unknown = sample_at({0.3, 0.0, -0.5}, 0.0);
  unknown.homed = false;
  const State& state = hand.go(unknown);
  EXPECT_EQ(vector_of(state.commanded_force_n).norm(), 0.0);
  EXPECT_EQ(vector_of(state.force_n).norm(), 0.0) << "positions that are not absolute render nothing";
  EXPECT_TRUE((state.flags & kFlagHomed) == 0);
  EXPECT_EQ(hand.go({0.0, 0.0, 0.02}).contact, 0U) << "after homing the proxy starts where the hand is";
}

TEST(HapticRenderer, ForceEndsWithContactAndNeverPulls) {
  TimedHand hand(window_on(sparsha::test::scene_of(sparsha::test::hills_m, 101, 0.1)));
  hand.arm();
  for (int i = 0; i < 4000; ++i) {
    const double t = i * 0.001;
    const State& state =
        hand.go(Eigen::Vector3d(0.03 * std::sin(2.1 * t), 0.03 * std::cos(1.7 * t), 0.004 * std::sin(9.0 * t)));
    const Eigen::Vector3d force = vector_of(state.commanded_force_n);
    if (state.contact == 0)
      ASSERT_EQ(force.norm(), 0.0);
    else
      ASSERT_GE(force.dot(vector_of(state.normal)), -1e-9);
  }
}

TEST(HapticRenderer, ASwapInContactKeepsTheHandTheProxyAndTheForceWhereTheyWere) {
  const auto scene = sparsha::test::scene_of(sparsha::test::hills_m, 401, 0.1, 101);  // levels 0, 1, 2
  TimedHand hand(window_on(scene, 2));
  hand.arm();
  const State before = hand.press({0.012, -0.017, -0.003});
  ASSERT_EQ(before.contact, 1U);
  const Eigen::Vector3d proxy_before = (vector_of(before.proxy_m) - vector_of(before.centre_m)) * before.scale;

  // Level 0 around the hand, four times larger in the hand.
  const scene::Lattice& fine = scene->description().levels[0];
  const int i0 = 180;
  const int j0 = 80;
  Command command;
  command.kind = Command::Kind::swap;
  command.sequence = 5;
  command.window.surface = make_surface(scene->description(), scene->read(0, i0, j0, 101, 101), 0,
                                        0.1 / (100 * fine.spacing_m), SurfaceOptions{});
  command.window.i0 = i0;
  command.window.j0 = j0;
  command.window.id = 2;
  const SurfacePointer retired = hand.renderer.apply(command);
  ASSERT_NE(retired, nullptr);
  EXPECT_EQ(retired->level, 2);
  const State after = hand.go({0.012, -0.017, -0.003});
  EXPECT_EQ(after.command, 5U);
  EXPECT_EQ(after.surface_id, 2U);
  EXPECT_EQ(after.level, 0U);
  EXPECT_NEAR(after.scale / before.scale, 4.0, 1e-12);
  EXPECT_EQ(after.contact, 1U);
  // Before the first update the proxy is where it was to rounding; the update lets it slide on the finer relief, by no
  // more than the way that the difference of slopes asks for: the relief is 0.4 steep at most.
  const Eigen::Vector3d proxy_after = (vector_of(after.proxy_m) - vector_of(after.centre_m)) * after.scale;
  EXPECT_LT((proxy_after - proxy_before).norm(), 0.5 * before.penetration_m);
  EXPECT_NEAR(after.penetration_m, before.penetration_m, 0.25 * before.penetration_m);
  // What is under the finger stays under the finger.
  EXPECT_NEAR(after.proxy_m[0], before.proxy_m[0], 0.5 * before.penetration_m / after.scale + 1e-12);
  const double growth = vector_of(after.commanded_force_n).norm() - vector_of(before.commanded_force_n).norm();
  EXPECT_LE(growth, 1500.0 * kPeriod_s * (1.0 + 1e-9)) << "the slew limit of 1.5 N a millisecond";
}

TEST(HapticRenderer, ASwapInTheAirKeepsTheClearance) {
  const auto scene = sparsha::test::scene_of(sparsha::test::hills_m, 201, 0.1, 101);
  TimedHand hand(window_on(scene, 1));
  const Eigen::Vector3d place(0.02, 0.01, 0.006);
  const State before = hand.go(place);
  ASSERT_EQ(before.contact, 0U);
  Command command;
  command.kind = Command::Kind::swap;
  command.window = window_on(scene, 0, 2);
  static_cast<void>(hand.renderer.apply(command));
  const State after = hand.go(place);
  EXPECT_EQ(after.contact, 0U);
  const auto clearance = [&](const State& s) {
    return (s.hip_m[2] - sparsha::test::hills_m(s.hip_m[0], s.hip_m[1])) * s.scale;
  };
  // Interpolation error of the coarser grid: h^2 kappa / 8 both ways.
  EXPECT_NEAR(clearance(after), clearance(before), 2.0 * 0.001 * 0.001 * 0.004 * (80.0 * 80.0 + 65.0 * 65.0) / 8.0);
}

TEST(HapticRenderer, AMoveInContactPutsTheNewPlaceUnderTheHandWithoutAStepInForce) {
  const auto scene = sparsha::test::scene_of(sparsha::test::hills_m, 401, 0.1, 101);
  TimedHand hand(window_on(scene, 2));
  hand.arm();
  const State before = hand.press({0.01, 0.01, -0.002});
  Command command;
  command.kind = Command::Kind::swap;
  command.window = window_on(scene, 2, 9);
  command.move = true;
  command.centre_m = {0.03, 0.04};
  static_cast<void>(hand.renderer.apply(command));
  const State after = hand.go({0.01, 0.01, -0.002});
  EXPECT_EQ(after.centre_m[0], 0.03);
  EXPECT_EQ(after.centre_m[1], 0.04);
  EXPECT_EQ(after.contact, 1U);
  EXPECT_LE(vector_of(after.commanded_force_n).norm() - vector_of(before.commanded_force_n).norm(), 1.5 + 1e-9);
  EXPECT_LT(after.penetration_m, 2.0 * before.penetration_m);
}

TEST(HapticRenderer, ScrollsTheWindowSmoothlyUnderTheHand) {
  TimedHand hand(window_on(sparsha::test::flat_scene()));
  hand.go({0.045, 0.0, 0.01});
  Command command;
  command.kind = Command::Kind::scroll;
  command.scroll_m_per_s = {0.02, 0.0, 0.0};
  static_cast<void>(hand.renderer.apply(command));
  const double start = hand.renderer.state().centre_m[0];
  for (int i = 0; i < 100; ++i) hand.go({0.045, 0.0, 0.01});
  EXPECT_NEAR(hand.renderer.state().centre_m[0] - start, 0.02 * 0.1, 1e-9);
}

TEST(HapticRenderer, NeverScrollsDownOnAHandInContact) {
  TimedHand hand(window_on(sparsha::test::flat_scene()));
  hand.arm();
  const State before = hand.press({0.0, 0.0, -0.001});
  Command command;
  command.kind = Command::Kind::scroll;
  command.scroll_m_per_s = {0.0, 0.0, -0.05};
  static_cast<void>(hand.renderer.apply(command));
  for (int i = 0; i < 100; ++i) hand.go({0.0, 0.0, -0.001});
  EXPECT_EQ(hand.renderer.state().centre_m, before.centre_m);
  EXPECT_EQ(hand.renderer.state().force_n, before.force_n);
}

TEST(HapticRenderer, FlagsBorderOutsideUnknownAndFilled) {
  const auto scene =
      sparsha::test::scene_of([](double x, double y) { return x < 0.03 && y < 0.03 ? std::nan("") : 0.0; }, 101, 0.1);
  TimedHand hand(window_on(scene));
  hand.go({0.0, 0.0, 0.01});
  EXPECT_EQ(hand.renderer.state().flags & (kFlagWindowBorder | kFlagOutside | kFlagUnknownArea | kFlagFilledArea), 0U);
  hand.go({-0.04, -0.04, 0.01});
  EXPECT_TRUE((hand.renderer.state().flags & kFlagUnknownArea) != 0);
  EXPECT_TRUE((hand.renderer.state().flags & kFlagOutside) == 0);
  hand.go({0.0495, 0.0, 0.01});
  EXPECT_TRUE((hand.renderer.state().flags & kFlagWindowBorder) != 0);
  EXPECT_TRUE((hand.renderer.state().flags & kFlagOutside) == 0);
  hand.go({0.0505, 0.0, 0.01});
  EXPECT_TRUE((hand.renderer.state().flags & kFlagWindowBorder) != 0);
  EXPECT_TRUE((hand.renderer.state().flags & kFlagOutside) != 0);
}

TEST(HapticRenderer, RecordsTheCellThatIsTouchedHoweverFarTheSceneIsFromTheOrigin) {
  for (const double x0 : {0.0, -3.0, 1e7}) {
    const Eigen::Vector3d origin_m(x0, -2.0 * x0, x0);
    TimedHand hand(window_on(sparsha::test::scene_of([x0](double, double) { return x0; }, 101, 0.1, 200, origin_m)));
    hand.arm();
    hand.press({0.0125, -0.0215, -0.002});  // of a workspace of 0.1 m, its origin at the window's middle
    const Record& record = hand.renderer.record();
    EXPECT_EQ(record.cell_i, 62) << x0;
    EXPECT_EQ(record.cell_j, 28) << x0;
    EXPECT_NEAR(record.cell_m, 0.001, kEpsilon) << x0;
  }
}

TEST(HapticRenderer, CountsEveryClickHoweverShort) {
  TimedHand hand(window_on(sparsha::test::flat_scene()));
  const auto hold = [&](std::uint64_t buttons, int ticks) {
    DeviceSample sample = sample_at({0.0, 0.0, 0.02}, 0.0);
    sample.buttons = buttons;
    for (int i = 0; i < ticks; ++i) hand.go(sample);
  };
  using Presses = std::array<std::uint64_t, 4>;
  hold(0, 30);
  EXPECT_EQ(hand.renderer.state().button_presses, Presses{});
  hold(0b0001, 2);  // shorter than any reader's look
  hold(0, 30);
  EXPECT_EQ(hand.renderer.state().button_presses, (Presses{1, 0, 0, 0}));
  hold(0b1000, 500);  // held
  hold(0b1100, 100);  // and another with it
  hold(0, 30);
  EXPECT_EQ(hand.renderer.state().button_presses, (Presses{1, 0, 1, 1}));
  hold(0b1001, 40);
  EXPECT_EQ(hand.renderer.state().button_presses, (Presses{2, 0, 1, 2}));
}

TEST(HapticRenderer, IdenticalSamplesGiveIdenticalBits) {
  const auto scene = sparsha::test::scene_of(sparsha::test::hills_m, 201, 0.1);
  TimedHand first(window_on(scene));
  TimedHand second(window_on(scene));
  for (int i = 0; i < 3000; ++i) {
    const double t = i * 0.001;
    const Eigen::Vector3d place(0.03 * std::sin(2.1 * t), 0.03 * std::cos(1.7 * t), 0.004 * std::cos(5.0 * t));
    const State a = first.go(place);
    const State b = second.go(place);
    ASSERT_EQ(a.proxy_m, b.proxy_m);
    ASSERT_EQ(a.force_n, b.force_n);
    ASSERT_EQ(a.commanded_force_n, b.commanded_force_n);
  }
}

TEST(HapticRenderer, ShowsTheFingertipWhereItTouchesTheStone) {
  // A ball of 2 mm in a bowl and on a dome of 20 mm: contact lies on the stone itself, not on the ball's own surface.
  for (const double up : {-1.0, 1.0}) {
    const auto round = [up](double x, double y) {
      const double across = std::hypot(x - 0.05, y - 0.05);
      return up * std::sqrt(std::max(0.0, 0.02 * 0.02 - across * across));
    };
    WindowPlan plan = plan_window(sparsha::test::scene_of(round, 401, 0.1, 401)->description(), 0, {0.05, 0.05}, 0.1);
    plan.tip_radius_m = 0.002;
    TimedHand hand(load_window(*sparsha::test::scene_of(round, 401, 0.1, 401), plan, 1));
    hand.arm();
    const State& state = hand.press({0.008, -0.003, up * 0.02 * 0.9 - up * 0.02 - 0.003});
    ASSERT_EQ(state.contact, 1U);
    ASSERT_GT(std::hypot(state.normal[0], state.normal[1]), 0.2);
    const std::array<double, 3> touched = touched_place(state);
    const double off = std::hypot(touched[0] - 0.05, touched[1] - 0.05, touched[2]) - 0.02;
    // Nodes 0.25 mm apart: the height of a chord, and the crease's share of the radius.
    EXPECT_LT(std::abs(off), 1e-5) << up;
    const double wrong = std::hypot(state.proxy_m[0] - 0.05, state.proxy_m[1] - 0.05, state.proxy_m[2]) - 0.02;
    EXPECT_GT(std::abs(wrong), 5.0 * std::abs(off)) << up;
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(state.place_m[static_cast<std::size_t>(axis)], touched[static_cast<std::size_t>(axis)]);
  }
}

}  // namespace
}  // namespace sparsha::haptics
