// Elementary functions and random numbers of the simulator against the C library in extended precision.
#include "pipeline/simulate/plain_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pipeline/simulate/random.h"

namespace sparsha::pipeline {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr int kCases = 200000;

TEST(PlainMath, SineAndCosineOfTurnsAreRightToFourUlp) {
  Random random(1, 0, 0);
  for (int k = 0; k < kCases; ++k) {
    const double turns = random.uniform(-1000.0, 1000.0);
    const long double angle = 2.0L * std::numbers::pi_v<long double> * (turns - std::floor(turns));
    ASSERT_NEAR(plain::sin_turns(turns), static_cast<double>(std::sin(angle)), 4.0 * kEpsilon) << turns;
    ASSERT_NEAR(plain::cos_turns(turns), static_cast<double>(std::cos(angle)), 4.0 * kEpsilon) << turns;
  }
}

TEST(PlainMath, QuarterTurnsAreExact) {
  EXPECT_EQ(plain::sin_turns(0.25), 1.0);
  EXPECT_EQ(plain::cos_turns(0.5), -1.0);
  EXPECT_EQ(plain::sin_turns(0.0), 0.0);
  EXPECT_EQ(plain::cos_turns(-0.75), 0.0);
}

TEST(PlainMath, ExponentialLogarithmAndAngleAreRightToFourUlp) {
  Random random(2, 0, 0);
  for (int k = 0; k < kCases; ++k) {
    const double x = random.uniform(-700.0, 700.0);
    const double e = static_cast<double>(std::exp(static_cast<long double>(x)));
    ASSERT_NEAR(plain::exp(x) / e, 1.0, 4.0 * kEpsilon) << x;
    const double positive = std::ldexp(1.0 + random.uniform(), static_cast<int>(random.bits() % 200) - 100);
    const auto logarithm = static_cast<double>(std::log(static_cast<long double>(positive)));
    ASSERT_NEAR(plain::log(positive), logarithm, 4.0 * kEpsilon * std::max(1.0, std::fabs(logarithm))) << positive;
    const double y = random.uniform(-1.0, 1.0);
    const double z = random.uniform(-1.0, 1.0);
    const auto angle = static_cast<double>(std::atan2(static_cast<long double>(y), static_cast<long double>(z)) /
                                           (2.0L * std::numbers::pi_v<long double>));
    ASSERT_NEAR(plain::atan2_turns(y, z), angle, 4.0 * kEpsilon) << y << " " << z;
  }
  EXPECT_EQ(plain::exp(0.0), 1.0);
  EXPECT_EQ(plain::exp(-1000.0), 0.0);
  EXPECT_EQ(plain::log(1.0), 0.0);
}

TEST(Random, NormalNumbersHaveTheMomentsOfTheNormalDistribution) {
  double sum = 0.0, squares = 0.0, fourths = 0.0;
  int beyond_two = 0;
  for (int k = 0; k < kCases; ++k) {
    Random random(3, 5, static_cast<std::uint64_t>(k));
    const double n = random.normal();
    sum += n;
    squares += n * n;
    fourths += n * n * n * n;
    beyond_two += std::fabs(n) > 2.0 ? 1 : 0;
  }
  // Five standard deviations of each statistic.
  const double five = 5.0 / std::sqrt(static_cast<double>(kCases));
  EXPECT_NEAR(sum / kCases, 0.0, five);
  EXPECT_NEAR(squares / kCases, 1.0, five * std::sqrt(2.0));
  EXPECT_NEAR(fourths / kCases, 3.0, five * std::sqrt(96.0));
  const double share = std::erfc(2.0 / std::sqrt(2.0));
  EXPECT_NEAR(static_cast<double>(beyond_two) / kCases, share, five * std::sqrt(share * (1.0 - share)));
}

TEST(Random, NeighbouringStreamsAreUncorrelated) {
  double product = 0.0;
  for (int k = 0; k < kCases; ++k) {
    Random a(7, 1, static_cast<std::uint64_t>(k));
    Random b(7, 1, static_cast<std::uint64_t>(k) + 1);
    product += (a.uniform() - 0.5) * (b.uniform() - 0.5);
  }
  EXPECT_NEAR(product / kCases * 12.0, 0.0, 5.0 / std::sqrt(static_cast<double>(kCases)));
}

}  // namespace
}  // namespace sparsha::pipeline
