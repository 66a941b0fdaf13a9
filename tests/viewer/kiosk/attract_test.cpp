// An exhibit without visitors, and which keys it hears.
#include <gtest/gtest.h>

#include <set>

#include "viewer/actions/actions.h"
#include "viewer/kiosk/attract.h"

namespace sparsha::viewer::test {
namespace {

using Change = Attract::Change;

haptics::State hand_at(double x_m) {
  haptics::State state;
  state.tick = 1;
  state.device_m = {x_m, 0.0, 0.0};
  return state;
}

TEST(Attract, BeginsAfterAMinuteWithoutATouchAndEndsWithTheNext) {
  Attract attract;
  double t = 100.0;
  EXPECT_EQ(attract.update(t, {}), Change::none);
  EXPECT_EQ(attract.update(t += 59.9, {}), Change::none);
  EXPECT_EQ(attract.update(t += 0.2, {}), Change::begins);
  EXPECT_TRUE(attract.shows());
  EXPECT_EQ(attract.update(t += 1000.0, {}), Change::none) << "once";
  attract.touched();
  EXPECT_EQ(attract.update(t += 0.1, {}), Change::ends);
  EXPECT_FALSE(attract.shows());
  EXPECT_EQ(attract.update(t += 59.9, {}), Change::none) << "the minute counts from the touch";
  EXPECT_EQ(attract.update(t += 0.2, {}), Change::begins);
}

TEST(Attract, AHandThatMovesIsATouchAndOneAtRestIsNone) {
  Attract attract;
  double t = 0.0;
  EXPECT_EQ(attract.update(t, hand_at(0.01)), Change::none);
  for (int k = 0; k < 59; ++k) EXPECT_EQ(attract.update(t += 1.0, hand_at(0.01 + 1e-4 * (k % 2))), Change::none);
  EXPECT_EQ(attract.update(t += 1.5, hand_at(0.01)), Change::begins) << "trembling by 0.1 mm is rest";
  EXPECT_EQ(attract.update(t += 0.1, hand_at(0.02)), Change::ends);
  for (int k = 0; k < 30; ++k) EXPECT_EQ(attract.update(t += 10.0, hand_at(0.003 * k)), Change::none);
}

TEST(Attract, TheLightRakesAndGoesRoundSlowly) {
  Attract attract(1.0);
  static_cast<void>(attract.update(0.0, {}));
  static_cast<void>(attract.update(2.0, {}));
  const KeyLight first = attract.light(2.0);
  EXPECT_LT(first.elevation_rad, KeyLight{}.elevation_rad);
  std::set<double> angles;
  for (double t = 2.0; t < 182.0; t += 0.1) angles.insert(attract.light(t).azimuth_rad);
  EXPECT_EQ(angles.size(), 180U) << "every step of two degrees once";
  EXPECT_NEAR(*angles.begin(), first.azimuth_rad - 2.0 * 3.14159265 * 179.0 / 180.0, 1e-6);
}

TEST(Kiosk, VisitorsKeysNeitherLeaveNorScan) {
  const std::set<Action> staff{Action::rescan, Action::orient, Action::stiffer, Action::softer, Action::stereo};
  for (const int modifiers : {0, kShift, kControl, kShift | kControl})
    for (int key = 0; key < 300; ++key) {
      const auto action = action_of({key, modifiers, false}, true);
      if (!action) continue;
      EXPECT_FALSE(staff.contains(*action)) << info_of(*action).label;
      if (*action == Action::quit) {
        EXPECT_EQ(key, 'Q');
        EXPECT_NE(modifiers & kControl, 0);
      }
    }
}

}  // namespace
}  // namespace sparsha::viewer::test
