// Nearest point of a bilinear patch against dense sampling, which knows neither polynomials nor edges.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pipeline/check/patch.h"

namespace sparsha::pipeline {
namespace {

double height(const Patch& p, double u, double v) {
  return p.z00 * (1 - u) * (1 - v) + p.z10 * u * (1 - v) + p.z01 * (1 - u) * v + p.z11 * u * v;
}

double squared(const Patch& p, double u, double v, double x, double y, double z) {
  return (x - u) * (x - u) + (y - v) * (y - v) + std::pow(z - height(p, u, v), 2);
}

/// Smallest squared distance over a lattice of n x n places.
double sampled(const Patch& p, double x, double y, double z, int n) {
  double best = std::numeric_limits<double>::infinity();
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      best = std::min(best, squared(p, static_cast<double>(i) / n, static_cast<double>(j) / n, x, y, z));
  return best;
}

TEST(ClosestOnPatch, IsNeverBeatenByDenseSamplingAndLiesOnThePatch) {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int round = 0; round < 3000; ++round) {
    const double roughness = std::pow(10, 1.5 * unit(random)), far = std::pow(10, 1.5 * unit(random));
    const Patch p{roughness * unit(random), roughness * unit(random), roughness * unit(random),
                  roughness * unit(random)};
    const double x = 0.5 + far * unit(random), y = 0.5 + far * unit(random),
                 z = std::max(far, roughness) * unit(random);
    const PatchPoint found = closest_on_patch(p, x, y, z);
    ASSERT_TRUE(found.u >= 0 && found.u <= 1 && found.v >= 0 && found.v <= 1);
    ASSERT_NEAR(found.squared_distance, squared(p, found.u, found.v, x, y, z), 1e-12 * (1 + found.squared_distance));
    const double oracle = sampled(p, x, y, z, 200);
    // Nowhere does a sample come nearer, and the samples come as near as half their own spacing lets them.
    ASSERT_LE(found.squared_distance, oracle * (1 + 1e-12)) << "round " << round;
    const double slack = (1 + 4 * roughness) / 200;
    ASSERT_LE(std::sqrt(oracle), std::sqrt(found.squared_distance) + slack) << "round " << round;
  }
}

TEST(ClosestOnPatch, FindsTheGlobalMinimumOfStronglyTwistedPatches) {
  std::mt19937 random(32);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int round = 0; round < 400; ++round) {
    const double twist = 1000 * unit(random);
    const Patch p{twist, -twist, -twist, twist};
    const double x = 0.5 + unit(random), y = 0.5 + unit(random), z = twist * unit(random);
    const PatchPoint found = closest_on_patch(p, x, y, z);
    ASSERT_LE(found.squared_distance, sampled(p, x, y, z, 400) * (1 + 1e-12)) << "round " << round;
  }
}

TEST(ClosestOnPatch, AgreesWithTheSearchWhereTheDistanceIsConvex) {
  std::mt19937 random(33);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int round = 0; round < 20000; ++round) {
    const Patch p{0.3 * unit(random), 0.3 * unit(random), 0.3 * unit(random), 0.3 * unit(random)};
    const double x = 0.5 + unit(random), y = 0.5 + unit(random), z = 0.4 * unit(random);
    const PatchPoint exact = closest_on_patch(p, x, y, z), other = closest_on_patch_by_search(p, x, y, z);
    ASSERT_NEAR(exact.squared_distance, other.squared_distance, 1e-13) << "round " << round;
    if (exact.squared_distance > 1e-12) {
      ASSERT_EQ(exact.side > 0, other.side > 0);
    }
  }
}

TEST(ClosestOnPatch, AgreesWithTheSearchOnSteepAndTwistedGround) {
  std::mt19937 random(34);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double steep : {3.0, 30.0, 300.0}) {
    for (int round = 0; round < 2000; ++round) {
      const double a = steep * unit(random), b = steep * unit(random), twist = round % 2 == 0 ? 0.3 : steep;
      const Patch p{0, a, b, a + b + twist * unit(random)};
      const double x = 0.5 + 0.7 * unit(random), y = 0.5 + 0.7 * unit(random);
      const double z = height(p, x, y) + (round % 4 < 2 ? unit(random) : steep * unit(random));
      ASSERT_NEAR(std::sqrt(closest_on_patch(p, x, y, z).squared_distance),
                  std::sqrt(closest_on_patch_by_search(p, x, y, z).squared_distance), 1e-11)
          << "steepness " << steep << ", round " << round;
    }
  }
}

TEST(ClosestOnPatch, MatchesThePlaneInClosedForm) {
  const double a = 0.7, b = -1.3;
  const Patch p{0, a, b, a + b};
  const double norm = std::sqrt(1 + a * a + b * b);
  for (const double distance : {0.2, -0.2, 0.05}) {
    const PatchPoint found =
        closest_on_patch(p, 0.5 - distance * a / norm, 0.5 - distance * b / norm, (a + b) / 2 + distance / norm);
    EXPECT_NEAR(std::sqrt(found.squared_distance), std::abs(distance), 1e-12);
    EXPECT_NEAR(found.u, 0.5, 1e-12);
    EXPECT_NEAR(found.v, 0.5, 1e-12);
    EXPECT_EQ(found.side > 0, distance > 0);
  }
}

TEST(ClosestOnPatch, GivesNodesAndEdgesToPointsOutside) {
  const Patch flat;
  const PatchPoint corner = closest_on_patch(flat, -3, -4, 0);
  EXPECT_EQ(corner.squared_distance, 25);
  const PatchPoint edge = closest_on_patch(flat, 0.25, 2, 1);
  EXPECT_DOUBLE_EQ(edge.squared_distance, 2);
  EXPECT_DOUBLE_EQ(edge.u, 0.25);
}

TEST(ClosestOnPatch, IsZeroOnThePatch) {
  const Patch p{0.1, -0.7, 3, 0.2};
  for (double u = 0; u <= 1; u += 0.125)
    for (double v = 0; v <= 1; v += 0.125)
      EXPECT_LT(closest_on_patch(p, u, v, height(p, u, v)).squared_distance, 1e-24);
}

}  // namespace
}  // namespace sparsha::pipeline
