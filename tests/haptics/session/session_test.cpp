// What a session makes of buttons, requests and new scenes.
#include "haptics/session/session.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.h"
#include "haptics/device/pointer/pointer_device.h"
#include "haptics/device/simulated/simulated_device.h"
#include "scene/area/regions.h"
#include "tests/support/placed_hand.h"
#include "tests/support/recorded_runs.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::haptics {
namespace {

TEST(Session, StiffnessIsWhatTheDeviceCanBear) {
  SessionOptions options;
  options.haptics.stiffness_n_per_m = 1e5;
  Session session(sparsha::test::flat_scene(), make_simulated_device(1, 0.05), options);
  const DeviceLimits limits = make_simulated_device(1, 0.0)->info().limits;
  EXPECT_EQ(run_to_the_end(session).stiffness_n_per_m, stiffness_limit(limits, 0.001));
}

TEST(Session, RefusesARateThatNoServoCanKeep) {
  SessionOptions options;
  options.haptics.rate_hz = 50'000.0;
  EXPECT_THROW(Session(sparsha::test::flat_scene(), make_simulated_device(1, 0.1), options), Error);
}

TEST(Session, ZoomsWithTheDevicesButtonsAndSaysTheLevel) {
  Placed hand;
  Session session(textured_scene(), make_pointer_device(hand.place), SessionOptions{});
  session.start();
  EXPECT_EQ(session.state().read().level, 0U);  // nothing yet
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  EXPECT_EQ(session.state().read().level, 2U);
  const auto click = [&](std::uint64_t button) {
    hand.put(0.0, 0.0, 0.02, button);
    return poll_until(session, [&] { return session.state().read().buttons == button; }) &&
           (hand.put(0.0, 0.0, 0.02, 0), poll_until(session, [&] { return session.state().read().buttons == 0; }));
  };
  ASSERT_TRUE(click(1));  // plus
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().level == 1; }));
  ASSERT_TRUE(click(1));
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().level == 0; }));
  for (int press = 0; press < 12 && !said(session, "This is the closest view"); ++press) {
    const std::uint64_t before = session.state().read().surface_id;
    ASSERT_TRUE(click(1));
    ASSERT_TRUE(poll_until(session, [&] {
      return session.state().read().surface_id > before || said(session, "This is the closest view");
    }));
  }
  EXPECT_TRUE(said(session, "Closer, "));
  EXPECT_TRUE(said(session, "Closest view, "));
  EXPECT_TRUE(said(session, "This is the closest view"));
  EXPECT_EQ(session.state().read().level, 0U);
  ASSERT_TRUE(click(2));  // forward: the whole scene
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().level == 2; }));
  EXPECT_TRUE(said(session, "Whole stone"));
  const SessionSummary summary = session.stop();
  EXPECT_EQ(summary.levels, (std::vector<int>{0, 1, 2}));
  std::printf("swap at most %.1f us\n", summary.swap_ns_max * 1e-3);
}

