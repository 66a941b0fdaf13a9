// The spacing of a grid that is chosen for a closed object is that of the points that are seen.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

/// A ball of radius 1; its half towards the viewer has `front` points, the other `back`.
Points ball(int front, int back, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Points points;
  for (int seen = 0, hidden = 0; seen < front || hidden < back;) {
    std::array<double, 3> p{normal(random), normal(random), normal(random)};
    const double length = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) / (1.0 + 0.0005 * normal(random));
    for (double& c : p) c /= length;
    int& count = p[2] > 0.0 ? seen : hidden;
    if (count == (p[2] > 0.0 ? front : back)) continue;
    ++count;
    points.push_back({p[0], p[1], p[2]});
  }
  return points;
}

TEST(FrontSpacing, FollowsTheSideThatIsSeen) {
  // Half a ball has the area 2 pi.
  const auto apart_m = [](int count) { return std::sqrt(2.0 * std::numbers::pi / count); };
  for (const auto& [front, back] : {std::pair{40'000, 40'000}, {60'000, 10'000}, {12'000, 60'000}}) {
    const pipeline::Projection projection = project_cloud(make_cloud(ball(front, back, 3)), {});
    ASSERT_TRUE(projection.closed);
    EXPECT_NEAR(projection.grid.lattice.spacing_m, apart_m(front), 0.2 * apart_m(front)) << front << ' ' << back;
    EXPECT_NEAR(projection.point_spacing_m, apart_m(front), 0.2 * apart_m(front)) << front << ' ' << back;
  }
}

}  // namespace
}  // namespace sparsha::test
