// What presses of the grip's buttons mean, by clicks and holds written out by hand.
#include "haptics/session/buttons.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "haptics/session/button_tour.h"
#include "tests/support/scenes.h"

namespace sparsha::haptics {
namespace {

enum Bit : std::uint64_t { kRight = 1, kForward = 2, kCentre = 4, kLeft = 8 };

/// A grip that a test presses, looked at every 10 ms.
class Grip {
 public:
  /// Holds these buttons for so long; what the looks meanwhile made of it.
  std::vector<Gesture> hold(std::uint64_t buttons, double duration_s) {
    std::vector<Gesture> all;
    for (double t = 0.0; t < duration_s - 1e-9; t += 0.01) {
      press(buttons);
      state_.time_s += 0.01;
      for (const Gesture gesture : reader_.read(state_)) all.push_back(gesture);
    }
    return all;
  }
  /// Nothing is known of the grip, as without its device.
  std::vector<Gesture> lose(double duration_s) {
    state_.flags |= kFlagStale;
    std::vector<Gesture> all = hold(state_.buttons, 0.1);
    for (const Gesture gesture : hold(0, duration_s)) all.push_back(gesture);
    state_.flags = 0;
    return all;
  }
  /// A whole object, or one view.
  void touch(bool around) { state_.flags = around ? std::uint64_t{kFlagAround} : 0U; }
  /// Between two looks.
  void press(std::uint64_t buttons) {
    for (std::size_t k = 0; k < 4; ++k) state_.button_presses[k] += (buttons & ~state_.buttons) >> k & 1U;
    state_.buttons = buttons;
  }

 private:
  State state_;
  Buttons reader_;
};

using Gestures = std::vector<Gesture>;

TEST(GripButtons, TurnAWholeObjectWhileForwardIsHeld) {
  for (const bool around : {true, false}) {
    Grip grip;
    grip.touch(around);
    EXPECT_EQ(grip.hold(kForward, 0.4), Gestures{Gesture::drag});
    grip.hold(kForward | kRight, 0.1);
    EXPECT_EQ(grip.hold(kForward, 0.1), Gestures{around ? Gesture::turn_right : Gesture::zoom_in});
    grip.hold(kForward | kLeft, 0.1);
    EXPECT_EQ(grip.hold(kForward, 0.1), Gestures{around ? Gesture::turn_left : Gesture::zoom_out});
    grip.hold(kForward | kCentre, 0.1);
    EXPECT_EQ(grip.hold(kForward, 0.1), Gestures{around ? Gesture::tip : Gesture::describe});
    EXPECT_EQ(grip.hold(0, 0.1), Gestures{Gesture::let_go});
    grip.hold(kRight, 0.1);
    EXPECT_EQ(grip.hold(0, 0.1), Gestures{Gesture::zoom_in});
  }
}

TEST(GripButtons, ClickWhenTheyAreLetGo) {
  Grip grip;
  EXPECT_EQ(grip.hold(kRight, 0.2), Gestures{});
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{Gesture::zoom_in});
  EXPECT_EQ(grip.hold(kLeft, 0.3), Gestures{});
  EXPECT_EQ(grip.hold(0, 1.0), Gestures{Gesture::zoom_out});
  grip.hold(kCentre, 0.5);
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{Gesture::describe});
  grip.hold(kForward, 0.1);
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{Gesture::whole_scene});
}

TEST(GripButtons, HeldMeanSomethingElseAndSayItOnceAndAtOnce) {
  Grip grip;
  EXPECT_EQ(grip.hold(kRight, 1.5), Gestures{Gesture::next_part});
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{}) << "no zoom after it";
  EXPECT_EQ(grip.hold(kLeft, 0.8), Gestures{Gesture::previous_part});
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{});
  EXPECT_EQ(grip.hold(kCentre, 1.0), Gestures{Gesture::help});
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{});
  EXPECT_EQ(grip.hold(kCentre, 4.5), (Gestures{Gesture::help, Gesture::speech_on})) << "held for 2 s";
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{});
  EXPECT_EQ(grip.hold(kCentre, 9.0), (Gestures{Gesture::help, Gesture::speech_on, Gesture::speech_off})) << "5 s";
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{});
  EXPECT_EQ(grip.hold(kRight, 3.0), (Gestures{Gesture::next_part, Gesture::guide})) << "held for 2 s";
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{});
  EXPECT_EQ(grip.hold(kLeft, 3.0), (Gestures{Gesture::previous_part, Gesture::guide})) << "likewise";
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{});
  EXPECT_EQ(grip.hold(kForward, 2.0), Gestures{Gesture::drag});
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{Gesture::let_go});
}

TEST(GripButtons, ThatGoWithTheirDeviceAreNoClickButLetTheStoneGo) {
  Grip grip;
  for (const std::uint64_t button : {kRight, kForward, kCentre, kLeft}) {
    EXPECT_EQ(grip.hold(button, 0.05), Gestures{});
    EXPECT_EQ(grip.lose(1.0), Gestures{}) << button;
    EXPECT_EQ(grip.hold(0, 0.1), Gestures{});
  }
  EXPECT_EQ(grip.hold(kForward, 0.3), Gestures{Gesture::drag});
  EXPECT_EQ(grip.lose(1.0), Gestures{Gesture::let_go});
  EXPECT_EQ(grip.hold(kRight, 0.1), Gestures{});
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{Gesture::zoom_in}) << "as ever once it is back";
}