TEST(Session, HeldButtonsGoFromPartToPartAndSayTheWay) {
  const auto scene = sparsha::test::scene_of(
      sparsha::test::hills_m, 401, 0.1, 101, Eigen::Vector3d::Zero(), [](scene::SceneDescription& d) {
        d.config.parts.push_back({"leaf", "A leaf", {0.07, 0.08, 0.08, 0.09}});
        d.config.parts.push_back({"edge", "The left edge", {0.0, 0.0, 0.03, 0.1}});
      });
  Placed hand;
  Session session(scene, make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  const auto hold = [&](std::uint64_t button) {
    const std::uint64_t before = session.state().read().surface_id;
    hand.put(0.0, 0.0, 0.02, button);
    const bool moved = poll_until(session, [&] { return session.state().read().surface_id > before; });
    hand.put(0.0, 0.0, 0.02, 0);
    return moved && poll_until(session, [&] { return session.state().read().buttons == 0; });
  };
  ASSERT_TRUE(hold(1));
  State state = session.state().read();
  EXPECT_NEAR(state.hip_m[0], 0.075, 1e-9);
  EXPECT_NEAR(state.hip_m[1], 0.085, 1e-9);
  // The window brings the leaf to a hand in the device's middle; the whole of it lies in the window.
  EXPECT_TRUE(said(session, "A leaf is under your hand")) << ::testing::PrintToString(words(session));
  const double width_m = state.workspace_m / state.scale;
  EXPECT_GE(width_m, 0.01);
  EXPECT_LE(width_m, 0.03) << "and not much else";
  ASSERT_TRUE(hold(1));
  EXPECT_NEAR(session.state().read().hip_m[0], 0.015, 1e-9);
  ASSERT_TRUE(hold(8));  // minus: back
  EXPECT_NEAR(session.state().read().hip_m[0], 0.075, 1e-9);
  ASSERT_TRUE(hold(8));  // and round to the last
  EXPECT_NEAR(session.state().read().hip_m[0], 0.015, 1e-9);
  session.stop();
}

TEST(Session, TheNextVisitorFindsNeitherGuideNorSpeechNorTourOfTheOneBefore) {
  const auto scene = sparsha::test::scene_of(
      sparsha::test::hills_m, 401, 0.1, 101, Eigen::Vector3d::Zero(), [](scene::SceneDescription& d) {
        d.config.parts.push_back({"leaf", "A leaf", {0.04, 0.04, 0.06, 0.06}});
        d.config.parts.push_back({"edge", "The left edge", {0.0, 0.0, 0.03, 0.1}});
        d.config.guide = scene::GuideConfig{};
        d.config.guide->path = scene::GuideConfig::Path::part;
      });
  Placed hand;
  Session session(scene, make_pointer_device(hand.place), SessionOptions{});
  session.start();
  const auto controls = [&](Announcement::Control control) {
    const auto all = session.announcements().since(0);
    return std::count_if(all.begin(), all.end(), [&](const Announcement& a) { return a.control == control; });
  };
  const auto served = [&] {
    return poll_until(session,
                      [&, tick = session.state().read().tick] { return session.state().read().tick > tick + 5; });
  };
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  session.requests().post({Request::Kind::next_part});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "A leaf"); }));
  session.requests().post({Request::Kind::guide});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "guide") || said(session, "Guide"); }))
      << ::testing::PrintToString(words(session));
  session.requests().post({Request::Kind::toggle_speech});
  session.requests().post({Request::Kind::help});
  ASSERT_TRUE(served());
  EXPECT_EQ(controls(Announcement::Control::toggle), 1);
  const std::uint64_t commands = session.state().read().command;
  session.requests().post({Request::Kind::fresh_visitor});
  ASSERT_TRUE(served());
  EXPECT_EQ(controls(Announcement::Control::reset), 1);
  const auto all_said = session.announcements().since(0);
  const auto reset = std::find_if(all_said.begin(), all_said.end(),
                                  [](const Announcement& a) { return a.control == Announcement::Control::reset; });
  ASSERT_NE(reset, all_said.end());
  EXPECT_EQ(reset->text, "") << "nothing is said to nobody";
  EXPECT_GE(session.state().read().command, commands + 2) << "the guide is taken from the servo, the stone is let go";
  // Each is as it was at the start: a first help and no tour, speech that is turned on, the guide on, the first part.
  const auto fresh = [&, seen = reset->sequence](const char* text) {
    const auto all = session.announcements().since(seen);
    return std::any_of(all.begin(), all.end(),
                       [&](const Announcement& a) { return a.text.find(text) != std::string::npos; });
  };
  session.requests().post({Request::Kind::help});
  EXPECT_TRUE(poll_until(session, [&] { return fresh("Right button: closer"); }));
  session.requests().post({Request::Kind::toggle_speech});
  EXPECT_TRUE(poll_until(session, [&] { return fresh("Speech on"); })) << ::testing::PrintToString(words(session));
  session.requests().post({Request::Kind::next_part});
  EXPECT_TRUE(poll_until(session, [&] { return fresh("A leaf"); }));
  session.stop();
}

