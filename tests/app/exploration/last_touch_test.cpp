// What a picture taken after the run shows: the last touch, and the seconds before it.
#include <gtest/gtest.h>

#include "app/exploration/exploration.h"

namespace sparsha::app {
namespace {

haptics::State at(int k, bool touches) {
  haptics::State state;
  state.tick = static_cast<std::uint64_t>(k + 1);
  state.time_s = 0.01 * k;
  state.flags = haptics::kFlagArmed;
  state.contact = touches ? 1 : 0;
  state.commanded_force_n = {0.0, 0.0, touches ? 1.5 : 0.0};
  return state;
}

TEST(LastTouch, HasTheStripThatEndsWithIt) {
  LastTouch touch;
  for (int k = 0; k < 100; ++k) touch.see(at(k, k >= 40));
  ASSERT_FALSE(touch.strip().samples().empty());
  EXPECT_DOUBLE_EQ(touch.strip().samples().back().time_s, 0.99);
  for (int k = 100; k < 3000; ++k) touch.see(at(k, false));
  EXPECT_DOUBLE_EQ(touch.state().time_s, 0.99);
  ASSERT_EQ(touch.strip().samples().size(), 100U) << "the seconds before the touch, not those after it";
  EXPECT_DOUBLE_EQ(touch.strip().samples().back().time_s, touch.state().time_s);
  EXPECT_DOUBLE_EQ(touch.strip().samples().back().force_n, 1.5);
  touch.see(at(3000, true));
  EXPECT_DOUBLE_EQ(touch.strip().samples().back().time_s, 30.0);
}

}  // namespace
}  // namespace sparsha::app
