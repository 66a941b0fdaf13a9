// Parts of any shape as they are felt: the same as a box where they are the same, and smooth across every border.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "haptics/effects/surface_effects.h"
#include "haptics/window/window.h"
#include "tests/support/part_scenes.h"
#include "tests/support/servo_parts.h"
#include "tests/support/test_folder.h"

namespace sparsha::haptics {
namespace {

scene::PartTouch firm() {
  scene::PartTouch touch;
  touch.stiffness_n_per_m = 400.0;
  touch.mu_dynamic = 0.6;
  touch.material = scene::Material::wood;
  return touch;
}

const auto kFriction = [](scene::SceneDescription& d) {
  d.config.haptics.tip_radius_m = 0.0;
  d.config.friction = scene::FrictionConfig{};
  d.config.friction->law = scene::FrictionConfig::Law::constant;
  d.config.friction->mu_0 = d.config.friction->mu_static = 0.1;
};

DeviceInfo damped() {
  DeviceInfo info;
  info.limits.least_damping_n_s_per_m = 10.0;  // that the limit does not decide
  return info;
}

TEST(PartShape, AsAPolygonIsFeltAsTheSameBoxToTheLastBitsButOutsideItsCorners) {
  SurfaceEffects box, polygon;
  box.border_m = polygon.border_m = 0.002;
  const std::vector<std::array<double, 2>> corners{{0.02, 0.01}, {0.05, 0.01}, {0.05, 0.07}, {0.02, 0.07}};
  box.parts.push_back({{0.02, 0.01, 0.05, 0.07}, 300.0, scene::Material::bronze});
  polygon.parts.push_back(
      {scene::Area(std::make_shared<const scene::Polygon>(corners)), 300.0, scene::Material::bronze});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(0.015, 0.055), y(0.005, 0.075);
  int between = 0;
  for (int k = 0; k < 20000; ++k) {
    const double px = x(random), py = y(random);
    const bool corner = (px < 0.02 || px > 0.05) && (py < 0.01 || py > 0.07);
    const double felt = box.stiffness_at({px, py, 0.0}, 800.0);
    between += felt > 300.0 && felt < 800.0 ? 1 : 0;
    EXPECT_NEAR(polygon.stiffness_at({px, py, 0.0}, 800.0), felt, corner ? 0.1 * 500.0 : 1e-9);
    EXPECT_NEAR(polygon.grain_gain_at({px, py, 0.0}), box.grain_gain_at({px, py, 0.0}), corner ? 0.1 : 1e-12);
    EXPECT_EQ(polygon.material_at({px, py, 0.0}).name, box.material_at({px, py, 0.0}).name) << px << ' ' << py;
  }
  EXPECT_GT(between, 500);
}

TEST(PartShape, OfAPolygonAndALabelIsFeltInsideAndNotInItsNotch) {
  const test::TestFolder folder;
  const auto scene = test::els(folder / "labels.png", firm(), kFriction);
  const HapticWindow window = load_window(*scene, plan_window(scene->description(), 0, {0.05, 0.05}, 0.1), 1);
  struct Place {
    double x_m, y_m;
    bool inside;
  };
  for (const double left : {0.060, 0.010})
    for (const Place& at : {Place{left + 0.006, 0.035, true}, Place{left + 0.025, 0.016, true},
                            Place{left + 0.022, 0.032, false}, Place{left + 0.015, 0.045, false}}) {
      HapticRenderer renderer(damped(), RendererOptions{}, window);
      int tick = 0;
      const auto go = [&](double z_m) {
        renderer.update(sample_at({at.x_m - 0.05, at.y_m - 0.05, z_m}, 0.001 * tick++), 0.001);
        return renderer.state();
      };
      for (int k = 0; k < 100; ++k) go(0.01);
      const State state = go(-0.001);
      EXPECT_EQ(state.stiffness_n_per_m, at.inside ? 400.0 : 800.0) << at.x_m << ' ' << at.y_m;
      EXPECT_NEAR(state.friction_coefficient, at.inside ? 0.6 : 0.1, 1e-6);
    }
}

TEST(PartShape, ChangesTheForceAcrossItsBorderWithoutAJump) {
  const test::TestFolder folder;
  const auto scene = test::els(folder / "labels.png", firm(), kFriction);
  constexpr double kDepth_m = 0.002;
  for (const double left : {0.060, 0.010}) {
    HapticRenderer renderer(damped(), RendererOptions{},
                            load_window(*scene, plan_window(scene->description(), 0, {0.05, 0.05}, 0.1), 1));
    int tick = 0;
    const auto go = [&](double x_m, double y_m, double z_m) {
      renderer.update(sample_at({x_m - 0.05, y_m - 0.05, z_m}, 0.001 * tick++), 0.001);
      const auto& f = renderer.state().commanded_force_n;
      return Eigen::Vector3d(f[0], f[1], f[2]);
    };
    // Slantwise through the upright, the notch and the foot, round the inner corner.
    const Eigen::Vector2d from(left - 0.008, 0.045), to(left + 0.036, 0.001);
    for (int k = 0; k < 200; ++k) go(from.x(), from.y(), 0.01 - (0.01 + kDepth_m) * k / 200.0);
    Eigen::Vector3d last = go(from.x(), from.y(), -kDepth_m);
    double step_n = 0.0, least_n = 1e9;
    constexpr int kTicks = 1500;  // 40 mm/s
    for (int k = 0; k <= kTicks; ++k) {
      const Eigen::Vector2d at = from + (to - from) * k / kTicks;
      const Eigen::Vector3d force = go(at.x(), at.y(), -kDepth_m);
      if (k > 100) step_n = std::max(step_n, (force - last).norm());
      least_n = std::min(least_n, force.z());
      last = force;
    }
    // Friction's 0.6 x 0.8 N over 2 mm at 0.042 mm a tick, at most twice as steep as a straight line, and the
    // stiffness's 0.8 N over the governor's 0.12 s; a jump would be 0.4 N and more.
    EXPECT_LE(step_n, 2.0 * (0.5 * 0.042 / 2.0) + 1.5 * 0.8 / 120.0 + 0.02);
    EXPECT_LT(least_n, 0.9) << "the part was felt";
  }
}

TEST(PartShape, IsToldOfByACueWhereItBegins) {
  const test::TestFolder folder;
  const auto scene = test::els(folder / "labels.png", {}, [](scene::SceneDescription& d) {
    kFriction(d);
    d.config.cues = scene::CuesConfig{};
  });
  HapticRenderer renderer(damped(), RendererOptions{},
                          load_window(*scene, plan_window(scene->description(), 0, {0.05, 0.05}, 0.1), 1));
  int tick = 0;
  const auto entered = [&](double x_m, double y_m) {
    for (int k = 0; k < 1200; ++k)  // the same thing is told again only after a second elsewhere
      renderer.update(sample_at({x_m - 0.05, y_m - 0.05, -0.001}, 0.001 * tick++), 0.001);
    return renderer.state().cues[static_cast<std::size_t>(scene::Cue::part_entered)];
  };
  EXPECT_EQ(entered(0.082, 0.032), 0U) << "in the polygon's notch";
  EXPECT_EQ(entered(0.066, 0.032), 1U);
  EXPECT_EQ(entered(0.032, 0.032), 1U) << "in the label's notch";
  EXPECT_EQ(entered(0.016, 0.032), 2U);
}

}  // namespace
}  // namespace sparsha::haptics
