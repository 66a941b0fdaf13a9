// Keys of a terminal as a hand: what is typed in which encoding, where it goes, and a whole run at a terminal.
#include "app/terminal/hand_keys.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "app/terminal/typed_keys.h"

namespace sparsha::app {
namespace {

using Kind = TypedKey::Kind;

std::vector<TypedKey> letters(const std::string& text) {
  std::vector<TypedKey> keys;
  for (const char c : text) keys.push_back({Kind::letter, c});
  return keys;
}

TEST(TypedKeys, OfEachTerminalAreTheSame) {
  const std::vector<std::pair<std::string, Kind>> cases = {
      {"\x1b[A", Kind::up},         {"\x1bOB", Kind::down},   {"\x1b[1;5C", Kind::right}, {"\x1bOD", Kind::left},
      {"\x1b[H", Kind::home},       {"\x1bOH", Kind::home},   {"\x1b[1~", Kind::home},    {"\x1b[7~", Kind::home},
      {"\x1b[F", Kind::end},        {"\x1b[4~", Kind::end},   {"\x1b[8~", Kind::end},     {"\x1b[5~", Kind::page_up},
      {"\x1b[6~", Kind::page_down}, {"\x1b[E", Kind::middle}, {"\x1b[2~", Kind::insert}};
  for (const auto& [sent, kind] : cases) {
    TypedKeys keys;
    EXPECT_EQ(keys.take(sent, 1.0), (std::vector<TypedKey>{{kind, 0}})) << sent.substr(1);
    // In pieces, as over a slow line.
    for (std::size_t cut = 1; cut < sent.size(); ++cut) {
      EXPECT_TRUE(keys.take(sent.substr(0, cut), 2.0).empty());
      EXPECT_EQ(keys.take(sent.substr(cut), 2.1), (std::vector<TypedKey>{{kind, 0}})) << sent.substr(1) << cut;
    }
  }
}

TEST(TypedKeys, OfTheNumberPadInApplicationModeAreDigitsAndSigns) {
  TypedKeys keys;
  EXPECT_EQ(keys.take("\x1bOp\x1bOx\x1bOk\x1bOm\x1bOj\x1bOo", 0.0), letters("08+-*/"));
}

TEST(TypedKeys, WhatIsNoKeyIsSkippedInAnyEncoding) {
  TypedKeys keys;
  EXPECT_EQ(keys.take("a\xC3\xA9"
                      "b\xE9"
                      "c\x1b[15~\x1b[200;1;3~d",
                      0.0),
            letters("abcd"));
  EXPECT_TRUE(keys.take("\x1b", 1.0).empty());
  EXPECT_EQ(keys.take("q", 2.0), letters("q")) << "the Escape key, and another one later";
  EXPECT_EQ(keys.take("\x1b[" + std::string(1000, ';'), 3.0).size(), 0U);
  EXPECT_EQ(keys.take("q", 4.0), letters("q"));
}

/// The keys, and a hand that goes where they want it, in a workspace of 10 cm over a square stone.
class Hand : public ::testing::Test {
 protected:
  Hand() {
    state_.tick = 1;
    state_.workspace_m = 0.1;
    state_.scale = 0.5;
    state_.flags = haptics::kFlagArmed;
  }
  void look(double seconds) {
    for (int k = 0; k < static_cast<int>(std::lround(seconds / 0.005)); ++k) {
      time_s_ += 0.005;
      wish_ = keys_.update(state_, range_, stone_);
      if (const auto words = keys_.take_words()) said_.emplace_back(words->phrase.key());
      for (int axis = 0; axis < 2; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double way_m = wish_.hand.wanted_m[a] - state_.device_m[a];
        const double most_m = wish_.hand.speed_m_per_s * 0.005;
        state_.device_m[a] += std::clamp(way_m, -most_m, most_m);
        const double scrolled_m = wish_.scroll[axis] * state_.workspace_m / state_.scale * 0.005;
        state_.centre_m[a] = std::clamp(state_.centre_m[a] + scrolled_m, range_.low_m[axis], range_.high_m[axis]);
      }
      fastest_scroll_ = std::max(fastest_scroll_, wish_.scroll.cwiseAbs().maxCoeff());
    }
  }
  void type(const TypedKey& key) { EXPECT_TRUE(keys_.press(key, time_s_, state_, phrases_)); }
  void hold(const TypedKey& key, double seconds, double every_s = 0.03) {
    type(key);
    look(0.4);
    for (double t = 0.4; t < seconds; t += every_s) {
      type(key);
      look(every_s);
    }
  }
  /// Where the hand is on the stone, in metres at the hand.
  [[nodiscard]] double x_m() const { return state_.device_m[0] + state_.scale * state_.centre_m[0]; }