TEST(Session, OneViewCannotBeTurnedAndIsSaidNotToBe) {
  Placed hand;
  Session session(textured_scene(), make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  EXPECT_FALSE(said(session, "only a whole object can be turned"));
  session.requests().post({Request::Kind::turn, 0.0, 90.0});
  EXPECT_TRUE(poll_until(session, [&] { return said(session, "only a whole object can be turned"); }));
  EXPECT_EQ(session.state().read().turn, (std::array<double, 4>{0.0, 0.0, 0.0, 1.0}));
  session.stop();
}

TEST(Session, AWholeObjectIsTurnedByWishesAndSaysWhatItShows) {
  Placed hand;
  const auto scene = test::whole_scene(test::ball_charts());
  Session session(scene, make_pointer_device(hand.place), SessionOptions{});
  session.start();
  hand.put(0.0, 0.0, 0.02);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  ASSERT_TRUE(session.whole_object_m());
  EXPECT_NEAR(session.whole_object_m()->sizes().maxCoeff(), 0.08, 0.001);
  const auto turn_w = [&] { return std::abs(session.state().read().turn[3]); };
  session.requests().post({Request::Kind::turn, 0.0, 90.0});
  session.requests().post({Request::Kind::turn, 0.0, 90.0});
  ASSERT_TRUE(poll_until(session, [&] { return turn_w() < 1e-9; }));
  EXPECT_TRUE(said(session, "Left side before you"));
  EXPECT_TRUE(said(session, "Back before you"));
  hand.put(0.0, 0.0, -0.004);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().contact == 1; }));
  EXPECT_LT(session.state().read().proxy_m[2], -0.039) << "the back of the ball";
  // From the state and the formula: the ball's middle is as far behind its first point as its radius.
  const State turned = session.state().read();
  const double radius_m = 0.04 * turned.scale, top_m = session.object_before_m({0.0, 0.0});
  for (const double x_m : {0.0, 0.01, -0.02})
    EXPECT_NEAR(session.object_before_m({x_m, 0.005}),
                top_m - radius_m + std::sqrt(radius_m * radius_m - x_m * x_m - 0.005 * 0.005), 1e-4);
  EXPECT_LE(session.object_before_m({0.049, 0.049}), -0.09) << "nothing is there";
  session.requests().post({Request::Kind::describe});
  EXPECT_TRUE(poll_until(session, [&] { return said(session, "Back, "); }));
  session.requests().post({Request::Kind::guide});
  EXPECT_TRUE(poll_until(session, [&] { return said(session, "nothing to be led along"); })) << "a ball has no line";
  session.requests().post({Request::Kind::fresh_visitor});
  EXPECT_TRUE(poll_until(session, [&] { return turn_w() == 1.0; })) << "the next visitor begins at the front";
  session.stop();
}

TEST(Session, AGuideLeadsAroundAPartOnTheBackOfAWholeObject) {
  Placed hand;
  const auto scene = test::whole_scene(test::ball_charts(), 0.1, [](scene::SceneDescription& d) {
    d.config.around = scene::AroundConfig{};
    scene::PartConfig cap;
    cap.name = cap.say = "Cap";
    cap.solid_m = std::array<double, 6>{-0.1, -0.1, -0.1, 0.1, 0.1, -0.035};
    d.config.parts = {cap};
    d.config.guide = scene::GuideConfig{};
    d.config.guide->path = scene::GuideConfig::Path::part;
  });
  Session session(scene, make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  session.requests().post({Request::Kind::next_part});
  ASSERT_TRUE(poll_until(session, [&] { return std::abs(session.state().read().turn[3]) < 1e-6; })) << "the back";
  session.requests().post({Request::Kind::guide});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "Guide on, along Cap"); }))
      << ::testing::PrintToString(words(session));
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().guide == GuidePhase::waiting; }));
  // The cap's border is a circle about the middle of the view: by the ball's formula, at the view's scale.
  const double radius_m = std::sqrt(0.04 * 0.04 - 0.035 * 0.035);
  const State now = session.state().read();
  const double x_m = radius_m * now.scale;
  const double z_m = session.object_before_m({x_m, 0.0});
  hand.put(x_m, 0.0, z_m + 0.004);
  EXPECT_TRUE(poll_until(session, [&] { return session.state().read().guide == GuidePhase::leading; }));
  EXPECT_TRUE(poll_until(session, [&] { return said(session, "The guide leads your hand"); }));
  session.requests().post({Request::Kind::turn, 0.0, 90.0});
  EXPECT_TRUE(poll_until(session, [&] { return session.state().read().guide != GuidePhase::leading; }))
      << "the line has gone with the object";
  session.stop();
}

