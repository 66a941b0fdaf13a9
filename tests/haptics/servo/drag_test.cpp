// The hand drags the stone: what was under it stays under it, without a jump of force when it begins, on the way and at
// its end.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/resting_hand.h"
#include "tests/support/scenes.h"

namespace sparsha::haptics {
namespace {

using sparsha::test::HandAtRest;
using sparsha::test::RestingHand;

HapticWindow hills() { return window_on(sparsha::test::scene_of(sparsha::test::hills_m, 401, 0.1, 101)); }

void drag(HapticRenderer& renderer, bool on) {
  Command command;
  command.kind = Command::Kind::drag;
  command.on = on;
  static_cast<void>(renderer.apply(command));
}

double force_of(const HapticRenderer& renderer) {
  const auto& f = renderer.state().commanded_force_n;
  return std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
}

TEST(Drag, TakesTheForceAwayWithoutAStepAndGivesNoneBackByItself) {
  for (const double press_n : {0.3, 1.0, 2.5}) {
    HandAtRest hand(RestingHand{}, hills());
    hand.put_down(0.01, -0.008, press_n);
    drag(hand.renderer(), true);
    Eigen::Vector3d last = hand.force();
    double step_n = 0.0;
    const auto watch = [&](double) {
      step_n = std::max(step_n, (hand.force() - last).norm());
      last = hand.force();
    };
    hand.run(0.3, watch);
    EXPECT_EQ(force_of(hand.renderer()), 0.0);
    EXPECT_EQ(hand.renderer().state().contact, 0U);
    drag(hand.renderer(), false);
    hand.run(0.5, watch);
    EXPECT_LE(step_n, 0.05) << press_n;
    // The hand still pushes with its grip: it lies on the stone again, and softly.
    EXPECT_EQ(hand.renderer().state().flags & kFlagDragged, 0U);
  }
}

TEST(Drag, KeepsThePlaceOfTheSceneUnderTheHandAndLetsItGoOutsideTheStone) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  HapticRenderer renderer(DeviceInfo{}, RendererOptions{}, hills());
  double t = 0.0;
  Eigen::Vector3d hand(0.0, 0.0, 0.03);
  const auto go = [&](const Eigen::Vector3d& to) {
    hand = to;
    renderer.update(sample_at(hand, t += 0.001), 0.001);
    return renderer.state();
  };
  for (int k = 0; k < 100; ++k) go(hand);
  int lying = 0;
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
  for (int grip = 0; grip < 20; ++grip) {
    const State begun = renderer.state();
    drag(renderer, true);
    // There and back again, so that the window stays on the scene.
    way = grip % 2 == 1 ? Eigen::Vector3d(-way) : Eigen::Vector3d(0.01 * uniform(random), 0.01 * uniform(random), 0.0);
    const Eigen::Vector3d from = hand;
    const double depth = -0.02 * std::abs(uniform(random));
    for (int k = 1; k <= 50; ++k) {
      const State state = go({from.x() + 0.02 * k * way.x(), from.y() + 0.02 * k * way.y(),
                              0.03 + (depth - 0.03) * std::sin(0.02 * k * std::numbers::pi / 2)});
      ASSERT_NEAR(state.hip_m[0], begun.hip_m[0], 1e-12);
      ASSERT_NEAR(state.hip_m[1], begun.hip_m[1], 1e-12);
      ASSERT_EQ(state.contact, 0U);
    }
    drag(renderer, false);
    const State state = go(hand);
    // Deep in the stone as the hand was: the stone has made room.
    ASSERT_LE(force_of(renderer), 1e-9);
    ASSERT_GE(state.hip_m[2], sparsha::test::hills_m(state.hip_m[0], state.hip_m[1]) - 1e-4);
    // Where it lies on the stone, pressing touches at once.
    if (state.hip_m[2] < sparsha::test::hills_m(state.hip_m[0], state.hip_m[1]) + 1e-4) {
      go(hand - Eigen::Vector3d(0, 0, 0.001));
      ASSERT_EQ(renderer.state().contact, 1U);
      ++lying;
    }
    for (int k = 0; k < 200; ++k) go({hand.x(), hand.y(), std::min(0.03, hand.z() + 0.001)});
  }
  EXPECT_GE(lying, 3);
}

TEST(Drag, NeverTakesTheWindowOffTheScene) {
  HapticRenderer renderer(DeviceInfo{}, RendererOptions{}, hills());
  double t = 0.0;
  for (int k = 0; k < 100; ++k) renderer.update(sample_at({0.0, 0.0, 0.03}, t += 0.001), 0.001);
  for (int grip = 0; grip < 100; ++grip) {
    for (int k = 0; k <= 40; ++k) {
      if (k == 1) drag(renderer, true);
      renderer.update(sample_at({0.001 * k, -0.001 * k, 0.03}, t += 0.001), 0.001);
    }
    drag(renderer, false);
    renderer.update(sample_at({0.04, -0.04, 0.03}, t += 0.001), 0.001);
  }
  const State& state = renderer.state();
  EXPECT_NEAR(state.centre_m[0], 0.0, 1e-9);
  EXPECT_NEAR(state.centre_m[1], 0.1, 1e-9);
}

TEST(Drag, WaitsForAHandBeforeItLetsGo) {
  HandAtRest hand(RestingHand{}, hills());
  hand.put_down(0.0, 0.0, 1.0);
  HapticRenderer& renderer = hand.renderer();
  drag(renderer, true);
  hand.run(0.1);
  drag(renderer, false);
  DeviceSample lost = sample_at({std::nan(""), 0.0, 0.0}, 10.0);
  renderer.update(lost, 0.001);
  EXPECT_NE(renderer.state().flags & kFlagDragged, 0U);
  EXPECT_EQ(force_of(renderer), 0.0);
  hand.run(0.1);
  EXPECT_EQ(renderer.state().flags & kFlagDragged, 0U);
}

}  // namespace
}  // namespace sparsha::haptics
