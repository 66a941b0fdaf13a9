// What frames cost; figures for docs, asked for by SPARSHA_NIGHTLY=1.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>

#include "relief_scene.h"
#include "scene/scene.h"
#include "studio.h"
#include "tests/viewer/cloud/points.h"
#include "viewer/cloud/mode.h"

namespace sparsha::viewer::test {
namespace {

struct Cost {
  double wall_ms = 1e9;
  double cpu_ms = 1e9;  ///< all threads
};

template <typename Work>
Cost best_of(int rounds, Work work) {
  Cost best;
  for (int k = 0; k < rounds; ++k) {
    const auto wall = std::chrono::steady_clock::now();
    const std::clock_t cpu = std::clock();
    work();
    glFinish();
    best.cpu_ms = std::min(best.cpu_ms, 1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC);
    best.wall_ms = std::min(best.wall_ms,
                            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - wall).count());
  }
  return best;
}

TEST(Speed, FramesAt1280x720) {
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) GTEST_SKIP() << "figures only with SPARSHA_NIGHTLY=1";
  const auto scene =
      scene_of(lotus, {800, 800, 0.0005, 3}, [](scene::SceneDescription& d) { d.config.levels.window = 200; });
  const gl::OffscreenContext context;
  Picture picture;
  Gui gui;
  Controller controller({}, {});
  const auto height_at = [&](double x_m, double y_m) { return picture.height_at(x_m, y_m); };
  const gl::Target target(1280, 720, false);
  haptics::State state = touching(*scene, 0.2, 0.2, 0.01, 0.2, 0.2);
  controller.set_scene(scene);
  double time_s = 0.0;
  const auto frame = [&](bool interface) {
    state.proxy_m[0] += 1e-5;
    controller.update(time_s, state, 1280, 720, height_at);
    controller.frame().finished = false;
    picture.draw(controller.frame(), target.framebuffer(), 1280, 720);
    if (interface) gui.draw(controller.frame(), controller.buttons(), picture, 1280, 720, 0.016);
  };
  const auto print = [](const char* what, const Cost& cost) {
    std::cout << what << ": " << cost.wall_ms << " ms, " << cost.cpu_ms << " ms of processor\n";
  };
  print("prepare a scene of 800 x 800", best_of(3, [&] { picture.set_scene(scene); }));
  frame(true);
  time_s = 10.0;
  frame(true);
  frame(true);
  const Cost cached = best_of(40, [&] { frame(true); });
  print("cached frame", cached);
  print("cached frame without interface", best_of(40, [&] { frame(false); }));
  print("stone while the camera moves", best_of(10, [&] {
          controller.act(Action::turn_left);
          time_s += 0.05;
          frame(true);
        }));
  print("stone at rest, 2 x 2 samples", best_of(5, [&] {
          controller.act(Action::turn_left);
          time_s += 0.02;
          frame(true);
          time_s += 5.0;
          controller.update(time_s, state, 1280, 720, height_at);
          frame(true);
        }));
  print("turn the light", best_of(3, [&] {
          controller.act(Action::light_turn);
          frame(true);
        }));
  controller.act(Action::stereo);
  frame(true);
  print("stone in stereo while the camera moves", best_of(10, [&] {
          controller.act(Action::turn_left);
          time_s += 0.05;
          frame(true);
        }));
  time_s += 5.0;
  frame(true);
  print("cached frame in stereo", best_of(40, [&] { frame(true); }));
  EXPECT_LT(cached.cpu_ms, 200.0);
}

TEST(Speed, TheRawCloudOfTenMillionPointsTurns) {
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) GTEST_SKIP() << "figures only with SPARSHA_NIGHTLY=1";
  PointView view;
  constexpr int kSide = 3163;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const double x = 0.4 * i / kSide, y = 0.4 * j / kSide;
      view.points.emplace_back(Eigen::Vector3d(x, y, lotus(x, y)).cast<float>());
    }
  view.total = view.points.size();
  const gl::OffscreenContext context;
  std::unique_ptr<Workshop> workshop;
  std::cout << "arrange: " << best_of(1, [&] { workshop = std::make_unique<Workshop>(std::move(view)); }).wall_ms
            << " ms\n";
  Gui gui;
  CloudMode mode(workshop->orienting(), {});
  const gl::Target target(1280, 720, false);
  double time_s = 0.0;
  mode.controller().frame().finished = false;
  const auto frame = [&] { mode.draw(gui, {}, target.framebuffer(), 1280, 720, time_s += 0.05, true); };
  for (int k = 0; k < 30; ++k) frame();
  double sum_ms = 0.0, most_ms = 0.0;
  constexpr int kFrames = 200;
  for (int k = 0; k < kFrames; ++k) {
    mode.press({key::kLeft, kShift, true});
    const double ms = best_of(1, frame).wall_ms;
    sum_ms += ms;
    most_ms = std::max(most_ms, ms);
  }
  std::cout << "turning: " << sum_ms / kFrames << " ms a picture, at most " << most_ms << " ms, "
            << 100.0 * mode.picture().share_shown() << " % of the points\n";
  int frames = 0;
  while (!mode.picture().complete()) {
    frame();
    ++frames;
  }
  std::cout << "all points after " << frames << " pictures at rest\n";
}

TEST(Speed, EverySizeOfSceneAt1280x720) {
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) GTEST_SKIP() << "figures only with SPARSHA_NIGHTLY=1";
  std::printf("milliseconds of a picture: hand moves | camera moves | light key\n");
  for (const int nodes : {800, 4096, 8192}) {
    const double spacing_m = 0.4 / nodes;
    const auto scene =
        scene_of(lotus, {nodes, nodes, spacing_m, 6}, [](scene::SceneDescription& d) { d.config.levels.window = 200; });
    for (const bool stereo : {false, true})
      for (const bool whole : {false, true}) {
        ViewSettings settings;
        settings.stereo.mode = stereo ? StereoMode::anaglyph : StereoMode::off;
        Studio studio(scene, settings);
        Controller& controller = studio.controller();
        const gl::Target target(1280, 720, false);
        haptics::State state = touching(*scene, 0.2, 0.2, 0.01, 0.2, 0.2);
        if (whole) {
          state.window = {0, 0, nodes, nodes};
          state.scale = 0.1 / 0.4;
        }
        double time_s = 0.0;
        const auto frame = [&](double step_s, bool finished = false) {
          time_s += step_s;
          controller.update(time_s, state, 1280, 720,
                            [&](double x, double y) { return studio.picture().height_at(x, y); });
          controller.frame().finished = finished;
          studio.picture().draw(controller.frame(), target.framebuffer(), 1280, 720);
        };
        frame(1.0, true);
        frame(5.0, true);
        const double touch_ms = best_of(20, [&] {
                                  state.proxy_m[0] += spacing_m;
                                  frame(0.03);
                                }).wall_ms;
        const double orbit_ms = best_of(10, [&] {
                                  controller.act(Action::turn_left);
                                  frame(0.05);
                                }).wall_ms;
        frame(5.0, true);
        const double light_ms = best_of(5, [&] {
                                  controller.act(Action::light_turn);
                                  frame(0.0);
                                }).wall_ms;
        std::printf("%d x %d %s%s: %.1f | %.1f | %.1f\n", nodes, nodes, whole ? "whole" : "zoomed",
                    stereo ? " in stereo" : "", touch_ms, orbit_ms, light_ms);
        std::fflush(stdout);
      }
  }
}

}  // namespace
}  // namespace sparsha::viewer::test