TEST(Session, APartOnTheBackOfAWholeObjectIsTurnedToTheVisitorAndToldWhenItIsTouched) {
  Placed hand;
  const auto scene = test::whole_scene(test::ball_charts(), 0.1, [](scene::SceneDescription& d) {
    d.config.around = scene::AroundConfig{};
    const std::array<std::array<double, 6>, 2> boxes{{{-0.01, -0.01, -0.05, 0.01, 0.01, -0.03},    // behind
                                                      {-0.05, -0.01, -0.01, -0.03, 0.01, 0.01}}};  // left
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      scene::PartConfig part;
      part.name = part.say = k == 0 ? "Knot of the girdle" : "Left shoulder";
      part.solid_m = boxes[k];
      d.config.parts.push_back(part);
    }
  });
  Session session(scene, make_pointer_device(hand.place), SessionOptions{});
  session.start();
  hand.put(0.0, 0.0, 0.02);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  const auto place_before = [&] {  // what is before the visitor, grid frame
    const State s = session.state().read();
    const Eigen::Quaterniond turn(s.turn[3], s.turn[0], s.turn[1], s.turn[2]);
    return Eigen::Vector3d(turn.conjugate() * Eigen::Vector3d::UnitZ());
  };
  session.requests().post({Request::Kind::next_part});
  ASSERT_TRUE(poll_until(session, [&] { return place_before().z() < -0.999; }));
  EXPECT_TRUE(said(session, "Knot of the girdle"));
  hand.put(0.0, 0.0, -0.004);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().contact == 1; }));
  EXPECT_LT(session.state().read().place_m[2], -0.03);
  session.requests().post({Request::Kind::describe});
  EXPECT_TRUE(poll_until(session, [&] { return said(session, "Back, "); }));
  hand.put(0.0, 0.0, 0.02);
  session.requests().post({Request::Kind::next_part});
  ASSERT_TRUE(poll_until(session, [&] { return place_before().x() < -0.999; }));
  EXPECT_TRUE(said(session, "Left shoulder"));
  EXPECT_EQ(scene::part_at(scene->description(), {0.0, 0.0, 0.04}), nullptr) << "the front is no part";
  session.stop();
}

TEST(Session, SmallTurnsOfAWholeObjectAreSaidOnlyWhereItShowsAnotherSide) {
  Placed hand;
  Session session(test::whole_scene(test::ball_charts()), make_pointer_device(hand.place), SessionOptions{});
  session.start();
  hand.put(0.0, 0.0, 0.02);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  const auto turned_deg = [&] {
    return 2.0 * std::acos(std::abs(session.state().read().turn[3])) * 180.0 / 3.14159265;
  };
  for (int k = 0; k < 10; ++k) session.requests().post({Request::Kind::turn, 0.0, 4.0, true});
  ASSERT_TRUE(poll_until(session, [&] { return std::abs(turned_deg() - 40.0) < 0.01; }));
  EXPECT_FALSE(said(session, "before you"));
  for (int k = 0; k < 10; ++k) session.requests().post({Request::Kind::turn, 0.0, 4.0, true});
  ASSERT_TRUE(poll_until(session, [&] { return std::abs(turned_deg() - 80.0) < 0.01; }));
  EXPECT_TRUE(said(session, "Left side before you"));
  session.stop();
}

TEST(Session, TheRimOfTheWorkspaceGoesAlongATurnedObject) {
  Placed hand;
  const auto scene = test::whole_scene(test::ball_charts(), 0.1);
  Session session(scene, make_pointer_device(hand.place), SessionOptions{});
  session.start();
  hand.put(0.0, 0.0, 0.02);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  session.requests().post({Request::Kind::turn, 0.0, 90.0});
  session.requests().post({Request::Kind::zoom_in});
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().scale > 1.5; }));
  const State before = session.state().read();
  hand.put(0.0495, 0.0, 0.02);
  // The device's x axis is the object's z then.
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().centre_m[2] > before.centre_m[2] + 0.008; }));
  EXPECT_NEAR(session.state().read().centre_m[1], before.centre_m[1], 1e-9);
  session.stop();
}

