// Hands that are led around whole objects, on all sides; judged by the formulas of the line and the object.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "haptics/guide/guide_path.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/objects.h"
#include "haptics/window/window.h"
#include "tests/support/servo_parts.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;

constexpr double kRadius_m = 0.04;  // of the ball, at the hand as in the scene
constexpr double kForce_n = 1.0;
constexpr double kSpeed = 0.06;  // m/s
constexpr double kWithin_m = 0.002;

/// A circle of a ball about the origin, all in one plane.
struct Circle {
  Vector3d axis = Vector3d::UnitZ();
  double off_m = 0.0;  // of its plane from the ball's middle

  [[nodiscard]] double radius_m() const { return std::sqrt(kRadius_m * kRadius_m - off_m * off_m); }
  [[nodiscard]] Vector3d at(double angle) const {
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis);
    return off_m * axis + radius_m() * (turn * Vector3d(std::cos(angle), std::sin(angle), 0.0));
  }
  /// Across the ball's surface, of a place at any height.
  [[nodiscard]] double distance_m(const Vector3d& place_m) const {
    const Vector3d on_ball = kRadius_m * place_m.normalized();
    const double aside =
        std::hypot((on_ball - axis.dot(on_ball) * axis).norm() - radius_m(), axis.dot(on_ball) - off_m);
    return aside;
  }
  [[nodiscard]] GuidePath path() const {
    constexpr int kCorners = 240;
    std::vector<PathCorner> corners;
    for (int k = 0; k <= kCorners; ++k) {
      const Vector3d place_m = at(2.0 * std::numbers::pi * (k % kCorners) / kCorners);
      corners.push_back({place_m, place_m.normalized()});
    }
    return GuidePath(corners);
  }
};

/// A hand in space that presses towards the middle of the ball.
struct Hand {
  double mass_kg = 0.15, damping_n_s_per_m = 2.0, delay_s = 0.001;
  double presses_n = 0.5;
};

struct Led {
  std::vector<Vector3d> places_m;  // object frame, every millisecond
  std::vector<State> states;
  double most_along_normal_n = 0.0;  // of the guide's force
  double strongest_n = 0.0;          // of the guide's force
  double delivered_j = 0.0;          // most beyond what presses and what leads gave, from any moment on
};

HapticRenderer ball_under_hand(const scene::ScenePointer& scene) {
  HapticWindow window = load_window(*scene, plan_window(scene->description(), 0, {0.0, 0.0}, 0.1), 1);
  return {DeviceInfo{}, RendererOptions{}, std::move(window)};
}

scene::ScenePointer ball() {
  return test::whole_scene(test::ball_charts(kRadius_m, 0.001), 0.1, [](scene::SceneDescription& d) {
    d.config.around = scene::AroundConfig{};
    d.config.haptics.solver = scene::HapticsConfig::Solver::exact;
  });
}

/// Device frame = object frame turned about the device's place of the ball's middle.
Led lead(HapticRenderer& renderer, const Hand& hand, const Vector3d& start_m, double duration_s) {
  constexpr double kStep = 50e-6;
  constexpr int kSteps = 20;
  Led led;
  std::deque<std::pair<double, Vector3d>> on_the_way;
  Vector3d held = Vector3d::Zero(), place = start_m, velocity = Vector3d::Zero();
  double work_j = 0.0, least_j = 0.0;
  const auto middle = [&] {  // of the ball, device frame
    const State& state = renderer.state();
    const Eigen::Quaterniond turn(state.turn[3], state.turn[0], state.turn[1], state.turn[2]);
    return Vector3d(-(turn * Vector3d(state.centre_m[0], state.centre_m[1], state.centre_m[2])) * state.scale);
  };
  for (int tick = 0; tick < static_cast<int>(duration_s * 1000.0); ++tick) {
    const double now = 0.001 * tick;
    renderer.update(sample_at(place, now), 0.001);
    const State& state = renderer.state();
    const Vector3d told(state.commanded_force_n[0], state.commanded_force_n[1], state.commanded_force_n[2]);
    on_the_way.emplace_back(now + hand.delay_s, told);
    led.states.push_back(state);
    led.places_m.emplace_back(state.hip_m[0], state.hip_m[1], state.hip_m[2]);
    const Vector3d out = (place - middle()).normalized();
    const Vector3d guide_n(state.guide_n[0], state.guide_n[1], state.guide_n[2]);
    led.strongest_n = std::max(led.strongest_n, guide_n.norm());
    led.most_along_normal_n = std::max(led.most_along_normal_n, std::abs(guide_n.dot(out)));
    for (int step = 0; step < kSteps; ++step) {
      const double t = now + step * kStep;
      while (!on_the_way.empty() && on_the_way.front().first <= t) {
        held = on_the_way.front().second;
        on_the_way.pop_front();
      }
      const Vector3d from_middle = place - middle();
      Vector3d pull = held - hand.damping_n_s_per_m * velocity;
      if (now > 0.3) pull -= hand.presses_n * from_middle.normalized();
      velocity += pull * (kStep / hand.mass_kg);
      place += velocity * kStep;
      work_j += held.dot(velocity) * kStep - kForce_n * kSpeed * kStep;
      least_j = std::min(least_j, work_j);
      led.delivered_j = std::max(led.delivered_j, work_j - least_j);
    }
  }
  return led;
}

