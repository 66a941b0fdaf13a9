// Parts of a scene with a stiffness, a friction and a material of their own: what is felt there and at their borders.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "haptics/effects/surface_effects.h"
#include "haptics/window/window.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

constexpr double kWidth_m = 0.1;
constexpr double kBorderX = 0.05;

/// A level stone of 0.1 m whose right half is a part.
scene::ScenePointer halves(const scene::PartTouch& touch, bool impact = false, bool turned = false) {
  return sparsha::test::scene_of([](double, double) { return 0.0; }, 201, kWidth_m, 201, Eigen::Vector3d::Zero(),
                                 [&](scene::SceneDescription& d) {
                                   d.config.haptics.impact = impact;
                                   d.config.haptics.tip_radius_m = 0.0;
                                   d.config.friction = scene::FrictionConfig{};
                                   d.config.friction->law = scene::FrictionConfig::Law::constant;
                                   d.config.friction->mu_0 = d.config.friction->mu_static = 0.1;
                                   d.config.parts.push_back({"right", "", {kBorderX, -1.0, 1.0, 1.0}, touch});
                                   if (!turned) return;
                                   // Parts were written when the stone lay the other way round.
                                   d.region_from_grid = Eigen::Matrix4d::Identity();
                                   (*d.region_from_grid)(0, 0) = (*d.region_from_grid)(1, 1) = -1.0;
                                   (*d.region_from_grid)(0, 3) = (*d.region_from_grid)(1, 3) = kWidth_m;
                                 });
}

HapticWindow window_of(const scene::ScenePointer& scene) {
  return load_window(*scene, plan_window(scene->description(), 0, {0.05, 0.05}, kWidth_m), 1);
}

/// A hand that goes along x at a constant depth; places in the stone's own metres.
class Traveller {
 public:
  explicit Traveller(const scene::ScenePointer& scene) : renderer_(info(), RendererOptions{}, window_of(scene)) {
    for (int i = 0; i < 60; ++i) go(0.03, 0.02);
  }
  const State& go(double x_m, double z_m) {
    renderer_.update(sample_at({x_m - 0.05, 0.0, z_m}, 0.001 * tick_++), 0.001);
    return renderer_.state();
  }
  HapticRenderer& renderer() { return renderer_; }

 private:
  static DeviceInfo info() {
    DeviceInfo info;
    info.limits.least_damping_n_s_per_m = 10.0;  // that the limit does not decide
    return info;
  }
  HapticRenderer renderer_;
  int tick_ = 0;
};

Eigen::Vector3d commanded(const State& state) {
  return {state.commanded_force_n[0], state.commanded_force_n[1], state.commanded_force_n[2]};
}

TEST(Part, WithItsOwnStiffnessAndFrictionIsFeltAcrossItsBorderWithoutAJump) {
  scene::PartTouch touch;
  touch.stiffness_n_per_m = 1200.0;
  touch.mu_dynamic = 0.4;
  constexpr double kDepth_m = 0.002;
  for (const double speed : {0.02, 0.1, 0.3})
    for (const double direction : {1.0, -1.0}) {
      Traveller hand(halves(touch));
      const double from = direction > 0 ? 0.02 : 0.08;
      for (int i = 0; i < 100; ++i) hand.go(from, -kDepth_m * i / 100);
      Eigen::Vector3d last = commanded(hand.go(from, -kDepth_m));
      const double begins_n = last.z();
      double step_n = 0.0;
      const auto ticks = static_cast<int>(0.06 / speed / 0.001);
      for (int i = 0; i <= ticks; ++i) {
        const Eigen::Vector3d force = commanded(hand.go(from + direction * 0.06 * i / ticks, -kDepth_m));
        if (i > 30) step_n = std::max(step_n, (force - last).norm());  // once it slides
        last = force;
      }
      for (int i = 0; i < 200; ++i) last = commanded(hand.go(from + direction * 0.06, -kDepth_m));
      const double ends_n = last.z();
      EXPECT_NEAR(direction > 0 ? begins_n : ends_n, 800.0 * kDepth_m, 1e-3) << speed;
      EXPECT_NEAR(direction > 0 ? ends_n : begins_n, 1200.0 * kDepth_m, 1e-3) << speed;
      // A smooth step is 1.5 times as steep in its middle as a straight one: friction's over the border, the
      // stiffness's over the governor's 0.12 s. Where friction falls, the proxy goes faster than the hand, by what it
      // lags less.
      const double friction_n = (0.4 * 1200.0 - 0.1 * 800.0) * kDepth_m * std::min(1.0, 1.5 * speed * 0.001 / 0.002);
      const double stiffness_n = 400.0 * kDepth_m * 1.5 * 0.001 / 0.12;
      const double faster = 1.0 + 1.5 * (0.4 - 0.1) * kDepth_m / 0.002;
      EXPECT_LE(step_n, faster * (friction_n + stiffness_n)) << speed;
      EXPECT_NEAR(std::abs(last.x()) / last.z(), direction > 0 ? 0.4 : 0.1, 1e-3) << speed;
    }
}

