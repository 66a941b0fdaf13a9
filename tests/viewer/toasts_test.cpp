// Which announcements are on the picture.
#include <gtest/gtest.h>

#include <vector>

#include "viewer/toasts.h"

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

}  // namespace
}  // namespace sparsha::viewer::test
