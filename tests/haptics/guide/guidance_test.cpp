// Hands that are led along lines: they follow, get no more force and energy than was promised, and are let go.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "haptics/guide/guidance.h"
#include "haptics/servo/haptic_renderer.h"
#include "tests/support/guided_hand.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector2d;
using test::GuidedHand;
using test::GuidedRun;
using test::Polygon;

constexpr double kForce_n = 1.0;
constexpr double kSpeed = 0.04;  // m/s
constexpr double kWithin_m = 0.002;
// What the springs may hold beyond what leads puts in: each up to the force at 2 mm and on to where a hand is let go,
// and what the governor lets a contact deliver before it has received any energy.
constexpr double kStored_j = kForce_n * (0.5 * 0.002 + (0.005 - 0.5 * 0.002)) + kOverdraft_j;

/// A level stone of 0.1 m: device frame = grid frame about its middle.
HapticRenderer level_stone() { return {DeviceInfo{}, RendererOptions{}, window_on(test::flat_scene(), 0, 1, false)}; }

Command guide_along(const Polygon& corners_m, bool closed, double force_n = kForce_n, double speed = kSpeed) {
  std::vector<Vector2d> line;
  for (const Vector2d& corner : corners_m) line.emplace_back(corner + Vector2d(0.05, 0.05));
  if (closed) line.push_back(line.front());
  Command command;
  command.kind = Command::Kind::guide;
  command.guide = std::make_shared<const Guide>(Guide{GuidePath(line), force_n, speed});
  return command;
}

void ask(HapticRenderer& renderer, Command command) { static_cast<void>(renderer.apply(command)); }

double length_of(const Polygon& corners, bool closed) {
  double sum = 0.0;
  for (std::size_t k = 0; k + (closed ? 0 : 1) < corners.size(); ++k)
    sum += (corners[(k + 1) % corners.size()] - corners[k]).norm();
  return sum;
}

/// Share of the line that the hand came within 2 mm of, and of the time since it was first there that it stayed so.
struct Following {
  double of_line = 0.0;
  double of_time = 0.0;
};

Following following(const GuidedRun& run, const Polygon& corners, bool closed) {
  const Polygon line = test::along(corners, closed, 0.0005);
  std::size_t reached = 0;
  for (const Vector2d& place : line)
    reached += std::any_of(run.places_m.begin(), run.places_m.end(),
                           [&](const Vector2d& hand) { return (hand - place).norm() < kWithin_m; })
                   ? 1
                   : 0;
  std::size_t ticks = 0;
  std::size_t near = 0;
  for (const Vector2d& hand : run.places_m) {
    const bool within = test::distance_to(corners, closed, hand) < kWithin_m;
    if (within || ticks > 0) {
      ++ticks;
      near += within ? 1 : 0;
    }
  }
  return {static_cast<double>(reached) / static_cast<double>(line.size()),
          ticks > 0 ? static_cast<double>(near) / static_cast<double>(ticks) : 0.0};
}

struct Shape {
  std::string name;
  Polygon corners;
  bool closed = true;
};

std::vector<Shape> shapes() {
  // A dumbbell with a neck of 2 mm: its sides lie as close as the walls are wide.
  const Polygon neck{{-0.03, -0.012}, {-0.008, -0.012}, {-0.008, -0.001}, {0.008, -0.001},
                     {0.008, -0.012}, {0.03, -0.012},   {0.03, 0.012},    {0.008, 0.012},
                     {0.008, 0.001},  {-0.008, 0.001},  {-0.008, 0.012},  {-0.03, 0.012}};
  return {{"square", {{-0.02, -0.02}, {0.02, -0.02}, {0.02, 0.02}, {-0.02, 0.02}}},
          {"star of five concave points", test::star(5, 0.035, 0.012)},
          {"a thin neck", neck},
          {"a circle", test::star(60, 0.02, 0.02)},
          {"a tiny circle", test::star(12, 0.002, 0.002)},
          {"a line with two ends", {{-0.03, -0.01}, {0.0, 0.02}, {0.03, 0.0}}, false}};
}