TEST(GripButtons, AreToldApartWhenSeveralAreDown) {
  Grip grip;
  EXPECT_EQ(grip.hold(kForward, 0.3), Gestures{Gesture::drag});
  EXPECT_EQ(grip.hold(kForward | kRight, 0.2), Gestures{});
  EXPECT_EQ(grip.hold(kForward, 0.1), Gestures{Gesture::zoom_in}) << "zooming while dragging";
  EXPECT_EQ(grip.hold(0, 0.1), Gestures{Gesture::let_go});
}

TEST(GripButtons, NoClickIsLostBetweenTwoLooksAndNoneCountsTwice) {
  Grip grip;
  grip.press(kRight);
  grip.press(0);
  EXPECT_EQ(grip.hold(0, 0.05), Gestures{Gesture::zoom_in});
  // A contact that bounces.
  for (int k = 0; k < 3; ++k) {
    grip.press(kRight);
    grip.press(0);
  }
  grip.press(kRight);
  EXPECT_EQ(grip.hold(kRight, 0.1), Gestures{});
  EXPECT_EQ(grip.hold(0, 0.3), Gestures{Gesture::zoom_in});
}

class Tour : public ::testing::Test {
 protected:
  std::vector<std::string> said() {
    std::vector<std::string> words;
    for (const Announcement& a : board_.since(0)) words.push_back(a.text);
    return words;
  }
  AnnouncementBoard board_;
  Announcer announcer_{board_, sparsha::test::flat_scene()};
  ButtonTour tour_{announcer_};
};

TEST_F(Tour, WaitsForEachButtonAndPraises) {
  tour_.start(5.0, true);
  double t = 5.0;
  tour_.watch({Gesture::zoom_out}, t += 1.0);
  EXPECT_EQ(said().size(), 1U) << "that was not the one";
  for (const Gesture gesture :
       {Gesture::zoom_in, Gesture::zoom_out, Gesture::previous_part, Gesture::let_go, Gesture::describe})
    tour_.watch({gesture}, t += 1.0);
  EXPECT_FALSE(tour_.running());
  const auto words = said();
  ASSERT_EQ(words.size(), 6U);
  for (std::size_t k = 1; k < words.size(); ++k) EXPECT_EQ(words[k].rfind("Good.", 0), 0U) << words[k];
}

TEST_F(Tour, IsOverInAMinuteAlsoForAHandThatDoesNothing) {
  tour_.start(0.0, true);
  for (double t = 0.0; t < 60.0; t += 0.01) tour_.watch({}, t);
  EXPECT_FALSE(tour_.running());
  EXPECT_EQ(said().size(), 6U);
}

TEST_F(Tour, OfAHandWithoutAGripIsOneOfKeys) {
  tour_.start(0.0, true, false);
  double t = 0.0;
  for (const Gesture gesture : {Gesture::zoom_in, Gesture::zoom_out, Gesture::next_part, Gesture::describe})
    tour_.watch({gesture}, t += 1.0);
  EXPECT_FALSE(tour_.running());
  const auto words = said();
  ASSERT_EQ(words.size(), 5U);
  for (const std::string& told : words)
    for (const char* of_grip : {"grip", "button", "right", "left"})
      EXPECT_EQ(told.find(of_grip), std::string::npos) << told;
}

TEST_F(Tour, DoesNotGoOnBetweenOtherWords) {
  tour_.start(0.0, true);
  for (double t = 0.0; t < 40.0; t += 2.0) {
    announcer_.say("hand_down");
    tour_.watch({}, t);
  }
  std::size_t of_tour = 0;
  for (const std::string& words : said()) of_tour += words.find("button") != std::string::npos ? 1 : 0;
  EXPECT_EQ(of_tour, 1U);
  EXPECT_TRUE(tour_.running());
  tour_.watch({Gesture::zoom_in}, 41.0);
  EXPECT_EQ(said().back().rfind("Good.", 0), 0U) << "a step that is done goes on at once";
  for (double t = 42.0; t < 110.0; t += 2.0) {
    announcer_.say("hand_down");
    tour_.watch({}, t);
  }
  EXPECT_FALSE(tour_.running());
}

TEST_F(Tour, EndsWhenTheVisitorAsksForHelpOrTheGuide) {
  for (const Gesture asked : {Gesture::help, Gesture::guide}) {
    tour_.start(0.0, true);
    tour_.watch({asked}, 0.0);
    EXPECT_TRUE(tour_.running()) << "the hold that began it";
    tour_.watch({asked}, 1.0);
    EXPECT_FALSE(tour_.running());
  }
}

TEST_F(Tour, LeavesPartsOutWhereThereAreNone) {
  tour_.start(0.0, false);
  for (double t = 0.0; t < 60.0; t += 0.01) tour_.watch({}, t);
  for (const std::string& words : said()) EXPECT_EQ(words.find("part"), std::string::npos) << words;
}

}  // namespace
}  // namespace sparsha::haptics