Command guide_along(const Circle& circle) {
  Command command;
  command.kind = Command::Kind::guide;
  command.guide = std::make_shared<const Guide>(Guide{circle.path(), kForce_n, kSpeed});
  return command;
}

void expect_led(const Led& led, const Circle& circle, const std::string& which) {
  std::size_t taken_up = 0;
  while (taken_up < led.states.size() && led.states[taken_up].guide != GuidePhase::leading) ++taken_up;
  ASSERT_LT(taken_up, 1500U) << which;
  std::size_t near = 0;
  std::vector<bool> passed(120, false);
  for (std::size_t k = taken_up + 500; k < led.places_m.size(); ++k)
    near += circle.distance_m(led.places_m[k]) < kWithin_m;
  for (std::size_t angle = 0; angle < passed.size(); ++angle) {
    const Vector3d place_m = circle.at(2.0 * std::numbers::pi * static_cast<double>(angle) / 120.0);
    passed[angle] = std::any_of(led.places_m.begin(), led.places_m.end(), [&](const Vector3d& hand_m) {
      return (kRadius_m * hand_m.normalized() - place_m).norm() < kWithin_m;
    });
  }
  EXPECT_GE(static_cast<double>(near), 0.95 * static_cast<double>(led.places_m.size() - taken_up - 500)) << which;
  EXPECT_GE(std::count(passed.begin(), passed.end(), true), 114) << which << ": of 120 places of the line";
  EXPECT_GE(led.states.back().guide_rounds, 1U) << which;
  EXPECT_LE(led.strongest_n, kForce_n + 1e-9) << which;
  EXPECT_LE(led.most_along_normal_n, 0.1 * kForce_n) << which;
  EXPECT_LE(led.delivered_j, kForce_n * 0.005 + kOverdraft_j) << which;
}

TEST(GuideAround, LeadsAHandAllAroundAnObjectHoweverTheLineLies) {
  const auto scene = ball();
  // Above all a circle through the far side, and a small one on the right.
  const std::vector<Circle> circles{{Vector3d::UnitZ(), 0.0},
                                    {Vector3d::UnitX(), 0.0},
                                    {Vector3d(1.0, 2.0, -1.5).normalized(), 0.01},
                                    {Vector3d::UnitX(), 0.03}};
  for (const Circle& circle : circles)
    for (const Hand& hand : {Hand{}, Hand{.mass_kg = 0.4, .damping_n_s_per_m = 6.0, .delay_s = 0.003}}) {
      HapticRenderer renderer = ball_under_hand(scene);
      Command ask = guide_along(circle);
      static_cast<void>(renderer.apply(ask));
      renderer.update(sample_at({0.0, 0.0, 0.03}, -0.001), 0.001);  // placed
      const State& state = renderer.state();
      // Beside the line, a little above the surface.
      const Vector3d off = (circle.at(0.3) + 0.003 * circle.axis).normalized() * (kRadius_m + 0.004);
      const Vector3d start_m = state.scale * (off - Vector3d(state.centre_m[0], state.centre_m[1], state.centre_m[2]));
      const double length_m = 2.0 * std::numbers::pi * circle.radius_m();
      const Led led = lead(renderer, hand, start_m, 3.0 + 2.5 * length_m / kSpeed);
      expect_led(led, circle,
                 "axis " + std::to_string(circle.axis.x()) + ' ' + std::to_string(circle.axis.y()) + ", off " +
                     std::to_string(circle.off_m) + ", " + std::to_string(hand.mass_kg) + " kg");
    }
}