TEST(Guide, LeadsHandsOfAnyWeightAlongLinesOfAnyShape) {
  for (const Shape& shape : shapes())
    for (const double mass : {0.05, 0.15, 0.5})
      for (const double damping : {0.5, 2.0, 10.0})
        for (const double delay : {0.001, 0.003}) {
          HapticRenderer renderer = level_stone();
          ask(renderer, guide_along(shape.corners, shape.closed));
          GuidedHand hand{.mass_kg = mass, .damping_n_s_per_m = damping, .delay_s = delay};
          hand.start_m = shape.corners.front() + Vector2d(0.004, 0.003);
          const double length = length_of(shape.corners, shape.closed);
          const GuidedRun run = test::run(renderer, hand, 3.0 + 3.0 * length / kSpeed, kForce_n * kSpeed);
          const Following found = following(run, shape.corners, shape.closed);
          const std::string which = shape.name + ", " + std::to_string(mass) + " kg, " + std::to_string(damping) +
                                    " N s/m, " + std::to_string(delay) + " s";
          EXPECT_GE(found.of_line, 0.95) << which;
          EXPECT_GE(found.of_time, 0.95) << which;
          EXPECT_LE(run.strongest_n, kForce_n + 1e-9) << which;
          EXPECT_LE(run.delivered_j, kStored_j) << which;
          EXPECT_GE(run.states.back().guide_rounds, shape.closed ? 1U : 0U) << which;
        }
}

Polygon square() { return {{-0.02, -0.02}, {0.02, -0.02}, {0.02, 0.02}, {-0.02, 0.02}}; }

double guide_n(const State& state) { return std::hypot(state.guide_n[0], state.guide_n[1]); }

TEST(Guide, LeadsAHandThatPressesOnTheStone) {
  HapticRenderer renderer = level_stone();
  ask(renderer, guide_along(square(), true));
  GuidedHand hand{.height_m = -0.001, .start_m = {-0.018, -0.016}};
  const GuidedRun run = test::run(renderer, hand, 12.0, kForce_n * kSpeed);
  EXPECT_EQ(run.states.back().contact, 1U);
  EXPECT_GE(following(run, square(), true).of_line, 0.95);
  EXPECT_GE(following(run, square(), true).of_time, 0.95);
}

TEST(Guide, IsNotFasterThanAskedAndFollowsTheWishedForceAndSpeed) {
  for (const double speed : {0.02, 0.08}) {
    HapticRenderer renderer = level_stone();
    ask(renderer, guide_along(square(), true, 0.5, speed));
    const GuidedRun run = test::run(renderer, {.start_m = {-0.02, -0.02}}, 4.0, 0.5 * speed);
    double way_m = 0.0;
    for (std::size_t k = 1001; k < 3000; ++k) way_m += (run.places_m[k] - run.places_m[k - 1]).norm();
    EXPECT_LT(way_m, 2.0 * speed * 1.2);
    EXPECT_GT(way_m, 2.0 * speed * 0.5) << "slower in corners";
    EXPECT_LE(run.strongest_n, 0.5 + 1e-9);
  }
}

TEST(Guide, BeginsWithoutAStepAndOnlyOnceForcesAreArmed) {
  HapticRenderer renderer = level_stone();
  ask(renderer, guide_along(square(), true));
  const GuidedRun run = test::run(renderer, {.start_m = {-0.01, -0.012}}, 3.0, kForce_n * kSpeed);
  constexpr std::size_t kFirstCorner = 1000;  // there the force turns with the line
  double last_n = 0.0;
  for (std::size_t k = 0; k < run.states.size(); ++k) {
    const double force_n = guide_n(run.states[k]);
    if ((run.states[k].flags & kFlagArmed) == 0) {
      EXPECT_EQ(force_n, 0.0) << k;
    }
    if (k < kFirstCorner) {
      EXPECT_LE(force_n - last_n, 0.03) << k;  // a fiftieth of the governor's limit
    }
    last_n = force_n;
  }
  EXPECT_EQ(run.states.back().guide, GuidePhase::leading);
}

TEST(Guide, TakesUpAHandFromAfarWhateverItWeighs) {
  // 0.5 kg at 0.2 m/s could not be stopped by 1 N within the 5 mm at which a hand is let go.
  for (const double speed : {0.02, 0.1})
    for (const double mass : {0.05, 0.5}) {
      HapticRenderer renderer = level_stone();
      ask(renderer, guide_along(square(), true, kForce_n, speed));
      const GuidedRun run = test::run(renderer, {.mass_kg = mass, .start_m = {-0.002, 0.001}}, 3.0, kForce_n * speed);
      EXPECT_TRUE(std::none_of(run.states.begin(), run.states.end(),
                               [](const State& s) { return s.guide == GuidePhase::let_go; }))
          << speed << " m/s, " << mass << " kg";
      const bool there = std::any_of(run.places_m.begin(), run.places_m.end(), [](const Vector2d& hand) {
        return test::distance_to(square(), true, hand) < kWithin_m;
      });
      EXPECT_TRUE(there) << speed << " m/s, " << mass << " kg";
      EXPECT_LE(run.strongest_n, kForce_n + 1e-9);
    }
}