TEST(Session, TheForwardButtonDragsTheStoneWhileItIsHeld) {
  Placed hand;
  Session session(textured_scene(), make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  session.requests().post({Request::Kind::zoom_in});
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().level == 1; }));
  const State before = session.state().read();
  hand.put(0.0, 0.0, 0.02, 2);
  ASSERT_TRUE(poll_until(session, [&] { return (session.state().read().flags & kFlagDragged) != 0; }));
  hand.put(-0.02, 0.01, 0.02, 2);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().device_m[0] < -0.0199; }));
  const State dragged = session.state().read();
  EXPECT_NEAR(dragged.hip_m[0], before.hip_m[0], 1e-9);
  EXPECT_NEAR(dragged.centre_m[0] - before.centre_m[0], -dragged.device_m[0] / before.scale, 1e-9);
  EXPECT_GT(dragged.centre_m[0] - before.centre_m[0], 0.019 / before.scale);
  hand.put(-0.02, 0.01, 0.02, 0);
  ASSERT_TRUE(poll_until(session, [&] { return (session.state().read().flags & kFlagDragged) == 0; }));
  const State let_go = session.state().read();
  hand.put(0.0, 0.0, 0.02, 0);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().device_m[0] > -0.0001; }));
  EXPECT_EQ(session.state().read().centre_m, let_go.centre_m) << "the stone stays there";
  session.stop();
}

TEST(Session, HoldingTheMiddleButtonHelpsAndHoldingItAgainGivesATour) {
  Placed hand;
  Session session(textured_scene(), make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  for (const char* words : {"Right button: closer", "The grip has four buttons"}) {
    EXPECT_FALSE(said(session, words));
    hand.put(0.0, 0.0, 0.02, 4);
    ASSERT_TRUE(poll_until(session, [&] { return said(session, words); }));
    hand.put(0.0, 0.0, 0.02, 0);
    ASSERT_TRUE(poll_until(session, [&] { return session.state().read().buttons == 0; }));
  }
  session.stop();
}

TEST(Session, TheWindowFollowsAHandAtTheWorkspacesRimToTheEdgeOfTheScene) {
  Placed hand;
  Session session(textured_scene(), make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  session.requests().post({Request::Kind::zoom_in});
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().level == 1; }));
  const State before = session.state().read();
  hand.put(0.0495, 0.0, 0.004);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().surface_id > before.surface_id; }))
      << "fresh tiles near the border";
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().hip_m[0] > 2.0985; }));
  EXPECT_TRUE(said(session, "Moving right"));
  const State after = session.state().read();
  EXPECT_GT(after.centre_m[0], before.centre_m[0]);
  EXPECT_LE(after.centre_m[0], 2.0755);  // the workspace's edge stops at the scene's
  EXPECT_TRUE((after.flags & kFlagOutside) == 0);
  // A late tick of a loaded machine takes the force away, which the hand gets back in the air. Friction lets the proxy
  // lag by 0.4 of the depth.
  ASSERT_TRUE(poll_until(session, [&] {
    const State now = session.state().read();
    hand.put(0.056, 0.0, now.contact == 1 && now.given_share == 0.0 ? 0.004 : -0.003);
    return said(session, "Edge of the stone, go left");
  }));
  session.stop();
}

TEST(Session, AReliefDeeperThanTheWorkspaceComesIntoReachAtItsRim) {
  const auto scene = sparsha::test::scene_of([](double x, double) { return 1.5 * x; }, 101, 0.1);  // 15 cm deep
  Placed hand;
  Session session(scene, make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  hand.put(-0.04, 0.0, -0.04);  // the surface is at -0.06 there
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().device_m[2] < -0.0399; }));
  EXPECT_EQ(session.state().read().contact, 0U);
  hand.put(-0.04, 0.0, -0.048);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().contact == 1; }));
  EXPECT_TRUE(said(session, "Going deeper"));
  session.stop();
}

