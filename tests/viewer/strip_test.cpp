// The strip of the last ten seconds.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/soft_stone.h"
#include "viewer/overlay/strip.h"

namespace sparsha::viewer::test {
namespace {

TEST(Strip, TheFullScaleOfAFastMoveIsReadInMetresAndNeverWithAnExponent) {
  EXPECT_EQ(full_scale_text(4.0, "N"), "4 N");
  EXPECT_EQ(full_scale_text(20.0, "mm/s"), "20 mm/s");
  EXPECT_EQ(full_scale_text(640.0, "mm/s"), "640 mm/s");
  EXPECT_EQ(full_scale_text(1280.0, "mm/s"), "1.28 m/s");
  EXPECT_EQ(full_scale_text(2048.0, "mm"), "2.05 m");
  for (int k = 0; k < 16; ++k)  // the strip's steps, up to 655 m/s
    EXPECT_EQ(full_scale_text(20.0 * std::exp2(k), "mm/s").find('e'), std::string::npos) << k;
}

TEST(Strip, ShowsTheForceThatTheHandGetsWhereTheRawOneIsLarger) {
  sparsha::test::SoftStone stone(haptics::window_on(sparsha::test::flat_scene()));
  Strip strip;
  strip.add(stone.felt());
  for (int k = 0; k < 50; ++k) strip.add(stone.stroke(1e-5 * k));
  ASSERT_EQ(strip.samples().size(), 51U);
  EXPECT_GT(strip.samples().front().force_n, 7.9);
  for (std::size_t k = 1; k < strip.samples().size(); ++k) EXPECT_EQ(strip.samples()[k].force_n, 0.0);
  EXPECT_GT(stone.state().force_n[2], stone.kRaw_n);
}

}  // namespace
}  // namespace sparsha::viewer::test