TEST(Guide, WaitsForAHandThatIsFarAway) {
  HapticRenderer renderer = level_stone();
  ask(renderer, guide_along(test::star(12, 0.002, 0.002), true));
  const GuidedRun run = test::run(renderer, {.start_m = {0.03, 0.02}}, 2.0, 0.0);
  EXPECT_EQ(run.strongest_n, 0.0);
  EXPECT_EQ(run.states.back().guide, GuidePhase::waiting);
}

TEST(Guide, ThatIsResistedNeverExceedsItsForceAndGivesNothing) {
  for (const double grip_n_per_m : {300.0, 3000.0}) {
    HapticRenderer renderer = level_stone();
    ask(renderer, guide_along(square(), true));
    GuidedHand hand{.damping_n_s_per_m = 5.0, .start_m = {-0.0195, 0.0}};
    hand.own_n = [&](double, const Vector2d& place) {
      return Vector2d(-grip_n_per_m * (place - Vector2d(-0.0195, 0.0)));
    };
    const GuidedRun run = test::run(renderer, hand, 6.0, 0.0);
    EXPECT_LE(run.strongest_n, kForce_n + 1e-9);
    EXPECT_GT(run.strongest_n, 0.3 * kForce_n) << "it is felt";
    EXPECT_LE(run.delivered_j, kStored_j + 0.5 * kForce_n * kForce_n / grip_n_per_m) << "what the grip's spring holds";
  }
}

TEST(Guide, LetsAHandGoThatLeavesAndTakesItUpAgainOnlyNearTheLine) {
  HapticRenderer renderer = level_stone();
  ask(renderer, guide_along(square(), true));
  GuidedHand hand{.start_m = {-0.02, 0.0}};
  // After 2 s it goes inwards, at 6 s it rests away from the line, at 8 s it comes back.
  hand.own_n = [](double t, const Vector2d& place) {
    const Vector2d aim = t < 8.0 ? Vector2d(0.0, 0.0) : Vector2d(-0.0205, place.y());
    const Vector2d pull = 400.0 * (aim - place);
    if (t < 2.0) return Vector2d(0.0, 0.0);
    return pull.norm() > 2.0 ? Vector2d(2.0 * pull.normalized()) : pull;
  };
  const GuidedRun run = test::run(renderer, hand, 10.0, kForce_n * kSpeed);
  EXPECT_EQ(run.states[1900].guide, GuidePhase::leading);
  EXPECT_LE(run.strongest_n, kForce_n + 1e-9);
  std::size_t let_go = 0;
  for (std::size_t k = 2000; k < 8000 && let_go == 0; ++k)
    if (run.states[k].guide == GuidePhase::let_go) let_go = k;
  ASSERT_GT(let_go, 2000U);
  EXPECT_LT(let_go, 3000U);
  for (std::size_t k = let_go + 200; k < 8000; ++k) ASSERT_EQ(guide_n(run.states[k]), 0.0) << k;
  EXPECT_LT(run.places_m[7900].norm(), 0.001) << "where the hand wanted to be";
  EXPECT_EQ(run.states.back().guide, GuidePhase::leading);
}

TEST(Guide, LetsAHandGoThatIsLifted) {
  HapticRenderer renderer = level_stone();
  ask(renderer, guide_along(square(), true));
  GuidedHand hand{.start_m = {-0.02, 0.0}};
  EXPECT_EQ(test::run(renderer, hand, 1.0, 1.0).states.back().guide, GuidePhase::leading);
  hand.height_m = 0.03;
  const GuidedRun run = test::run(renderer, hand, 1.0, 1.0);
  EXPECT_EQ(run.states.back().guide, GuidePhase::let_go);
  EXPECT_EQ(guide_n(run.states.back()), 0.0);
}

