#include "scene/ground/continuation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace sparsha::scene {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(Continuation, KeepsKnownHeightsAndContinuesThemSmoothlyWithoutNan) {
  constexpr int kNodes = 97;
  const auto height = [](int i, int j) { return 0.02 * i - 0.01 * j + 0.1 * std::sin(0.2 * i) * std::cos(0.15 * j); };
  std::vector<float> heights;
  for (int j = 0; j < kNodes; ++j)
    for (int i = 0; i < kNodes; ++i) {
      const bool hole = std::hypot(i - 30, j - 40) < 12.0 || i > 80;
      heights.push_back(hole ? kNan : static_cast<float>(height(i, j)));
    }
  const std::vector<float> before = heights;
  continue_heights(heights, kNodes, kNodes);
  float steepest_known = 0.0F;
  float steepest_filled = 0.0F;
  for (int j = 0; j < kNodes; ++j)
    for (int i = 0; i + 1 < kNodes; ++i) {
      const std::size_t k = static_cast<std::size_t>(j * kNodes + i);
      ASSERT_TRUE(std::isfinite(heights[k]));
      if (std::isfinite(before[k])) {
        EXPECT_EQ(heights[k], before[k]);
      }
      const float step = std::abs(heights[k + 1] - heights[k]);
      const bool known = std::isfinite(before[k]) && std::isfinite(before[k + 1]);
      (known ? steepest_known : steepest_filled) = std::max(known ? steepest_known : steepest_filled, step);
    }
  EXPECT_LE(steepest_filled, 2.0F * steepest_known) << "no edge that the known surface does not have";
}

TEST(Continuation, GivesALevelSurfaceWhereOneNodeOrNoneIsKnown) {
  std::vector<float> heights(35, kNan);
  continue_heights(heights, 7, 5);
  EXPECT_EQ(heights, std::vector<float>(35, 0.0F));
  heights.assign(35, kNan);
  heights[17] = 1.25F;
  heights[3] = std::numeric_limits<float>::infinity();
  continue_heights(heights, 7, 5);
  for (const float z : heights) EXPECT_NEAR(z, 1.25F, 1e-6F);
}

TEST(Continuation, KeepsKnownNodesAndStaysWithinTheirRange) {
  constexpr int kColumns = 61;
  constexpr int kRows = 37;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> height(-0.01F, 0.02F);
  std::vector<float> truth(kColumns * kRows);
  for (float& z : truth) z = height(random);
  std::vector<float> heights = truth;
  for (int j = 10; j < 30; ++j)
    for (int i = 20; i < kColumns; ++i) heights[static_cast<std::size_t>(j * kColumns + i)] = kNan;
  const std::vector<float> holed = heights;
  continue_heights(heights, kColumns, kRows);
  for (std::size_t k = 0; k < heights.size(); ++k) {
    if (std::isfinite(holed[k])) {
      EXPECT_EQ(heights[k], truth[k]);
    }
    EXPECT_GE(heights[k], -0.01F);
    EXPECT_LE(heights[k], 0.02F);
  }
}

}  // namespace
}  // namespace sparsha::scene
