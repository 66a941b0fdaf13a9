// What a hand is told and gets that holds the grip's buttons: the way to a part, the end of the guide, help.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/phrases/phrases.h"
#include "haptics/session/session.h"
#include "tests/support/placed_hand.h"
#include "tests/support/recorded_runs.h"
#include "tests/support/scenes.h"

namespace sparsha::haptics {
namespace {

/// Where the words send a hand, metres of its own space: the distance and the hour that they name.
Eigen::Vector2d way_in(const std::string& words) {
  const std::vector<std::string> hours{"twelve", "one",   "two",   "three", "four", "five",
                                       "six",    "seven", "eight", "nine",  "ten",  "eleven"};
  const std::size_t comma = words.find(", ");
  const bool mm = words.find("millimetre") != std::string::npos;
  const double distance_m = std::stod(words.substr(comma + 2)) * (mm ? 0.001 : 0.01);
  for (std::size_t k = 0; k < hours.size(); ++k)
    if (words.find(", " + hours[k] + " o'clock") != std::string::npos)
      return distance_m * Eigen::Vector2d(std::sin(static_cast<double>(k) * std::numbers::pi / 6.0),
                                          std::cos(static_cast<double>(k) * std::numbers::pi / 6.0));
  ADD_FAILURE() << words;
  return Eigen::Vector2d::Zero();
}

TEST(Session, AHandThatObeysTheWordsForAPartIsInThePartWhereverItIs) {
  const std::array<double, 4> leaf_m{0.07, 0.08, 0.08, 0.09};
  const auto scene = sparsha::test::scene_of(sparsha::test::hills_m, 401, 0.1, 101, Eigen::Vector3d::Zero(),
                                             [&](scene::SceneDescription& d) {
                                               d.config.parts.push_back({"leaf", "A leaf", leaf_m});
                                             });
  for (const Eigen::Vector2d& begin :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.03, 0.0), Eigen::Vector2d(-0.02, 0.035),
        Eigen::Vector2d(-0.03, -0.03), Eigen::Vector2d(0.005, 0.0)}) {
    Placed hand;
    hand.put(begin.x(), begin.y(), 0.02);
    Session session(scene, make_pointer_device(hand.place), SessionOptions{});
    session.start();
    ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
    const std::uint64_t before = session.state().read().surface_id;
    session.requests().post({Request::Kind::next_part});
    ASSERT_TRUE(poll_until(session, [&] { return session.state().read().surface_id > before; }));
    const std::string told = words(session).back();
    const bool under = told == "A leaf is under your hand";
    const Eigen::Vector2d goal = under ? begin : Eigen::Vector2d(begin + way_in(told));
    hand.put(goal.x(), goal.y(), 0.02);
    ASSERT_TRUE(poll_until(session, [&] {
      const State now = session.state().read();
      return std::hypot(now.device_m[0] - goal.x(), now.device_m[1] - goal.y()) < 1e-4;
    }));
    const State state = session.state().read();
    EXPECT_GE(state.hip_m[0], leaf_m[0]) << told;
    EXPECT_LE(state.hip_m[0], leaf_m[2]) << told;
    EXPECT_GE(state.hip_m[1], leaf_m[1]) << told;
    EXPECT_LE(state.hip_m[1], leaf_m[3]) << told;
    session.stop();
  }
}

TEST(Session, AHoldOfTheGripEndsTheGuideAndDoesNothingElse) {
  const auto scene =
      sparsha::test::scene_of([](double x, double y) { return std::hypot(x - 0.05, y - 0.05) < 0.02 ? 0.002 : 0.0; },
                              201, 0.1, 101, Eigen::Vector3d::Zero(),
                              [](scene::SceneDescription& d) {
                                d.config.parts.push_back({"disc", "A disc", {0.03, 0.03, 0.07, 0.07}});
                                d.config.parts.push_back({"edge", "The edge", {0.0, 0.0, 0.02, 0.1}});
                              });
  Placed hand;
  Session session(scene, make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  hand.put(0.0, 0.0, 0.02, 1);
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "Guide on"); })) << "held for 2 s";
  hand.put(0.0, 0.0, 0.02, 0);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().buttons == 0; }));
  for (const std::uint64_t button : {1U, 8U}) {
    const std::size_t before = words(session).size();
    const std::uint64_t window = session.state().read().surface_id;
    const double pressed_s = session.state().read().time_s;
    hand.put(0.0, 0.0, 0.02, button);
    ASSERT_TRUE(poll_until(session, [&] { return session.state().read().time_s > pressed_s + 3.0; }));
    hand.put(0.0, 0.0, 0.02, 0);
    ASSERT_TRUE(poll_until(session, [&] { return session.state().read().buttons == 0; }));
    const auto all = words(session);
    const auto count = [&](const std::string& what) {
      return std::count_if(all.begin() + static_cast<std::ptrdiff_t>(before), all.end(),
                           [&](const std::string& w) { return w.find(what) != std::string::npos; });
    };
    EXPECT_EQ(count("Guide off"), 1);
    for (const char* other : {"A disc", "The edge", "Guide on"}) EXPECT_EQ(count(other), 0) << other;
    EXPECT_EQ(session.state().read().surface_id, window) << "no other part";
    EXPECT_EQ(session.state().read().guide, GuidePhase::off);
    session.requests().post({Request::Kind::guide});  // by key, for the other button
    const std::size_t off = all.size();
    ASSERT_TRUE(poll_until(session, [&] { return words(session).size() > off; }));
  }
  session.stop();
}

TEST(Session, ASceneOfAnotherLanguageIsSpokenInItAndSpeechIsAsItSays) {
  Placed hand;
  Session session(textured_scene(), make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  session.set_speech("hi", true);
  EXPECT_EQ(words(session).back(), Phrases::of("hi").text("speech_on")) << "how to get help, where speech begins";
  session.set_speech("hi", true);
  session.requests().post({Request::Kind::toggle_speech});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, Phrases::of("hi").text("speech_off")); }));
  session.requests().post({Request::Kind::zoom_out});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, Phrases::of("hi").text("already_whole")); }));
  session.set_speech("en", false);
  session.requests().post({Request::Kind::zoom_out});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "This is the whole stone"); }));
  EXPECT_THROW(session.set_speech("xx", true), Error);
  session.stop();
}

TEST(Session, AHoldThatTurnedSpeechOnDoesNotMakeTheNextOneATour) {
  Placed hand;
  Session session(textured_scene(), make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  const auto hold_until = [&](const char* expected, std::size_t from) {
    hand.put(0.0, 0.0, 0.02, 4);
    const bool heard = poll_until(session, [&] {
      const auto all = words(session);
      return std::any_of(all.begin() + static_cast<std::ptrdiff_t>(from), all.end(),
                         [&](const std::string& w) { return w.find(expected) != std::string::npos; });
    });
    hand.put(0.0, 0.0, 0.02, 0);
    return heard && poll_until(session, [&] { return session.state().read().buttons == 0; });
  };
  ASSERT_TRUE(hold_until("Speech on. For help, hold the middle button", 0));
  const std::size_t before = words(session).size();
  ASSERT_TRUE(hold_until("Right button: closer", before));
  auto said = words(session);
  said.erase(said.begin(), said.begin() + static_cast<std::ptrdiff_t>(before));
  // On a loaded machine this comes between at any time.
  std::erase_if(said, [](const std::string& w) { return w.find("The stone went soft") == 0; });
  ASSERT_FALSE(said.empty());
  EXPECT_EQ(said.front().rfind("Right button: closer", 0), 0U) << said.front();
  session.stop();
}

}  // namespace
}  // namespace sparsha::haptics
