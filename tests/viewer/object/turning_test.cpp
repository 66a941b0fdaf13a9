// A whole object is turned in the hand by keys, buttons and the mouse.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include <Eigen/Core>

#include "tests/viewer/object/whole_objects.h"
#include "tests/viewer/studio.h"

namespace sparsha::viewer::test {
namespace {

using sparsha::test::ObjectPtr;

TEST(WholePicture, KeysAndButtonsTurnTheObjectInTheHand) {
  const ObjectPtr torus = sparsha::test::make_torus();
  haptics::RequestQueue requests;
  Connections connections;
  connections.requests = &requests;
  const auto has = [](const Controller& controller, Action action) {
    const std::vector<Action> buttons = controller.buttons();
    return std::ranges::find(buttons, action) != buttons.end();
  };
  Controller relief(connections, {});
  relief.set_scene(whole_scene(torus, {}));
  EXPECT_FALSE(has(relief, Action::turn_object_left)) << "one view cannot be turned";
  Controller controller(connections, {});
  controller.set_scene(whole_scene(torus, charts_of(*torus, 5'000, 0.1)));
  EXPECT_TRUE(has(controller, Action::turn_object_left));
  const auto asked = [&](int key, int modifiers) {
    controller.press({key, modifiers});
    return requests.take().value_or(haptics::Request{});
  };
  const haptics::Request left = asked(key::kLeft, kControl | kShift);
  EXPECT_EQ(left.kind, haptics::Request::Kind::turn);
  EXPECT_EQ(left.y, -45.0) << "what is in front goes left";
  EXPECT_EQ(asked(key::kRight, kControl | kShift).y, 45.0);
  EXPECT_EQ(asked(key::kUp, kControl | kShift).x, -45.0);
  EXPECT_EQ(asked(key::kDown, kControl | kShift).x, 45.0);
  EXPECT_EQ(asked(key::kPageUp, kControl).z, 45.0);
  EXPECT_EQ(asked(key::kPageDown, kControl).z, -45.0);
  EXPECT_EQ(asked(key::kHome, kControl).kind, haptics::Request::Kind::turn_back);
  controller.press({key::kLeft, kControl});
  EXPECT_FALSE(requests.take()) << "Control alone turns the camera";
}

TEST(WholePicture, ADragWithControlTurnsTheObjectAsItIsSeen) {
  const ObjectPtr torus = sparsha::test::make_torus();
  haptics::RequestQueue requests;
  Connections connections;
  connections.requests = &requests;
  const HeightAt flat = [](double, double) { return 0.0; };
  Controller relief(connections, {}), whole(connections, {});
  const scene::ScenePointer scene = whole_scene(torus, charts_of(*torus, 5'000, 0.1));
  relief.set_scene(whole_scene(torus, {}));
  whole.set_scene(scene);
  double time_s = 0.0;
  // From the middle of the picture, in as many steps as there are ways.
  const auto drag = [&](Controller& controller, int modifiers, const std::vector<Eigen::Vector2d>& ways) {
    const Layout layout = layout_of(1280, 720, controller.settings());
    const auto update = [&] { controller.update(time_s += 0.02, {}, 1280, 720, flat); };
    for (int k = 0; k < 60; ++k) update();
    const Stage stage = stage_of(scene->description());
    const View view = make_view(controller.frame().camera, layout.detail.width, layout.detail.height);
    Eigen::Vector2d at(layout.detail.x + 0.5 * layout.detail.width, layout.detail.y + 0.5 * layout.detail.height);
    controller.mouse_move(at.x(), at.y(), layout, view, stage, flat);
    controller.mouse_button(0, true, modifiers);
    for (const Eigen::Vector2d& way : ways) {
      at += way;
      controller.mouse_move(at.x(), at.y(), layout, view, stage, flat);
    }
    update();
    controller.mouse_button(0, false, modifiers);
    std::vector<haptics::Request> asked;
    while (const auto request = requests.take()) asked.push_back(*request);
    return asked;
  };
  const auto right = drag(whole, kControl, {{30.0, 0.0}, {70.0, 0.0}});
  ASSERT_EQ(right.size(), 1U) << "one turn a picture";
  EXPECT_EQ(right[0].kind, haptics::Request::Kind::turn);
  EXPECT_TRUE(right[0].on);
  EXPECT_NEAR(right[0].y, 35.0, 1e-9) << "what is in front goes right";
  EXPECT_NEAR(right[0].x, 0.0, 1e-9);
  const auto down = drag(whole, kControl, {{0.0, 40.0}});
  ASSERT_EQ(down.size(), 1U);
  EXPECT_NEAR(down[0].x, 14.0, 1e-9) << "what is in front goes down";
  const auto wild = drag(whole, kControl, {{5000.0, 0.0}});
  ASSERT_EQ(wild.size(), 1U);
  EXPECT_NEAR(wild[0].y, 180.0, 1e-9);
  EXPECT_TRUE(drag(whole, kControl, {{0.0, 0.0}}).empty());
  EXPECT_TRUE(drag(whole, 0, {{30.0, 0.0}}).empty()) << "without Control the camera turns";
  EXPECT_TRUE(drag(relief, kControl, {{30.0, 0.0}}).empty()) << "one view cannot be turned";
}

}  // namespace
}  // namespace sparsha::viewer::test
