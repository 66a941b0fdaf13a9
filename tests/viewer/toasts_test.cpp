// Which announcements are on the picture.
#include <gtest/gtest.h>

#include <vector>

#include "viewer/overlay/toasts.h"

namespace sparsha::viewer::test {
namespace {

TEST(Toasts, OfAScriptThatTheWindowDoesNotWriteAreNotShownAsQuestionMarks) {
  Toasts toasts;
  haptics::AnnouncementBoard board;
  board.say("कमल का पदक, 20 सेंटीमीटर");
  EXPECT_TRUE(toasts.update(0.0, &board).empty());
  for (const char* words : {"Padmāsana", "Πόδι", "Лицо", "Лотос → कमल", "20 – 30 °", "\xE4 in Latin-1"}) {
    board.say(words);
    const std::vector<Toast> shown = toasts.update(0.1, &board);
    ASSERT_FALSE(shown.empty()) << words;
    EXPECT_EQ(shown.back().announcement.text, words);
  }
}

TEST(Toasts, OfAPlaceGoAtMostASecondAfterTheHandHasLeftIt) {
  using haptics::Announcement;
  for (const auto place : {Announcement::Place::part, Announcement::Place::unmeasured, Announcement::Place::edge}) {
    Toasts toasts;
    haptics::AnnouncementBoard board;
    board.say("The face of the lion, which looks at the stairs", Announcement::Priority::information,
              Announcement::Control::none, place);
    board.say("Whole stone, 40 centimetres across");
    bool there = true;
    const auto count = [&](double time_s) {
      return toasts
          .update(time_s, &board,
                  [&](const Announcement& shown) {
                    EXPECT_EQ(shown.place, place);
                    return there;
                  })
          .size();
    };
    EXPECT_EQ(count(0.0), 2U);
    EXPECT_EQ(count(1.5), 2U);
    there = false;
    EXPECT_EQ(count(2.0), 2U);
    EXPECT_EQ(count(2.4), 2U) << "a hand that shakes at a border is no reason to flicker";
    EXPECT_EQ(count(2.51), 1U) << "the hand was last there at 1.5 s";
    there = true;
    EXPECT_EQ(count(2.6), 1U);
  }
}

TEST(Toasts, NoTroubleStaysOnThePictureOfAnExhibitThatIsLeft) {
  Toasts toasts;
  haptics::AnnouncementBoard board;
  board.say("The stone went soft", haptics::Announcement::Priority::fault);
  board.say("No signal from the hand", haptics::Announcement::Priority::warning);
  EXPECT_EQ(toasts.update(0.0, &board).size(), 2U);
  toasts.hide_faults(true);
  EXPECT_TRUE(toasts.update(0.1, &board).empty());
  board.say("The hand is slow", haptics::Announcement::Priority::warning);
  board.say("Whole stone");
  const std::vector<Toast> shown = toasts.update(0.2, &board);
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_EQ(shown[0].announcement.text, "Whole stone");
}

TEST(Toasts, OfFaultsAreNotShownWhereNobodyIsThereNorAfterwards) {
  Toasts toasts;
  haptics::AnnouncementBoard board;
  toasts.hide_faults(true);
  board.say("The stone went soft", haptics::Announcement::Priority::fault);
  board.say("Whole stone");
  ASSERT_EQ(toasts.update(0.0, &board).size(), 1U);
  toasts.hide_faults(false);
  EXPECT_EQ(toasts.update(0.1, &board).size(), 1U);
  board.say("The stone went soft", haptics::Announcement::Priority::fault);
  EXPECT_EQ(toasts.update(0.2, &board).size(), 2U);
}

}  // namespace
}  // namespace sparsha::viewer::test
