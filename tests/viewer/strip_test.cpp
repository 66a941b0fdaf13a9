// The strip of the last ten seconds.
#include <gtest/gtest.h>

#include <cmath>

#include "viewer/strip.h"

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

}  // namespace
}  // namespace sparsha::viewer::test