TEST(Session, SpeaksPartsWhenTouchedAndAreasThatWereNeverMeasured) {
  const auto scene = sparsha::test::scene_of([](double x, double) { return x > 0.07 ? std::nan("") : 0.0; }, 101, 0.1,
                                             200, Eigen::Vector3d::Zero(),
                                             [](scene::SceneDescription& d) {
                                               d.config.parts.push_back({"left", "Left half", {0.0, 0.0, 0.045, 0.1}});
                                             });
  Placed hand;
  Session session(scene, make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 100; }));
  hand.put(-0.02, 0.0, 0.02);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().device_m[0] < -0.0199; }));
  EXPECT_FALSE(said(session, "Left half")) << "not touched yet";
  ASSERT_TRUE(press_until(session, hand, -0.02, 0.0, [&] { return said(session, "Left half"); }));
  ASSERT_TRUE(press_until(session, hand, 0.04, 0.0, [&] { return said(session, "Not measured here"); }));
  // Beyond the outline the ground falls away, and the hand is free.
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().contact == 0; }));
  session.requests().post({Request::Kind::describe});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "Right, in the middle, in the air, Not measured here"); }))
      << testing::PrintToString(words(session));
  session.requests().post({Request::Kind::quit});
  ASSERT_TRUE(poll_until(session, [&] { return session.finished(); }));
  session.stop();
}

TEST(Session, PartsAndSoundsStayWhereTheyAreOnTheObjectWhenItIsScannedFromAnotherSide) {
  // The same plate before and after a half turn about z: what was on the left is on the right.
  const auto plate = [](bool turned) {
    return sparsha::test::scene_of([](double, double) { return 0.0; }, 101, 0.1, 200, Eigen::Vector3d::Zero(),
                                   [turned](scene::SceneDescription& d) {
                                     d.config.parts.push_back({"left", "Left half", {0.0, 0.0, 0.045, 0.1}});
                                     d.config.parts.push_back({"right", "Right half", {0.055, 0.0, 0.1, 0.1}});
                                     if (!turned) return;
                                     Eigen::Matrix4d half_turn = Eigen::Matrix4d::Identity();
                                     half_turn(0, 0) = half_turn(1, 1) = -1.0;
                                     half_turn(0, 3) = half_turn(1, 3) = 0.1;
                                     d.region_from_grid = half_turn;
                                   });
  };
  Placed hand;
  Session session(plate(false), make_pointer_device(hand.place), SessionOptions{});
  const auto events = session.add_contact_consumer();
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 100; }));
  session.set_scene(plate(true));
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().surface_id == 2; }));
  hand.put(-0.02, 0.01, 0.02);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().device_m[0] < -0.0199; }));
  hand.put(-0.02, 0.01, -0.005);
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "Right half"); }));
  EXPECT_FALSE(said(session, "Left half"));
  const State state = session.state().read();
  EXPECT_NEAR(state.place_m[0], 0.1 - state.proxy_m[0], 1e-12);
  EXPECT_NEAR(state.place_m[1], 0.1 - state.proxy_m[1], 1e-12);
  EXPECT_EQ(state.place_m[2], state.proxy_m[2]);
  // A pause of the machine takes a touch's event with its force: then the hand touches once more.
  ContactEvent touch;
  bool heard = events->pop(touch);
  for (int again = 0; again < 5 && !heard; ++again) {
    ASSERT_LT(session.state().read().share_in_time, 1.0) << "an event was lost though no tick was late";
    hand.put(-0.02, 0.01, 0.02);
    const std::uint64_t lifted = session.state().read().tick;
    ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > lifted + 200; }));
    hand.put(-0.02, 0.01, -0.005);
    ASSERT_TRUE(poll_until(session, [&] { return session.state().read().contact != 0; }));
    heard = events->pop(touch);
  }
  session.stop();
  ASSERT_TRUE(heard || events->pop(touch));
  EXPECT_NEAR(touch.place_m[0], 0.1 - touch.proxy_m[0], 1e-12) << "what sounds is asked by the same place";
}

TEST(Session, ANewSceneKeepsTheHandsPlaceAndTheOldSceneIsLetGo) {
  Placed hand;
  auto first = sparsha::test::flat_scene(0.0);
  const std::weak_ptr<const scene::Scene> watch = first;
  Session session(std::move(first), make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  session.set_scene(sparsha::test::flat_scene(7.0, 151, 3.0));
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().surface_id == 2; }));
  const State state = session.state().read();
  EXPECT_NEAR(state.centre_m[2], 7.0, 1e-5);
  EXPECT_NEAR(state.device_m[2], 0.02, 1e-9);
  EXPECT_NEAR(state.centre_m[0], 1.5, 1e-9);
  session.stop();
  EXPECT_TRUE(watch.expired());
}

}  // namespace
}  // namespace sparsha::haptics
