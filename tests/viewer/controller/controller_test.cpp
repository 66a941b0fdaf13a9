// Keys and mouse to requests, settings and the pointer device's hand.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "tests/viewer/relief_scene.h"
#include "viewer/controller/controller.h"

namespace sparsha::viewer::test {
namespace {

using Kind = haptics::Request::Kind;

struct Desk {
  haptics::RequestQueue requests;
  haptics::AnnouncementBoard board;
  std::shared_ptr<haptics::Seqlock<haptics::PointerSample>> pointer =
      std::make_shared<haptics::Seqlock<haptics::PointerSample>>();
  std::vector<std::string> spoken;
  std::vector<Eigen::Matrix4d> rescans;
  scene::ScenePointer scene = scene_of([](double x_m, double) { return 0.1 * x_m; }, {201, 201, 0.001, 1});
  std::unique_ptr<Controller> controller;

  explicit Desk(ViewSettings settings = {}, bool with_pointer = true) {
    Connections connections;
    connections.requests = &requests;
    connections.announcements = &board;
    if (with_pointer) connections.pointer = pointer;
    connections.speak = [this](const std::string& text) { spoken.push_back(text); };
    connections.rescan = [this](const Eigen::Matrix4d& m) { rescans.push_back(m); };
    controller = std::make_unique<Controller>(connections, settings);
    controller->set_scene(scene);
  }
  static double height(double x_m, double) { return 0.1 * x_m; }
  void run(const haptics::State& state, double seconds = 2.0) {
    for (double t = 0.0; t < seconds; t += 0.02) controller->update(time_s += 0.02, state, 1280, 720, height);
  }
  double time_s = 0.0;
};

TEST(Controller, KeysBecomeRequests) {
  Desk desk;
  haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.run(state, 0.1);
  for (const KeyPress& press : {KeyPress{'+'}, KeyPress{'='}, KeyPress{'-'}, KeyPress{key::kLeft}, KeyPress{key::kUp},
                                KeyPress{'T'}, KeyPress{'F'}, KeyPress{' '}, KeyPress{']'}, KeyPress{'Q'}})
    desk.controller->press(press);
  std::vector<haptics::Request> got;
  while (const auto request = desk.requests.take()) got.push_back(*request);
  ASSERT_EQ(got.size(), 10U);
  EXPECT_EQ(got[0].kind, Kind::zoom_in);
  EXPECT_EQ(got[1].kind, Kind::zoom_in);
  EXPECT_EQ(got[2].kind, Kind::zoom_out);
  EXPECT_EQ(got[3].kind, Kind::pan);
  EXPECT_LT(got[3].x, 0.0);
  EXPECT_EQ(got[3].y, 0.0);
  EXPECT_GT(got[4].y, 0.0);
  EXPECT_EQ(got[5].kind, Kind::set_texture);
  EXPECT_FALSE(got[5].on) << "texture is on in this state";
  EXPECT_EQ(got[6].kind, Kind::set_friction);
  EXPECT_EQ(got[7].kind, Kind::describe);
  EXPECT_EQ(got[8].kind, Kind::scale_stiffness);
  EXPECT_NEAR(got[8].x, 1.25, 1e-9);
  EXPECT_EQ(got[9].kind, Kind::quit);
  EXPECT_TRUE(desk.controller->wants_to_leave());
}

TEST(Controller, EveryActionHasAKeyAndNoKeyHasTwo) {
  std::set<Action> reached;
  for (const int modifiers : {0, kShift, kControl, kShift | kControl})
    for (int key = 0; key < 300; ++key)
      if (const auto action = action_of({key, modifiers, false}, false)) reached.insert(*action);
  for (const ActionInfo& info : all_actions()) EXPECT_TRUE(reached.contains(info.action)) << info.label;
  EXPECT_EQ(reached.size(), all_actions().size());
}

TEST(Controller, HeldKeysDoNotFlickerToggles) {
  EXPECT_FALSE(action_of({'T', 0, true}, false).has_value());
  EXPECT_EQ(action_of({key::kLeft, 0, true}, false), Action::pan_left);
}

TEST(Controller, AKioskIsLeftByControlQOnly) {
  ViewSettings settings;
  settings.kiosk = true;
  Desk desk(settings);
  desk.controller->press({'Q'});
  desk.controller->press({key::kEscape});
  EXPECT_FALSE(desk.controller->wants_to_leave());
  desk.controller->press({'Q', kControl});
  EXPECT_TRUE(desk.controller->wants_to_leave());
}

TEST(Controller, AVisitorsKeysLeaveNothingForTheNextOneToPutRight) {
  for (const KeyPress& press :
       {KeyPress{key::kTab},     KeyPress{'T'},         KeyPress{'F'}, KeyPress{'P'},          KeyPress{'V', kShift},
        KeyPress{key::kF1 + 11}, KeyPress{'I'},         KeyPress{'O'}, KeyPress{'O', kShift},  KeyPress{'S'},
        KeyPress{'S', kShift},   KeyPress{']'},         KeyPress{'R'}, KeyPress{'M'},          KeyPress{key::kF1 + 10},
        KeyPress{'U'},           KeyPress{'U', kShift}, KeyPress{'K'}, KeyPress{'K', kShift},  KeyPress{'A'},
        KeyPress{'Z'},           KeyPress{'Z', kShift}, KeyPress{'Y'}, KeyPress{key::kDelete}, KeyPress{key::kF1 + 2},
        KeyPress{key::kF1 + 3}}) {
    ASSERT_TRUE(action_of(press, false)) << press.key;
    EXPECT_FALSE(action_of(press, true)) << info_of(*action_of(press, false)).label;
  }
  for (const KeyPress& press : {KeyPress{'+'}, KeyPress{key::kLeft}, KeyPress{' '}, KeyPress{'C'}, KeyPress{'E'}})
    EXPECT_TRUE(action_of(press, true)) << press.key;
}

TEST(Controller, TheNextVisitorFindsNothingOfTheOneBefore) {
  ViewSettings first;
  first.kiosk = true;
  first.colour = ColourMode::height;
  Desk desk(first);
  const haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.run(state);
  const double above_m = desk.pointer->read().device_m[2];
  for (const KeyPress& press : {KeyPress{key::kEnter}, KeyPress{'C'}, KeyPress{'J'}, KeyPress{'X'}, KeyPress{'G'},
                                KeyPress{key::kF1 + 5}, KeyPress{'H'}, KeyPress{'D'}, KeyPress{'+'}})
    desk.controller->press(press);
  desk.run(state);
  ASSERT_LT(desk.pointer->read().device_m[2], above_m) << "pressed down";
  while (desk.requests.take()) {
  }
  desk.controller->welcome_next(first);
  desk.run(state);
  EXPECT_NEAR(desk.pointer->read().device_m[2], above_m, 1e-4) << "the hand is lifted";
  const Frame& frame = desk.controller->frame();
  EXPECT_EQ(frame.focused, -1);
  EXPECT_EQ(frame.settings.colour, first.colour);
  EXPECT_EQ(frame.settings.light.elevation_rad, first.light.elevation_rad);
  EXPECT_FALSE(frame.settings.help || frame.settings.high_contrast || frame.settings.large_type);
  EXPECT_TRUE(frame.settings.kiosk);
  std::set<Kind> kinds;
  while (const auto request = desk.requests.take()) {
    kinds.insert(request->kind);
    EXPECT_FALSE(request->kind == Kind::drag && request->on);
  }
  EXPECT_TRUE(kinds.contains(Kind::fresh_visitor));
  EXPECT_TRUE(kinds.contains(Kind::drag)) << "the stone is let go";
  EXPECT_TRUE(kinds.contains(Kind::whole_scene));
}

TEST(Controller, FSixGoesThroughTheButtonsSpeaksAndEnterPresses) {
  Desk desk;
  desk.run(touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1), 0.1);
  const std::vector<Action> buttons = desk.controller->buttons();
  for (std::size_t k = 0; k < buttons.size(); ++k) desk.controller->press({key::kF1 + 5});
  EXPECT_EQ(desk.spoken.size(), buttons.size());
  EXPECT_NE(desk.spoken[2].find("Texture, none"), std::string::npos) << desk.spoken[2] << ": the scene has none";
  EXPECT_EQ(desk.controller->frame().focused, static_cast<int>(buttons.size()) - 1);
  desk.controller->press({key::kF1 + 5});
  EXPECT_EQ(desk.controller->frame().focused, 0);
  desk.controller->press({key::kEnter});
  const auto request = desk.requests.take();
  ASSERT_TRUE(request);
  EXPECT_EQ(request->kind, Kind::zoom_out);
  desk.controller->press({key::kEscape});
  EXPECT_EQ(desk.controller->frame().focused, -1);
  EXPECT_FALSE(desk.controller->wants_to_leave()) << "the first Escape only leaves the buttons";
}

TEST(Controller, TheMouseIsTheHandAndTheButtonPresses) {
  Desk desk;
  const haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.run(state);
  const Layout layout = layout_of(1280, 720, desk.controller->settings());
  const Stage stage = stage_of(desk.scene->description());
  const View view = make_view(desk.controller->frame().camera, layout.detail.width, layout.detail.height);
  const Eigen::Vector3d wanted(0.12, 0.09, Desk::height(0.12, 0.0));
  const auto pixel = view.to_pixel(stage.to_world(wanted));
  ASSERT_TRUE(pixel);
  desk.controller->mouse_move(pixel->x(), pixel->y(), layout, view, stage, Desk::height);
  desk.run(state);
  const haptics::PointerSample above = desk.pointer->read();
  EXPECT_GT(above.sequence, 0U);
  // It hovers on the line of sight: in the picture it is where the mouse points.
  const Eigen::Vector3d hovers(0.1 + above.device_m[0] / state.scale, 0.1 + above.device_m[1] / state.scale,
                               state.centre_m[2] + above.device_m[2] / state.scale);
  const auto seen = view.to_pixel(stage.to_world(hovers));
  ASSERT_TRUE(seen);
  EXPECT_LT((*seen - *pixel).norm(), 0.1);
  const double surface_m = state.scale * (wanted.z() - state.centre_m[2]);
  EXPECT_GT(above.device_m[2], surface_m + 0.004) << "hovers";
  desk.controller->mouse_button(0, true, 0);
  desk.run(state);
  EXPECT_LT(desk.pointer->read().device_m[2], surface_m - 0.002) << "presses";
  EXPECT_NEAR(desk.pointer->read().device_m[0], state.scale * (wanted.x() - 0.1), 1e-5);
  EXPECT_NEAR(desk.pointer->read().device_m[1], state.scale * (wanted.y() - 0.1), 1e-5);
  desk.controller->mouse_wheel(-2.0, 0);
  desk.run(state);
  EXPECT_LT(desk.pointer->read().device_m[2], surface_m - 0.0035) << "the wheel presses deeper";
  desk.controller->mouse_button(0, false, 0);
  desk.run(state);
  EXPECT_GT(desk.pointer->read().device_m[2], surface_m + 0.004);
}

TEST(Controller, AMouseThatMovesWhileThePictureChangesPointsAtTheNewPicture) {
  Desk desk;
  const haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.run(state);
  const Layout layout = layout_of(1280, 720, desk.controller->settings());
  const Stage stage = stage_of(desk.scene->description());
  const View whole = make_view(desk.controller->frame().camera, layout.detail.width, layout.detail.height);
  const View half = make_view(desk.controller->frame().camera, layout.detail.width / 2, layout.detail.height);
  const auto pixel = whole.to_pixel(stage.to_world(Eigen::Vector3d(0.12, 0.09, Desk::height(0.12, 0.0))));
  ASSERT_TRUE(pixel);
  const auto seen = [&] {
    const haptics::PointerSample hand = desk.pointer->read();
    return *whole.to_pixel(
        stage.to_world(Eigen::Vector3d(0.1 + hand.device_m[0] / state.scale, 0.1 + hand.device_m[1] / state.scale,
                                       state.centre_m[2] + hand.device_m[2] / state.scale)));
  };
  // The last picture was side by side; a key has turned that off before the mouse moved.
  desk.controller->mouse_move(pixel->x(), pixel->y(), layout, half, stage, Desk::height);
  desk.run(state, 0.02);
  desk.controller->picture_drawn(layout, whole);
  desk.run(state);
  EXPECT_LT((seen() - *pixel).norm(), 0.1);
  // A mouse that does not move leaves the hand alone.
  const Eigen::Vector2d before = seen();
  desk.controller->picture_drawn(layout, half);
  desk.run(state);
  EXPECT_LT((seen() - before).norm(), 1e-6);
}

TEST(Controller, TheHandStaysInItsWorkspaceAndFiniteWhateverHappens) {
  Desk desk;
  haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.run(state);
  for (int k = 0; k < 100; ++k) desk.controller->press({key::kRight, kShift});
  desk.run(state);
  EXPECT_NEAR(desk.pointer->read().device_m[0], 0.05, 1e-12);
  state.scale = std::nan("");
  state.centre_m = {std::nan(""), 1e300, -1e300};
  desk.run(state, 0.2);
  for (const double c : desk.pointer->read().device_m) EXPECT_TRUE(std::isfinite(c) && std::abs(c) <= 0.05);
}

TEST(Controller, WithoutThePointerDeviceNothingIsWrittenAndDragsTurn) {
  Desk desk({}, false);
  const haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.run(state);
  const double before = desk.controller->frame().camera.turn_rad;
  const Layout layout = layout_of(1280, 720, {});
  const Stage stage = stage_of(desk.scene->description());
  const View view = make_view(desk.controller->frame().camera, layout.detail.width, layout.detail.height);
  desk.controller->mouse_move(300, 300, layout, view, stage, Desk::height);
  desk.controller->mouse_button(0, true, 0);
  desk.controller->mouse_move(400, 300, layout, view, stage, Desk::height);
  desk.run(state);
  EXPECT_NE(desk.controller->frame().camera.turn_rad, before);
  EXPECT_EQ(desk.pointer->read().sequence, 0U);
}

TEST(Controller, AnnouncementsAreShownOnceAndFade) {
  Desk desk;
  const haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.board.say("Lotus medallion");
  desk.run(state, 0.1);
  ASSERT_EQ(desk.controller->frame().toasts.size(), 1U);
  EXPECT_EQ(desk.controller->frame().toasts[0].announcement.text, "Lotus medallion");
  desk.run(state, 10.0);
  EXPECT_TRUE(desk.controller->frame().toasts.empty());
}

TEST(Controller, ScanAgainTurnsTheGridFrameToTheCamera) {
  Desk desk;
  const haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.run(state);
  desk.controller->press({key::kRight, kControl});
  desk.run(state);
  const Camera camera = desk.controller->frame().camera;
  desk.controller->press({'R'});
  EXPECT_TRUE(desk.rescans.empty()) << "asks first";
  desk.controller->press({key::kEnter});
  ASSERT_EQ(desk.rescans.size(), 1U);
  const Eigen::Matrix3d turn = desk.rescans[0].topLeftCorner<3, 3>();
  // The camera's backward direction becomes z, its right becomes x: what was seen is what is scanned.
  const Eigen::Vector3d backward(std::sin(camera.turn_rad) * std::sin(camera.tilt_rad),
                                 -std::cos(camera.turn_rad) * std::sin(camera.tilt_rad), std::cos(camera.tilt_rad));
  EXPECT_LT((turn * backward - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_LT(
      (turn * Eigen::Vector3d(std::cos(camera.turn_rad), std::sin(camera.turn_rad), 0.0) - Eigen::Vector3d::UnitX())
          .norm(),
      1e-9);
}

TEST(Controller, TheCameraFollowsTheWindow) {
  Desk desk;
  haptics::State state = touching(*desk.scene, 0.06, 0.07, 0.0, 0.06, 0.07);
  desk.run(state);
  const Stage stage = stage_of(desk.scene->description());
  EXPECT_NEAR(stage.to_grid_m(desk.controller->frame().camera.target).x(), 0.06, 1e-3 * 0.2);
  state.centre_m[0] = 0.12;
  desk.run(state);
  EXPECT_NEAR(stage.to_grid_m(desk.controller->frame().camera.target).x(), 0.12, 1e-3 * 0.2);
}

TEST(Controller, FastPressesOfAToggleAllCount) {
  Desk desk;
  const haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.run(state, 0.1);
  for (int k = 0; k < 3; ++k) desk.controller->press({'T'});
  std::vector<bool> wished;
  while (const auto request = desk.requests.take()) wished.push_back(request->on);
  EXPECT_EQ(wished, (std::vector<bool>{false, true, false})) << "texture was on";
}

TEST(Controller, ClicksOnOverviewPanelAndDialogsNeverPressTheStone) {
  Desk desk;
  const haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.run(state);
  const double hovers_m = desk.pointer->read().device_m[2];
  const Layout layout = layout_of(1280, 720, {});
  const Stage stage = stage_of(desk.scene->description());
  const View view = make_view(desk.controller->frame().camera, layout.detail.width, layout.detail.height);
  const auto click = [&](double x, double y) {
    desk.controller->mouse_move(x, y, layout, view, stage, Desk::height);
    desk.controller->mouse_button(0, true, 0);
    desk.run(state, 0.5);
    EXPECT_NEAR(desk.pointer->read().device_m[2], hovers_m, 1e-6) << x << ", " << y;
    desk.controller->mouse_button(0, false, 0);
  };
  click(layout.panel.x + 4.0, 300.0);
  click(layout.overview.x + 0.5 * layout.overview.width, layout.overview.y + 0.5 * layout.overview.height);
  desk.controller->set_boxes({{{400, 300, 100, 40}, Clickable::Does::action, Action::describe}}, 1);
  click(450.0, 320.0);
  desk.controller->press({key::kF1});
  click(200.0, 200.0);
  EXPECT_FALSE(desk.controller->frame().looks);
}

TEST(Controller, QuestionsAreAnsweredByTheirButtons) {
  Desk desk;
  const haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.run(state);
  const Layout layout = layout_of(1280, 720, {});
  const Stage stage = stage_of(desk.scene->description());
  const View view = make_view(desk.controller->frame().camera, layout.detail.width, layout.detail.height);
  const auto click = [&](double x) {
    desk.controller->mouse_move(x, 320, layout, view, stage, Desk::height);
    desk.controller->mouse_button(0, true, 0);
    desk.controller->mouse_button(0, false, 0);
  };
  const std::vector<Clickable> answers{{{300, 300, 50, 40}, Clickable::Does::yes},
                                       {{400, 300, 50, 40}, Clickable::Does::no}};
  desk.controller->press({'R'});
  desk.controller->set_boxes(answers, 1);
  click(420);
  EXPECT_FALSE(desk.controller->frame().asks_rescan);
  EXPECT_TRUE(desk.rescans.empty());
  desk.controller->press({'R'});
  desk.controller->set_boxes(answers, 1);
  click(320);
  EXPECT_EQ(desk.rescans.size(), 1U);
}

TEST(Controller, AClickOnTheOverviewMovesTheWindowThere) {
  Desk desk;
  const haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  desk.run(state);
  const Layout layout = layout_of(1280, 720, {});
  const Stage stage = stage_of(desk.scene->description());
  const View overview =
      make_view(overview_camera(desk.scene->description(), stage_of(desk.scene->description()), layout.overview),
                layout.overview.width, layout.overview.height);
  const auto pixel = overview.to_pixel(stage.to_world({0.06, 0.15, 0.01}));
  ASSERT_TRUE(pixel);
  const View view = make_view(desk.controller->frame().camera, layout.detail.width, layout.detail.height);
  desk.controller->mouse_move(layout.overview.x + pixel->x(), layout.overview.y + pixel->y(), layout, view, stage,
                              Desk::height);
  desk.controller->mouse_button(0, true, 0);
  const auto request = desk.requests.take();
  ASSERT_TRUE(request);
  EXPECT_EQ(request->kind, Kind::move_to);
  EXPECT_NEAR(request->x, 0.06, 1e-9);
  EXPECT_NEAR(request->y, 0.15, 1e-9);
  desk.controller->mouse_button(0, false, 0);
  desk.run(state, 0.5);
  while (desk.requests.take()) {
  }
  desk.controller->press({'Z', kControl});
  desk.run(state, 0.5);
  const auto back = desk.requests.take();
  ASSERT_TRUE(back);
  EXPECT_EQ(back->kind, Kind::move_to);
}

TEST(Controller, AHeldKeyDragsTheStoneWithTheMouseAndAReleasedOneLetsItGo) {
  Desk desk;
  haptics::State state = touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1);
  state.scale = 0.4;  // the window shows more than the picture
  desk.run(state, 0.5);
  const Layout layout = layout_of(1280, 720, {});
  const Stage stage = stage_of(desk.scene->description());
  double x = layout.detail.x + 0.5 * layout.detail.width;
  const double y = layout.detail.y + 0.5 * layout.detail.height;
  // As the servo drags: the window goes against the hand, and the picture follows the window.
  haptics::PointerSample hand = desk.pointer->read();
  const auto frames = [&](int count, double pixels) {
    for (int k = 0; k < count; ++k) {
      const View view = make_view(desk.controller->frame().camera, layout.detail.width, layout.detail.height);
      if (pixels != 0.0) desk.controller->mouse_move(x += pixels, y, layout, view, stage, Desk::height);
      desk.controller->update(desk.time_s += 0.02, state, 1280, 720, Desk::height);
      const haptics::PointerSample now = desk.pointer->read();
      for (std::size_t axis = 0; axis < 2; ++axis)
        state.centre_m[axis] -= (now.device_m[axis] - hand.device_m[axis]) / state.scale;
      hand = now;
    }
  };
  desk.controller->mouse_move(x, y, layout,
                              make_view(desk.controller->frame().camera, layout.detail.width, layout.detail.height),
                              stage, Desk::height);
  desk.controller->press({'D'});
  desk.controller->press({'D', 0, true});
  const auto begun = desk.requests.take();
  ASSERT_TRUE(begun);
  EXPECT_EQ(begun->kind, Kind::drag);
  EXPECT_TRUE(begun->on);
  EXPECT_FALSE(desk.requests.take());
  const double pixels_per_m = make_view(desk.controller->frame().camera, layout.detail.width, layout.detail.height)
                                  .pixels_per_unit(desk.controller->frame().camera.target) /
                              stage.unit_m;
  frames(10, 5.0);
  frames(100, 0.0);
  const double centre_m = state.centre_m[0];
  EXPECT_NEAR(0.1 - centre_m, 50.0 / pixels_per_m, 0.05 * 50.0 / pixels_per_m);
  frames(100, 0.0);
  EXPECT_NEAR(state.centre_m[0], centre_m, 1e-6) << "the stone runs away from a mouse that rests";
  desk.controller->release('B');
  EXPECT_FALSE(desk.requests.take());
  desk.controller->release('D');
  const auto ended = desk.requests.take();
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->kind, Kind::drag);
  EXPECT_FALSE(ended->on);
}

TEST(Controller, AWindowThatEndsLetsTheStoneGo) {
  Desk desk;
  desk.run(touching(*desk.scene, 0.1, 0.1, 0.01, 0.1, 0.1), 0.1);
  desk.controller->press({'D'});
  static_cast<void>(desk.requests.take());
  desk.controller.reset();
  const auto ended = desk.requests.take();
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->kind, Kind::drag);
  EXPECT_FALSE(ended->on);
}

TEST(Controller, WhatItSaysItselfIsShownOnce) {
  haptics::AnnouncementBoard board;
  Connections connections;
  connections.announcements = &board;
  connections.speak = [&](const std::string& text) { board.say(text); };
  Controller controller(connections, {});
  const auto scene = scene_of([](double, double) { return 0.0; }, {51, 51, 0.001, 1});
  controller.set_scene(scene);
  controller.press({'X'});
  for (int k = 0; k < 5; ++k) {
    controller.update(0.02 * k, {}, 1280, 720, [](double, double) { return 0.0; });
    ASSERT_EQ(controller.frame().toasts.size(), 1U);
  }
}

}  // namespace
}  // namespace sparsha::viewer::test
