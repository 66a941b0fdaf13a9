// Sums without rounding, against sums of partials that do not overlap (Shewchuk 1997).
#include "base/numbers/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace sparsha {
namespace {

/// Parts that grow, do not overlap and add up to the numbers without an error.
std::vector<double> partials_of(const std::vector<float>& numbers) {
  std::vector<double> parts;
  for (const float number : numbers) {
    double x = static_cast<double>(number);
    std::vector<double> next;
    for (double y : parts) {
      if (std::abs(x) < std::abs(y)) std::swap(x, y);
      const double high = x + y;
      const double low = y - (high - x);
      if (low != 0.0) next.push_back(low);
      x = high;
    }
    next.push_back(x);
    parts = next;
  }
  return parts;
}

double sum_of(const std::vector<float>& numbers) {
  ExactSum sum;
  for (const float number : numbers) sum.add(static_cast<double>(number));
  return sum.value();
}

std::vector<float> random_floats(std::mt19937_64& random, std::size_t count) {
  std::vector<float> numbers;
  while (numbers.size() < count) {
    const auto number = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (std::isfinite(number)) numbers.push_back(number);
  }
  return numbers;
}

TEST(ExactSum, LosesNothingBetweenTheLargestFloatAndTheSmallest) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  constexpr float kSmallest = std::numeric_limits<float>::denorm_min();
  EXPECT_EQ(sum_of({}), 0.0);
  EXPECT_EQ(sum_of({kSmallest}), static_cast<double>(kSmallest));
  EXPECT_EQ(sum_of({kLargest, kSmallest, -kLargest}), static_cast<double>(kSmallest));
  EXPECT_EQ(sum_of({-kLargest, -kSmallest, kLargest}), -static_cast<double>(kSmallest));
  EXPECT_EQ(sum_of({1e30F, 1.0F, -1e30F, 2.0F}), 3.0);
  EXPECT_EQ(sum_of({1.0F, -1.0F}), 0.0);
  EXPECT_EQ(sum_of(std::vector<float>(1000, kLargest)), 1000.0 * static_cast<double>(kLargest));
}

TEST(ExactSum, AgreesWithPartialsThatDoNotOverlapToTheLastPlaceInAnyOrder) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 2000; ++round) {
    std::vector<float> numbers = random_floats(random, 1 + random() % 30);
    if (round % 2 == 0) {  // almost nothing is left
      const std::size_t half = numbers.size();
      for (std::size_t i = 0; i + 1 < half; ++i) numbers.push_back(-numbers[i]);
    }
    const double sum = sum_of(numbers);
    double expected = 0.0;
    for (const double part : partials_of(numbers)) expected += part;
    ASSERT_NEAR(sum, expected, 2.0 * std::numeric_limits<double>::epsilon() * std::abs(expected)) << "round " << round;
    std::shuffle(numbers.begin(), numbers.end(), random);
    ASSERT_EQ(sum_of(numbers), sum) << "round " << round;
  }
}

TEST(ExactSum, TakesWhatSumsOfFloatsAreRoundedBy) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 2000; ++round) {
    const std::vector<float> numbers = random_floats(random, 20);
    ExactSum sum;
    for (const double part : partials_of(numbers)) sum.add(part);
    ASSERT_EQ(sum.value(), sum_of(numbers)) << "round " << round;
  }
}

}  // namespace
}  // namespace sparsha
