// Lines of sight over whole objects, judged by the formulas of the objects.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <Eigen/Geometry>

#include "scene/solid/sight.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::scene {
namespace {

using Eigen::Vector3d;

TEST(Sight, MeetsABallWhereTheLineDoesAndNothingBesideIt) {
  constexpr double kRadius_m = 0.04, kSpacing_m = 0.001;
  Charts charts = sparsha::test::ball_charts(kRadius_m, kSpacing_m);
  charts.origin_m = {3.0, -2.0, 1.0};
  const Sight sight(charts);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vector3d(normal(random), normal(random), normal(random)).normalized(); };
  int met = 0, passed = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vector3d from_m = 0.3 * direction();
    const Vector3d way = (0.055 * std::cbrt((k % 100) / 100.0) * direction() - from_m).normalized();
    const double middle_m = -from_m.dot(way);
    const double off_m = (from_m + middle_m * way).norm();
    const auto place = sight.along(charts.origin_m + from_m, 7.0 * way);
    if (off_m > kRadius_m + 0.5 * kSpacing_m) {
      EXPECT_FALSE(place) << off_m;
      ++passed;
    } else if (off_m < kRadius_m - kSpacing_m) {
      ASSERT_TRUE(place) << off_m;
      const Vector3d truth_m = from_m + (middle_m - std::sqrt(kRadius_m * kRadius_m - off_m * off_m)) * way;
      // A disc lies behind the ball by up to its radius squared over the ball's diameter.
      const double lean = -way.dot(truth_m.normalized());
      EXPECT_LT((place->at_m - charts.origin_m - truth_m).norm(), 0.03 * kSpacing_m / lean) << off_m;
      EXPECT_GT(place->normal.dot(truth_m.normalized()), 0.99);
      ++met;
    }
  }
  EXPECT_GT(met, 500);
  EXPECT_GT(passed, 200);
  EXPECT_FALSE(sight.along(charts.origin_m, Vector3d::UnitX())) << "from within all faces look away";
  EXPECT_FALSE(sight.along(charts.origin_m + Vector3d(0.3, 0.0, 0.0), Vector3d::UnitX())) << "it is behind";
  EXPECT_FALSE(sight.along({std::nan(""), 0.0, 0.0}, Vector3d::UnitX()));
  EXPECT_FALSE(sight.along(charts.origin_m, Vector3d::Zero()));
}

TEST(Sight, MeetsTheNearerOfTwoWallsAndTheirOuterFacesAlone) {
  // A plate of two spacings: seen from either side its own face is met.
  const Charts plate = sparsha::test::charts_of(
      [](Side side, double, double) -> std::optional<sparsha::test::SeenSurface> {
        if (side != Side::front && side != Side::back) return std::nullopt;
        return sparsha::test::SeenSurface{0.001, 0.0, 0.0};
      },
      40, 0.001);
  const Sight sight(plate);
  for (const double sign : {1.0, -1.0})
    for (int k = 0; k < 200; ++k) {
      const Vector3d from_m(0.02, -0.01, sign * 0.2);
      const Vector3d to_m(-0.03 + 0.0003 * k, 0.0002 * k - 0.02, 0.0);
      const auto place = sight.along(from_m, to_m - from_m);
      ASSERT_TRUE(place);
      EXPECT_NEAR(place->at_m.z(), sign * 0.001, 1e-9);
      EXPECT_NEAR(place->normal.z(), sign, 1e-9);
    }
}

TEST(Sight, KnowsTheFaceThatIsNearestToAPlace) {
  const Sight sight(sparsha::test::ball_charts(0.04, 0.001));
  const auto place = sight.nearest({0.0, 0.0, -0.0405});
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->at_m.z(), -0.04, 1e-5);
  EXPECT_NEAR(place->normal.z(), -1.0, 1e-3);
  EXPECT_FALSE(sight.nearest({0.0, 0.0, 0.0}));
}

}  // namespace
}  // namespace sparsha::scene
