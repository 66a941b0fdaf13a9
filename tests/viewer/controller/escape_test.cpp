// Escape beside a touched scene: what it stops, and when it leaves.
#include <gtest/gtest.h>

#include "tests/viewer/relief_scene.h"
#include "viewer/controller/controller.h"

namespace sparsha::viewer::test {
namespace {

TEST(Controller, EscapeStopsADepthScanAndDoesNotLeaveJustAfterItsEnd) {
  const auto height = [](double x_m, double) { return 0.1 * x_m; };
  const scene::ScenePointer scene = scene_of(height, {201, 201, 0.001, 1});
  const haptics::State state = touching(*scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  bool busy = true;
  int stopped = 0;
  Connections connections;
  connections.orienting.status = [&] {
    OrientingStatus status;
    status.busy = busy;
    return status;
  };
  connections.orienting.cancel = [&] { ++stopped; };
  Controller controller(connections, {});
  controller.set_scene(scene);
  double time_s = 0.0;
  const auto run = [&](double seconds) { controller.update(time_s += seconds, state, 1280, 720, height); };
  run(10.0);
  run(2.0 * kLateStop_s);
  controller.press({key::kEscape});
  EXPECT_EQ(stopped, 1);
  EXPECT_FALSE(controller.wants_to_leave());
  // It has ended meanwhile: its scene has come.
  busy = false;
  controller.set_scene(scene);
  controller.press({key::kEscape});
  run(0.02);
  controller.press({key::kEscape});
  EXPECT_EQ(stopped, 1);
  EXPECT_FALSE(controller.wants_to_leave());
  run(kLateStop_s);
  controller.press({key::kEscape});
  EXPECT_TRUE(controller.wants_to_leave());
}

}  // namespace
}  // namespace sparsha::viewer::test
