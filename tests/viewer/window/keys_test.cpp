// Keyboards of other languages. A place is given by the character that a US keyboard has there, a name by what the
// layout prints on the key, as X11 and Wayland tell it.
#include "viewer/window/keys.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "viewer/actions/actions.h"
#include "viewer/cloud/controller.h"

namespace sparsha::viewer::test {
namespace {

struct Printed {
  char place;
  const char* name;
};
struct Keyboard {
  const char* language;
  std::vector<Printed> keys;
};

const std::vector<Keyboard>& keyboards() {
  static const std::vector<Keyboard> all{
      {"German",
       {{'[', "\xC3\xBC"}, {']', "+"}, {'0', "0"}, {'8', "8"}, {'9', "9"}, {'Y', "z"}, {'Z', "y"}, {'/', "-"}}},
      {"French",
       {{'[', "^"},
        {']', "$"},
        {'0', "\xC3\xA0"},
        {'1', "&"},
        {'6', "-"},
        {'8', "_"},
        {'9', "\xC3\xA7"},
        {'A', "q"},
        {'Q', "a"}}},
      {"Spanish", {{'[', "`"}, {']', "+"}, {'0', "0"}, {'8', "8"}, {'9', "9"}}},
      {"Greek", {{'Q', ";"}, {'W', "\xCF\x82"}, {'N', "\xCE\xBD"}, {'[', "["}, {']', "]"}, {'8', "8"}, {'9', "9"}}}};
  return all;
}

std::optional<Action> action_at(const Keyboard& keyboard, char place) {
  for (const Printed& printed : keyboard.keys)
    if (printed.place == place) return action_of({key_of(place, printed.name, is_key), 0, false}, false);
  return std::nullopt;
}

bool reaches(const Keyboard& keyboard, Action action) {
  for (const Printed& printed : keyboard.keys)
    if (action_at(keyboard, printed.place) == action) return true;
  return false;
}

TEST(Keys, HarderAndSofterAreInReachOnEveryKeyboard) {
  for (const Keyboard& keyboard : keyboards()) {
    EXPECT_TRUE(reaches(keyboard, Action::softer)) << keyboard.language;
    EXPECT_TRUE(reaches(keyboard, Action::stiffer)) << keyboard.language;
  }
}

TEST(Keys, ABracketIsToldByItsPlaceWhereNothingElseIsBoundToItsName) {
  EXPECT_EQ(key_of('[', "\xC3\xBC", is_key), '[');
  EXPECT_EQ(key_of('[', "^", is_key), '[');
  EXPECT_EQ(key_of(']', "$", is_key), ']');
  EXPECT_EQ(key_of(']', "+", is_key), '+') << "zooms on a German keyboard";
  EXPECT_EQ(key_of('[', nullptr, is_key), '[');
}

TEST(Keys, LettersAreToldByTheirNamesAndByTheirPlaceInOtherAlphabets) {
  EXPECT_EQ(key_of('Y', "z", is_key), 'Z');
  EXPECT_EQ(key_of('Q', "a", is_key), 'A');
  EXPECT_EQ(key_of('W', "\xCF\x82", is_key), 'W');
  EXPECT_EQ(key_of('N', "\xCE\xBD", is_key), 'N');
  EXPECT_EQ(key_of('Q', "a", is_cloud_key), 'A') << "where A means nothing, it does not leave";
  EXPECT_EQ(key_of('Q', "'", is_key), '\'') << "nor does an apostrophe (Dvorak)";
}

TEST(Keys, EveryFaceOfTheRawCloudIsAtItsDigitOnAKeyboardWithoutUnshiftedDigits) {
  const std::vector<Printed> azerty{{'1', "&"}, {'2', "\xC3\xA9"}, {'3', "\""}, {'4', "'"},        {'5', "("},
                                    {'6', "-"}, {'7', "\xC3\xA8"}, {'8', "_"},  {'9', "\xC3\xA7"}, {'0', "\xC3\xA0"}};
  for (const Printed& printed : azerty) EXPECT_EQ(key_of(printed.place, printed.name, is_cloud_key), printed.place);
  EXPECT_EQ(key_of('6', "-", is_key), '-') << "zooms out where that digit means nothing";
}

}  // namespace
}  // namespace sparsha::viewer::test
