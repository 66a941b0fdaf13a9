// The mouse as a hand on deep forms: it lands where the mouse points, and a press without movement stays gentle.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "haptics/window/window.h"
#include "relief_scene.h"
#include "scene/workspace.h"
#include "viewer/hand.h"
#include "viewer/surface/touch_ground.h"

namespace sparsha::viewer::test {
namespace {

/// A figure as deep as it is wide: a body, an arm in front of it, wings behind, ground that was never measured.
double figure(double x_m, double y_m) {
  const double x = (x_m - 0.2) / 0.2, y = (y_m - 0.2) / 0.2;
  const auto dome = [](double u, double v, double height) {
    const double r = u * u + v * v;
    return r < 1.0 ? height * std::sqrt(1.0 - r) : -1.0;
  };
  double h = std::max({dome(x / 0.35, y / 0.9, 0.10), dome((x - 0.2) / 0.12, (y - 0.1) / 0.5, 0.05) + 0.11,
                       dome((std::abs(x) - 0.55) / 0.4, (y - 0.3) / 0.5, 0.02)});
  if (dome((x - 0.2) / 0.12, (y - 0.1) / 0.5, 0.05) < 0.0)
    h = std::max(dome(x / 0.35, y / 0.9, 0.10), dome((std::abs(x) - 0.55) / 0.4, (y - 0.3) / 0.5, 0.02));
  return h < 0.0 ? std::nan("") : h;
}

TEST(Press, LandsWhereTheMousePointsAndStaysGentleOnDeepForms) {
  const auto scene = scene_of(figure, 401, 0.4, 200);
  const pipeline::SceneDescription& description = scene->description();
  const Stage stage = stage_of(description);
  const haptics::WindowPlan plan = haptics::plan_window(description, static_cast<int>(description.levels.size()) - 1,
                                                        {0.2, 0.2}, pipeline::kDeskWorkspace_m);
  const haptics::HapticWindow window = haptics::load_window(*scene, plan, 1);
  const haptics::MongeSurface& surface = *window.surface;
  haptics::State state = touching(*scene, 0.2, 0.2, 0.1, 0.2, 0.2);
  state.level = static_cast<std::uint64_t>(plan.level);
  state.window = {plan.i0, plan.j0, plan.nx, plan.ny};
  state.scale = plan.scale;
  state.tip_radius_m = plan.tip_radius_m;
  state.stiffness_n_per_m = 800.0;
  state.centre_m = {surface.centre_m.x(), surface.centre_m.y(), surface.centre_m.z()};
  TouchGround ground;
  ground.follow(scene, state, true);
  const auto height_at = [&](double x_m, double y_m) { return ground.height_at(x_m, y_m).value(); };
  // What the viewer reads is what the servo renders, inside the window and where it is continued beyond its border.
  std::mt19937 random(14);
  std::uniform_real_distribution<double> across(-0.05, 0.45);  // the hand reaches beyond the stone
  for (int k = 0; k < 1000; ++k) {
    const double x = across(random), y = across(random);
    ASSERT_NEAR(height_at(x, y),
                surface.lattice.origin_m.z() +
                    surface.height(x - surface.lattice.origin_m.x(), y - surface.lattice.origin_m.y()),
                1e-6);
  }
  std::uniform_real_distribution<double> pixel_x(60.0, 850.0), pixel_y(40.0, 620.0), angle(-0.9, 0.9);
  PointerHand hand;
  int inside = 0;
  for (int press = 0; press < 300; ++press) {
    Camera camera;
    camera.turn_rad = press % 3 == 0 ? 0.0 : angle(random);
    camera.tilt_rad = press % 3 == 0 ? 0.0 : angle(random);
    camera.distance = 2.6;
    const View view = make_view(camera, 908, 666);
    const Eigen::Vector2d mouse(pixel_x(random), pixel_y(random));
    const auto run = [&](double seconds) {
      haptics::PointerSample sample;
      for (double t = 0.0; t < seconds; t += 1.0 / 60.0)
        sample = hand.update(1.0 / 60.0, state, description, stage, 0.05, height_at);
      return sample;
    };
    hand.aim(view.ray(mouse.x(), mouse.y()));
    run(0.3);
    hand.press(true);
    const haptics::PointerSample sample = run(0.6);
    // Straight below the hand lies the surface it went down through: the proxy is no farther than that.
    const double x = state.centre_m[0] + sample.device_m[0] / state.scale;
    const double y = state.centre_m[1] + sample.device_m[1] / state.scale;
    const double depth_m = state.scale * (height_at(x, y) - state.centre_m[2]) - sample.device_m[2];
    EXPECT_LE(depth_m * state.stiffness_n_per_m, 3.0) << press;
    const bool at_rim = std::abs(sample.device_m[0]) > 0.0499 || std::abs(sample.device_m[1]) > 0.0499 ||
                        std::abs(sample.device_m[2]) > 0.0499;
    if (!at_rim) {
      ++inside;
      const auto seen = view.to_pixel(stage.to_world({x, y, height_at(x, y)}));
      ASSERT_TRUE(seen);
      EXPECT_LT((*seen - mouse).norm(), 3.0) << press << " at " << mouse.transpose();
    }
    hand.press(false);
    run(0.2);
  }
  EXPECT_GT(inside, 100);
}

}  // namespace
}  // namespace sparsha::viewer::test
