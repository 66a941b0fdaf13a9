// Grounds made from heights are surfaces whose slope is that of their height, and deep enough for the hand.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bench/race/spline_ground.h"

namespace sparsha::bench {
namespace {

std::vector<double> heights(int side, double (*z)(double, double)) {
  std::vector<double> all;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i)
      all.push_back(z(static_cast<double>(i) / (side - 1), static_cast<double>(j) / (side - 1)));
  return all;
}

TEST(SplineGround, APlaneStaysThatPlane) {
  const protocol::Ground ground =
      spline_ground("plane", heights(33, [](double x, double y) { return 0.3 * x - 0.2 * y + 1.0; }), 33, 0.002);
  for (double x = 0.1; x < 0.9; x += 0.07)
    for (double y = 0.1; y < 0.9; y += 0.07) {
      EXPECT_NEAR(ground.height(x, y), 0.3 * x - 0.2 * y + 1.0, 1e-12);
      EXPECT_NEAR(ground.slope(x, y).x(), 0.3, 1e-10);
      EXPECT_NEAR(ground.slope(x, y).y(), -0.2, 1e-10);
    }
}

TEST(SplineGround, SlopeIsTheDerivativeOfHeightOnRoughHeights) {
  const protocol::Ground ground = spline_ground(
      "rough", heights(65, [](double x, double y) { return 0.01 * std::sin(40.0 * x + 3.0) * std::cos(31.0 * y); }), 65,
      0.002);
  constexpr double kStep = 1e-6;
  for (double x = 0.05; x < 0.95; x += 0.0313)
    for (double y = 0.05; y < 0.95; y += 0.0371) {
      const double dx = (ground.height(x + kStep, y) - ground.height(x - kStep, y)) / (2.0 * kStep);
      const double dy = (ground.height(x, y + kStep) - ground.height(x, y - kStep)) / (2.0 * kStep);
      EXPECT_NEAR(ground.slope(x, y).x(), dx, 1e-7);
      EXPECT_NEAR(ground.slope(x, y).y(), dy, 1e-7);
    }
}

TEST(SplineGround, SharpHeightsAreSmoothedUntilTheHandHasOneFoot) {
  const auto needle = [](double x, double y) { return std::hypot(x - 0.5, y - 0.5) < 0.02 ? 0.05 : 0.0; };
  const protocol::Ground ground = spline_ground("needle", heights(129, needle), 129, 0.002);
  EXPECT_GE(ground.most_depth_m, 0.002);
  EXPECT_GT(ground.height(0.5, 0.5), 0.001);
}

}  // namespace
}  // namespace sparsha::bench
