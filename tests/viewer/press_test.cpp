// The mouse as a hand on deep forms: it lands where the mouse points, and a press without movement stays gentle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "haptics/device/pointer/pointer_device.h"
#include "haptics/window/window.h"
#include "relief_scene.h"
#include "scene/frame/workspace.h"
#include "scene/scene.h"
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
  const scene::SceneDescription& description = scene->description();
  const Stage stage = stage_of(description);
  const haptics::WindowPlan plan = haptics::plan_window(description, static_cast<int>(description.levels.size()) - 1,
                                                        {0.2, 0.2}, scene::kDeskWorkspace_m);
  const haptics::HapticWindow window = haptics::load_window(*scene, plan, 1);
  const haptics::MongeSurface& surface = *window.surface;
  haptics::State state = touching(*scene, 0.2, 0.2, 0.1, 0.2, 0.2);
  state.level = static_cast<std::uint64_t>(plan.level);
  state.window = {plan.i0, plan.j0, plan.nx, plan.ny};
  state.scale = plan.scale;
  state.tip_radius_m = plan.tip_radius_m;
  state.stiffness_n_per_m = 800.0;
  state.flags |= haptics::kFlagFalls;
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
      const auto seen = view.to_pixel(stage.to_world({x, y, std::max(height_at(x, y), description.height_min_m)}));
      ASSERT_TRUE(seen);
      EXPECT_LT((*seen - mouse).norm(), 3.0) << press << " at " << mouse.transpose();
    }
    hand.press(false);
    run(0.2);
  }
  EXPECT_GT(inside, 100);
}

/// A hill whose foot is far below its top, for a window that goes from one to the other.
double hill(double x_m, double y_m) {
  return 0.3 * std::exp(-(std::pow(x_m - 0.3, 2) + std::pow(y_m - 0.2, 2)) / 0.01);
}

haptics::State told_of(const haptics::WindowPlan& plan, double stiffness_n_per_m) {
  haptics::State state;
  state.tick = 1000;
  state.workspace_m = scene::kDeskWorkspace_m;
  state.level = static_cast<std::uint64_t>(plan.level);
  state.window = {plan.i0, plan.j0, plan.nx, plan.ny};
  state.scale = plan.scale;
  state.tip_radius_m = plan.tip_radius_m;
  state.stiffness_n_per_m = stiffness_n_per_m;
  state.flags = haptics::kFlagTexture;
  return state;
}

// At a new window the servo keeps the hand and the stone under it where they are in the workspace: the height of the
// centre jumps. Until the viewer has read that window too, its old ground says nothing about the place.
TEST(Press, NeverGoesDeeperWhileTheWindowUnderItChanges) {
  const auto scene = scene_of(hill, 401, 0.4, 60);
  const scene::SceneDescription& description = scene->description();
  const Stage stage = stage_of(description);
  const auto steps = haptics::zoom_steps(description, scene::kDeskWorkspace_m);
  ASSERT_GE(steps.size(), 2U);
  const double reach_m = 0.5 * scene::kDeskWorkspace_m;
  for (const Eigen::Vector2d& from_m : {Eigen::Vector2d(0.1, 0.2), Eigen::Vector2d(0.3, 0.2)}) {
    const Eigen::Vector2d to_m(0.4 - from_m.x(), 0.2);
    for (const bool zooms : {false, true}) {
      const haptics::ZoomStep& near = steps.back();
      const auto plan = [&](const haptics::ZoomStep& step, const Eigen::Vector2d& at_m) {
        return haptics::plan_window(description, step, at_m, scene::kDeskWorkspace_m);
      };
      haptics::State state = told_of(plan(zooms ? steps.front() : near, from_m), 800.0);
      state.centre_m = {from_m.x(), from_m.y(), hill(from_m.x(), from_m.y())};
      TouchGround ground;
      ground.follow(scene, state, true);
      const auto height_at = [&](double x_m, double y_m) { return ground.height_at(x_m, y_m).value_or(std::nan("")); };
      PointerHand hand;
      haptics::PointerSample sample;
      const auto run = [&](double seconds, double frame_s) {
        for (double t = 0.0; t < seconds; t += frame_s)
          sample = hand.update(frame_s, state, description, stage, reach_m, height_at);
      };
      run(0.5, 1.0 / 60.0);
      hand.press(true);
      run(0.6, 1.0 / 60.0);
      const double stone_m = state.scale * (height_at(from_m.x(), from_m.y()) - state.centre_m[2]);
      ASSERT_GT((stone_m - sample.device_m[2]) * state.stiffness_n_per_m, 1.0) << "it presses";
      // The window goes to the other place, and what lies there comes to where the stone was.
      state = told_of(plan(near, to_m), 800.0);
      state.centre_m = {to_m.x(), to_m.y(), 0.0};
      TouchGround truth;
      truth.follow(scene, state, true);
      state.centre_m[2] = truth.height_at(to_m.x(), to_m.y()).value() - stone_m / state.scale;
      ground.follow(scene, state, false);
      for (int frame = 0; frame < 5; ++frame) {
        run(0.08, 0.08);
        EXPECT_LE((stone_m - sample.device_m[2]) * state.stiffness_n_per_m, 3.0) << from_m.x() << ", frame " << frame;
      }
      ground.follow(scene, state, true);
      for (int frame = 0; frame < 60; ++frame) {
        run(0.016, 0.016);
        EXPECT_LE((stone_m - sample.device_m[2]) * state.stiffness_n_per_m, 3.0) << from_m.x() << ", frame " << frame;
      }
      EXPECT_GT((stone_m - sample.device_m[2]) * state.stiffness_n_per_m, 1.0) << "it still presses";
    }
  }
}

// What comes between two pictures, only the device can answer: stone that rises under the hand, and a place sent that
// is far inside.
TEST(Press, TheDeviceGivesWayToMoreThanAPress) {
  for (const double stiffness : {200.0, 800.0, 2500.0})
    for (const double most_n : {2.7, 5.0}) {
      const auto pointer = std::make_shared<haptics::Seqlock<haptics::PointerSample>>();
      const auto device = haptics::make_pointer_device(pointer);
      haptics::PointerSample sample;
      sample.device_m = {0.0, 0.0, 0.01};
      sample.most_force_n = most_n;
      sample.stiffness_n_per_m = stiffness;
      sample.sequence = 1;
      pointer->publish(sample);
      double stone_m = 0.0, greatest_n = 0.0, force_n = 0.0;
      for (int tick = 0; tick < 1500; ++tick) {
        if (tick == 100) sample.device_m[2] = -0.03;
        if (tick == 1000) sample.device_m[2] = stone_m - 1.0 / stiffness;
        sample.sequence++;
        pointer->publish(sample);
        if (tick > 300 && tick < 800) stone_m += 5e-5;  // as fast as the window moves at the rim
        force_n = stiffness * std::max(0.0, stone_m - device->read(0.001 * tick, 0.001).position_m.z());
        device->write({0.0, 0.0, force_n});
        greatest_n = std::max(greatest_n, force_n);
        if (tick == 999) {
          EXPECT_NEAR(force_n, most_n, 0.01) << "it presses as far as it may";
        }
      }
      EXPECT_LE(greatest_n, most_n + 0.3) << stiffness;
      EXPECT_NEAR(force_n, 1.0, 0.01) << "and follows again";
    }
}

}  // namespace
}  // namespace sparsha::viewer::test
