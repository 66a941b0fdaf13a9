#include "base/numbers/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sparsha {
namespace {

TEST(Statistics, RanksAreThoseOfSortedValues) {
  std::mt19937_64 random(3);
  std::uniform_int_distribution<int> few(0, 20);  // many are equal
  for (std::size_t count = 1; count < 40; ++count) {
    std::vector<double> values(count);
    for (double& value : values) value = few(random);
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t rank = 0; rank < count; ++rank) EXPECT_EQ(value_of_rank(values, rank), sorted[rank]);
    EXPECT_EQ(median(values), sorted[count / 2]);
    EXPECT_EQ(quantile(values, 0.0), sorted.front());
    EXPECT_EQ(quantile(values, 1.0), sorted.back());
    EXPECT_EQ(quantile(values, 0.3), sorted[static_cast<std::size_t>(0.3 * static_cast<double>(count - 1))]);
  }
}

}  // namespace
}  // namespace sparsha
