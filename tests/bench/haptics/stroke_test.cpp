// The validation stroke and its lags, judged where they are known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "bench/haptics/stroke.h"

namespace sparsha::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

TEST(Lag, OfAShiftedSignalIsItsShiftToAFractionOfATick) {
  for (const double shift : {-12.0, -0.4, 0.0, 0.25, 3.0, 17.6}) {
    std::vector<double> early, late;
    for (int k = 0; k < 2000; ++k) {
      const auto at = [](double t) { return std::sin(0.05 * t) + 0.4 * std::sin(0.021 * t + 1.0); };
      early.push_back(at(k));
      late.push_back(3.0 + 0.5 * at(k - shift));  // neither offset nor amplitude matters
    }
    EXPECT_NEAR(lag_ticks(early, late, 100), shift, 0.05) << shift;
  }
}

TEST(Stroke, CountsWholeTicks) {
  for (std::size_t ticks = 0; ticks < 3000; ++ticks) {
    EXPECT_EQ(stroke_ticks(static_cast<double>(ticks) * kStrokeTick_s), ticks);
    EXPECT_EQ(stroke_ticks(static_cast<double>(ticks) / 1000.0), ticks);
  }
  EXPECT_EQ(stroke_hands(true).size() - stroke_hands(false).size(), stroke_ticks(kStrokeApproach_s));
}

TEST(Stroke, BeginsTenMillimetresAboveTheSurfaceAndIsFourBelowItWhileItStrokes) {
  const std::vector<Eigen::Vector3d> hands = stroke_hands(true);
  const Eigen::Vector3d& first = hands.front();
  EXPECT_GT(first.z(), stroke_envelope(first.x(), first.y()) + 0.008);
  EXPECT_LT((hands[1] - hands[0]).norm(), 0.001);
  for (std::size_t k = 200; k < hands.size(); k += 50) {
    // Nearest point by a search that knows no slope.
    double least = 1.0;
    for (double dx = -0.006; dx <= 0.006; dx += 0.00005)
      for (double dy = -0.004; dy <= 0.004; dy += 0.0001) {
        const double x = hands[k].x() + dx, y = hands[k].y() + dy;
        least = std::min(least,
                         (Eigen::Vector3d(x, y, 0.05 * std::sin(kTurn * x) * std::sin(kTurn * y)) - hands[k]).norm());
      }
    EXPECT_NEAR(least, kStrokeDepth_m, 2e-6) << k;
  }
}

TEST(Stroke, ForceIsZeroInFreeSpaceAndStiffnessTimesDepthOnAPlane) {
  haptics::MongeSurface plane;
  plane.lattice = {3, 3, 0.5, {0.0, 0.0, 2.0}};  // z0 of storage is not that of the grid
  plane.height_m.assign(9, -2.0F);
  plane.highest_m = -2.0;
  std::vector<Eigen::Vector3d> hands;
  for (int k = 0; k < 100; ++k) hands.emplace_back(0.4, 0.4, 0.01 - 0.0002 * k);
  const Stroke stroke = render_stroke(plane, hands);
  EXPECT_EQ(stroke.force_n[10], 0.0);
  for (std::size_t k = 60; k < 100; ++k) {
    EXPECT_NEAR(stroke.z_mm[k], 0.0, 1e-9);
    EXPECT_NEAR(stroke.force_n[k], 800.0 * 0.1 * -hands[k].z(), 1e-9);
  }
}

}  // namespace
}  // namespace sparsha::bench
