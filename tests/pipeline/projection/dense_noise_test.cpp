// Clouds so dense that their points scatter as far as they are apart: several scans of a noisy scanner, taken together.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

#include <Eigen/Core>

#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

constexpr double kNode_m = 0.001;
constexpr double kSide_m = 0.12;  // square

double wave_m(double x, double y) { return 0.004 * std::sin(60.0 * x) * std::cos(50.0 * y) + 0.2 * x; }

/// A relief of so many points to a node that scatter by `noise_m`.
Points relief(double to_a_node, double noise_m) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0.0, kSide_m);
  std::normal_distribution<double> normal(0.0, noise_m);
  Points points;
  const auto count = static_cast<std::size_t>(to_a_node * (kSide_m / kNode_m) * (kSide_m / kNode_m));
  for (std::size_t k = 0; k < count; ++k) {
    const double x = uniform(random);
    const double y = uniform(random);
    points.push_back({x, y, wave_m(x, y) + normal(random)});
  }
  return points;
}

/// The same of a ball of `radius_m`, seen from all sides.
Points ball(double to_a_node, double noise_m, double radius_m) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal(0.0, 1.0);
  Points points;
  const auto count =
      static_cast<std::size_t>(to_a_node * 4.0 * std::numbers::pi * radius_m * radius_m / (kNode_m * kNode_m));
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d way = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Eigen::Vector3d place = (radius_m + noise_m * normal(random)) * way;
    points.push_back({place.x(), place.y(), place.z()});
  }
  return points;
}

TEST(DenseNoise, AReliefIsDecidedByWindowsHoweverFarItsPointsScatter) {
  scene::GridConfig config;
  config.spacing_m = kNode_m;
  for (const double to_a_node : {4.0, 16.0, 40.0}) {
    const double apart_m = kNode_m / std::sqrt(to_a_node);
    for (const double noises : {0.5, 0.8, 1.2, 2.0, 4.0}) {
      SCOPED_TRACE(testing::Message() << to_a_node << " points to a node, noise of " << noises << " distances");
      const pipeline::Projection found = project_cloud(make_cloud(relief(to_a_node, noises * apart_m)), config);
      EXPECT_FALSE(found.discs);
      if (noises <= 2.0) {
        EXPECT_FALSE(found.facing_asked);
      }
      EXPECT_LE(found.scattered, 0.0001 * static_cast<double>(found.used));
      EXPECT_NEAR(found.noise_m, noises * apart_m, 0.1 * noises * apart_m);
      const auto inside = [](double x, double y) { return std::min({x, y, kSide_m - x, kSide_m - y}) > 2.0 * kNode_m; };
      const Errors errors = judge(found.grid, wave_m, inside);
      EXPECT_EQ(errors.measured, 1.0);
      // A node is the mean of its points and of some around it.
      EXPECT_LT(errors.rms_m, 0.75 * noises * apart_m / std::sqrt(to_a_node) + 0.01 * kNode_m);
    }
  }
}

TEST(DenseNoise, ABallHasTwoSidesHoweverFarItsPointsScatter) {
  scene::GridConfig config;
  config.spacing_m = kNode_m;
  constexpr double kRadius_m = 0.03;
  for (const double to_a_node : {4.0, 16.0}) {
    const double apart_m = kNode_m / std::sqrt(to_a_node);
    for (const double noises : {0.5, 0.8, 1.2}) {
      SCOPED_TRACE(testing::Message() << to_a_node << " points to a node, noise of " << noises << " distances");
      const pipeline::Projection found =
          project_cloud(make_cloud(ball(to_a_node, noises * apart_m, kRadius_m)), config);
      EXPECT_TRUE(found.discs);
      EXPECT_TRUE(found.closed);
      const auto cap_m = [](double x, double y) {
        return std::sqrt(std::max(0.0, kRadius_m * kRadius_m - x * x - y * y));
      };
      const Errors errors =
          judge(found.grid, cap_m, [](double x, double y) { return std::hypot(x, y) < 0.8 * kRadius_m; });
      EXPECT_GT(errors.measured, 0.98);
      EXPECT_LT(errors.p99_m, noises * apart_m + 0.2 * kNode_m);
    }
  }
}

}  // namespace
}  // namespace sparsha::test