TEST(Guide, IsZeroWhenTurnedOffOnFaultsOnStaleHandsAndOnPlacesThatAreNoNumbers) {
  const auto led = [] {
    HapticRenderer renderer = level_stone();
    ask(renderer, guide_along(square(), true));
    const GuidedRun run = test::run(renderer, {.start_m = {-0.019, 0.0}}, 1.0, 1.0);
    EXPECT_GT(guide_n(run.states.back()), 0.0);
    return renderer;
  };
  const auto told = [](const HapticRenderer& renderer) {
    const auto& f = renderer.state().commanded_force_n;
    return std::hypot(f[0], f[1], f[2]);
  };
  const Eigen::Vector3d place(-0.019, 0.0, 0.005);
  {
    HapticRenderer renderer = led();
    ask(renderer, [] {
      Command off;
      off.kind = Command::Kind::guide;
      return off;
    }());
    renderer.update(sample_at(place, 1.0), 0.001);
    EXPECT_EQ(told(renderer), 0.0);
    EXPECT_EQ(renderer.state().guide, GuidePhase::off);
  }
  {
    HapticRenderer renderer = led();
    renderer.fault();
    renderer.update(sample_at(place, 1.0), 0.001);
    EXPECT_EQ(told(renderer), 0.0);
  }
  {
    HapticRenderer renderer = led();
    DeviceSample stale = sample_at(place, 1.0);
    stale.fresh = false;
    for (int k = 0; k < 7; ++k) {
      stale.time_s = 1.0 + 1e-3 * k;
      renderer.update(stale, 0.001);
    }
    EXPECT_EQ(told(renderer), 0.0);
  }
  {
    HapticRenderer renderer = led();
    renderer.update(sample_at({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, 1.0), 0.001);
    EXPECT_EQ(told(renderer), 0.0);
    renderer.update(sample_at(place, 1.001), 0.001);
    EXPECT_EQ(told(renderer), 0.0) << "free space first";
  }
}

TEST(Guide, IsZeroWhenTheViewChangesAndGoesOnWhenOnlyTilesDo) {
  const scene::ScenePointer scene = test::flat_scene();
  for (const bool same : {false, true}) {
    HapticRenderer renderer(DeviceInfo{}, RendererOptions{}, window_on(scene, 0, 1, false));
    ask(renderer, guide_along(square(), true));
    const GuidedRun run = test::run(renderer, {.start_m = {-0.019, 0.0}}, 1.0, 1.0);
    const double before_n = guide_n(run.states.back());
    Command swap;
    swap.kind = Command::Kind::swap;
    swap.window = window_on(scene, 0, 2, false);
    swap.move = true;
    swap.centre_m = {same ? 0.05 : 0.051, 0.05};
    static_cast<void>(renderer.apply(swap));
    const auto& at = run.states.back().device_m;
    renderer.update(sample_at({at[0], at[1], at[2]}, 1.0), 0.001);
    if (same) {
      EXPECT_NEAR(guide_n(renderer.state()), before_n, 0.05);
    } else {
      EXPECT_EQ(guide_n(renderer.state()), 0.0);
    }
  }
}

TEST(Guide, GivesNoMoreEnergyThanItsBooksToHandsThatTryToTakeIt) {
  // Hands that swing across and along the line at many rhythms, with late loops and hardly any damping.
  for (const double delay : {0.001, 0.003})
    for (const double hertz : {1.0, 3.0, 8.0, 20.0})
      for (const double mass : {0.05, 0.5}) {
        HapticRenderer renderer = level_stone();
        ask(renderer, guide_along(square(), true));
        GuidedHand hand{
            .mass_kg = mass, .damping_n_s_per_m = 0.5, .friction_n = 0.0, .delay_s = delay, .start_m = {-0.0195, 0.0}};
        hand.own_n = [hertz](double t, const Vector2d&) {
          return Vector2d(0.4 * std::sin(6.2831853 * hertz * t), 0.4 * std::sin(6.2831853 * 1.3 * hertz * t));
        };
        const GuidedRun run = test::run(renderer, hand, 10.0, kForce_n * kSpeed);
        EXPECT_LE(run.delivered_j, kStored_j) << hertz << " Hz, " << mass << " kg, " << delay << " s";
        EXPECT_LE(run.strongest_n, kForce_n + 1e-9);
      }
}

TEST(GuidePath, RefusesWhatIsNoLine) {
  EXPECT_ANY_THROW(GuidePath(std::vector<Vector2d>{{0.0, 0.0}}));
  EXPECT_ANY_THROW(GuidePath(std::vector<Vector2d>{{0.0, 0.0}, {0.0, 0.0}}));
  EXPECT_ANY_THROW(GuidePath(std::vector<Vector2d>{{0.0, 0.0}, {std::numeric_limits<double>::quiet_NaN(), 0.0}}));
  EXPECT_FALSE(GuidePath(std::vector<Vector2d>{{0.0, 0.0}, {1.0, 0.0}, {1.0, 0.0}}).closed());
  EXPECT_TRUE(GuidePath(std::vector<Vector2d>{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 0.0}}).closed());
}

}  // namespace
}  // namespace sparsha::haptics