TEST(Part, KeepsItsStiffnessUnderAHandThatRestsOnItsBorder) {
  scene::PartTouch touch;
  touch.stiffness_n_per_m = 1200.0;
  Traveller hand(halves(touch));
  for (int i = 0; i <= 100; ++i) hand.go(kBorderX, -0.00002 * i);
  for (int i = 0; i < 300; ++i) hand.go(kBorderX, -0.002);
  EXPECT_NEAR(hand.go(kBorderX, -0.002).stiffness_n_per_m, 1000.0, 1e-6) << "half-way on the border itself";
  double least = 1e9;
  double most = 0.0;
  for (int i = 0; i < 500; ++i) {
    const double n_per_m = hand.go(kBorderX + (i * 7 % 3 - 1) * 20e-6, -0.002).stiffness_n_per_m;
    least = std::min(least, n_per_m);
    most = std::max(most, n_per_m);
  }
  EXPECT_LE(most - least, 0.02 * 1000.0 + 1.0);
}

TEST(Part, TurnsWithTheStone) {
  scene::PartTouch touch;
  touch.stiffness_n_per_m = 400.0;
  touch.mu_dynamic = 0.6;
  for (const bool turned : {false, true}) {
    Traveller hand(halves(touch, false, turned));
    for (const bool right : {false, true}) {
      const double x = right ? 0.08 : 0.02;
      for (int i = 0; i < 100; ++i) hand.go(x, 0.01);
      const State& state = hand.go(x, -0.001);
      EXPECT_EQ(state.stiffness_n_per_m, right != turned ? 400.0 : 800.0);
      EXPECT_NEAR(state.friction_coefficient, right != turned ? 0.6 : 0.1, 1e-6);
    }
  }
}

TEST(Part, FollowsTheUsersWishOfStiffness) {
  scene::PartTouch touch;
  touch.stiffness_n_per_m = 400.0;
  Traveller hand(halves(touch));
  Command command;
  command.kind = Command::Kind::stiffness;
  command.stiffness_n_per_m = 600.0;
  static_cast<void>(hand.renderer().apply(command));
  hand.go(0.02, 0.01);
  EXPECT_EQ(hand.go(0.02, 0.01).stiffness_n_per_m, 600.0);
  hand.go(0.08, 0.01);
  hand.go(0.08, 0.01);
  EXPECT_NEAR(hand.go(0.08, 0.01).stiffness_n_per_m, 300.0, 1e-9) << "three quarters there too";
}

TEST(Part, RingsAsWhatItIsMadeOf) {
  scene::PartTouch touch;
  touch.material = scene::Material::wood;
  const auto ring = [&](double x) {
    Traveller hand(halves(touch, true));
    for (int i = 0; i < 200; ++i) hand.go(x, 0.02 - 0.0001 * i);
    std::vector<double> rings;
    for (int i = 0; i < 20; ++i) {
      const State& state = hand.go(x, -0.00005 * i);
      rings.push_back(state.commanded_force_n[2] - state.force_n[2]);
    }
    return *std::max_element(rings.begin(), rings.end());
  };
  EXPECT_GT(ring(0.02), 1.2 * ring(0.08)) << "granite on the left, wood on the right";
  EXPECT_GT(ring(0.08), 0.2);
}

TEST(Part, ThatComesFirstWinsWhereTwoOverlap) {
  SurfaceEffects effects;
  effects.border_m = 0.001;
  effects.parts.push_back({{0.0, 0.0, 0.5, 1.0}, 300.0, scene::Material::bronze});
  effects.parts.push_back({{0.0, 0.0, 1.0, 1.0}, 900.0, scene::Material::wood});
  EXPECT_EQ(effects.stiffness_at({0.25, 0.5, 0.0}, 800.0), 300.0);
  EXPECT_EQ(effects.stiffness_at({0.75, 0.5, 0.0}, 800.0), 900.0);
  EXPECT_EQ(effects.stiffness_at({1.5, 0.5, 0.0}, 800.0), 800.0);
  EXPECT_EQ(effects.material_at({0.25, 0.5, 0.0}).name, "bronze");
  EXPECT_EQ(effects.material_at({0.75, 0.5, 0.0}).name, "wood");
  EXPECT_EQ(effects.material_at({1.5, 0.5, 0.0}).name, "granite");
}

}  // namespace
}  // namespace sparsha::haptics