  HandKeys keys_;
  HandKeys::Wish wish_;
  haptics::State state_;
  haptics::CentreRange range_;  // the whole stone
  HandKeys::Stone stone_;       // without an end
  Phrases phrases_ = Phrases::of("en");
  std::vector<std::string> said_;
  double time_s_ = 10.0, fastest_scroll_ = 0.0;
};

constexpr TypedKey kRight{Kind::right, 0}, kUp{Kind::up, 0}, kLeft{Kind::left, 0};

TEST_F(Hand, StopsBeforeTheStoneEndsWhereTheWindowReachesBeyondIt) {
  stone_.low_m = {-0.06, -0.08};
  stone_.high_m = {0.05, 0.08};  // 25 mm at the hand
  hold(kRight, 3.0);
  EXPECT_NEAR(x_m(), 0.024, 1e-9);
  EXPECT_EQ(said_, std::vector<std::string>{"hand_end"});
  hold(kLeft, 4.0);
  EXPECT_NEAR(x_m(), -0.029, 1e-9);
  EXPECT_EQ(said_.size(), 2U);
}

TEST_F(Hand, EachKeyPressedIsOneStep) {
  for (int k = 0; k < 4; ++k) {
    type(kRight);
    look(0.2);
  }
  look(0.5);
  EXPECT_NEAR(x_m(), 0.02, 1e-9);
  for (int k = 0; k < 4; ++k) {  // as fast as fingers are
    type(kLeft);
    look(0.1);
  }
  look(1.0);
  EXPECT_NEAR(x_m(), 0.0, 1e-9);
  type({Kind::letter, '7'});
  look(0.5);
  EXPECT_NEAR(state_.device_m[0], -0.005 * std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(state_.device_m[1], 0.005 * std::sqrt(0.5), 1e-9);
}

TEST_F(Hand, AKeyThatIsHeldMovesItSteadilyAtAnyRateOfRepetitionAndStopsWithinAStep) {
  for (const double every_s : {0.02, 0.03, 0.05}) {
    state_.device_m = {};
    keys_ = HandKeys();
    hold(kRight, 1.0, every_s);
    // A step at first, then 40 mm/s from when it repeats.
    EXPECT_NEAR(x_m(), 0.005 + 0.04 * 0.6, 0.006) << every_s;
    const double let_go_m = x_m();
    look(1.0);
    EXPECT_LE(x_m() - let_go_m, 0.0065) << every_s;
  }
}

TEST_F(Hand, ABurstAfterAPauseOfTheLineIsNoLongWay) {
  type(kRight);
  look(0.2);
  for (int k = 0; k < 40; ++k) type(kRight);  // all at once
  look(3.0);
  EXPECT_LE(x_m(), 0.0121);
}

TEST_F(Hand, TheWindowFollowsBeyondTheReachAndEndsWithTheStone) {
  range_.low_m = Eigen::Vector3d(-0.2, 0.0, 0.0);
  range_.high_m = Eigen::Vector3d(0.2, 0.0, 0.0);
  for (int k = 0; k < 14; ++k) {
    type(kRight);
    look(0.25);
  }
  look(1.0);
  EXPECT_NEAR(x_m(), 0.07, 0.002) << "steps count on the stone";
  EXPECT_LE(state_.device_m[0], 0.0401);
  EXPECT_TRUE(said_.empty());
  hold(kRight, 8.0);
  look(1.0);
  EXPECT_NEAR(state_.centre_m[0], 0.2, 1e-9);
  EXPECT_NEAR(state_.device_m[0], 0.0485, 1e-6);
  EXPECT_EQ(said_, (std::vector<std::string>{"hand_end"})) << "once";
  EXPECT_LE(fastest_scroll_, 0.4 + 1e-9) << "as fast as the hand";
  EXPECT_EQ(wish_.scroll.x(), 0.0);
  type(kUp);
  look(0.5);
  EXPECT_NEAR(state_.device_m[1], 0.005, 1e-9);
}

TEST_F(Hand, AWindowThatIsMovedAtOnceLeavesTheHandWhereItIs) {
  type(kRight);
  look(0.5);
  const auto before_m = state_.device_m;
  state_.centre_m[0] += 0.1;
  state_.scale = 2.0;
  look(0.5);
  EXPECT_EQ(state_.device_m, before_m);
}

TEST_F(Hand, StepsAndPressureHaveEndsAndAreSaidInWords) {
  for (int k = 0; k < 9; ++k) type({Kind::letter, '*'});
  EXPECT_EQ(phrases_.text(keys_.take_words()->phrase), "Steps of {distance}");
  for (int k = 0; k < 9; ++k) type({Kind::letter, '/'});
  const auto words = keys_.take_words();
  EXPECT_EQ(phrases_.text(words->phrase, words->values), "Steps of 2 millimetres") << "at half the stone's size";
  for (int k = 0; k < 9; ++k) type({Kind::letter, 'd'});
  look(0.01);
  EXPECT_EQ(wish_.hand.press_n, 3.5);
  for (int k = 0; k < 9; ++k) type({Kind::letter, 'u'});
  look(0.01);
  EXPECT_EQ(wish_.hand.press_n, 0.3);
  type({Kind::letter, 'l'});
  look(0.01);
  EXPECT_EQ(wish_.hand.press_n, 0.0);
  type({Kind::insert, 0});
  look(0.01);
  EXPECT_EQ(wish_.hand.press_n, 0.3);
}

TEST_F(Hand, KeysOfTheSessionAreNotTheHands) {
  for (const char key : std::string(" 5+-npwhtr<>vsgq"))
    EXPECT_FALSE(keys_.press({Kind::letter, key}, time_s_, state_, phrases_)) << key;
}

}  // namespace
}  // namespace sparsha::app