TEST(GuideAround, LeadsAlongTheSameLineHoweverTheObjectIsTurned) {
  const auto scene = ball();
  const Circle circle{Vector3d(0.3, 1.0, 0.2).normalized(), 0.012};
  for (const Eigen::Quaterniond& turn :
       {Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitY())),
        Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Vector3d(1.0, -0.4, 0.7).normalized()))}) {
    HapticRenderer renderer = ball_under_hand(scene);
    Command ask = guide_along(circle);
    static_cast<void>(renderer.apply(ask));
    Command turned;
    turned.kind = Command::Kind::turn;
    turned.turn = turn;
    static_cast<void>(renderer.apply(turned));
    renderer.update(sample_at({0.0, 0.0, 0.03}, -0.001), 0.001);
    const State& state = renderer.state();
    ASSERT_NEAR(std::abs(Eigen::Quaterniond(state.turn[3], state.turn[0], state.turn[1], state.turn[2]).dot(turn)), 1.0,
                1e-12);
    const Vector3d off = (circle.at(2.0) + 0.003 * circle.axis).normalized() * (kRadius_m + 0.004);
    const Vector3d start_m =
        state.scale * (turn * (off - Vector3d(state.centre_m[0], state.centre_m[1], state.centre_m[2])));
    const Led led = lead(renderer, Hand{}, start_m, 3.0 + 2.5 * 2.0 * std::numbers::pi * circle.radius_m() / kSpeed);
    expect_led(led, circle, "turned");
  }
}

TEST(GuideAround, LetsAHandGoThatLeavesAndIsTurnedAway) {
  const auto scene = ball();
  const Circle circle{Vector3d::UnitZ(), 0.03};
  HapticRenderer renderer = ball_under_hand(scene);
  Command ask = guide_along(circle);
  static_cast<void>(renderer.apply(ask));
  double time_s = 0.0;
  const auto hold = [&](const Vector3d& object_m, int ticks) {
    for (int k = 0; k < ticks; ++k) {
      const State& state = renderer.state();
      const Vector3d centre_m(state.centre_m[0], state.centre_m[1], state.centre_m[2]);
      const Eigen::Quaterniond turn(state.turn[3], state.turn[0], state.turn[1], state.turn[2]);
      renderer.update(sample_at(state.scale * (turn * (object_m - centre_m)), time_s += 0.001), 0.001);
    }
  };
  const Vector3d line_m = circle.at(1.0);
  hold(1.1 * line_m, 300);
  EXPECT_EQ(renderer.state().guide, GuidePhase::leading);
  // Straight away from the surface.
  hold(1.8 * line_m, 100);
  EXPECT_EQ(renderer.state().guide, GuidePhase::let_go);
  hold(1.8 * line_m, 300);
  EXPECT_EQ(Vector3d(renderer.state().guide_n[0], renderer.state().guide_n[1], renderer.state().guide_n[2]).norm(),
            0.0);
  hold(1.05 * line_m, 1000);
  EXPECT_EQ(renderer.state().guide, GuidePhase::leading) << "taken up again on the line";
  // Another side comes before the hand: the force ends at once.
  Command turned;
  turned.kind = Command::Kind::turn;
  turned.turn = Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()));
  static_cast<void>(renderer.apply(turned));
  const State before = renderer.state();
  renderer.update(sample_at(Vector3d(before.device_m[0], before.device_m[1], before.device_m[2]), time_s += 0.001),
                  0.001);
  EXPECT_NE(renderer.state().guide, GuidePhase::leading);
  EXPECT_EQ(Vector3d(renderer.state().guide_n[0], renderer.state().guide_n[1], renderer.state().guide_n[2]).norm(),
            0.0);
}

}  // namespace
}  // namespace sparsha::haptics
