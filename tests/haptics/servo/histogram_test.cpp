#include "haptics/servo/histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace sparsha::haptics {
namespace {

TEST(TimeHistogram, FindsQuantilesToOneBin) {
  std::mt19937_64 random(1);
  std::lognormal_distribution<double> times(6.0, 2.0);
  TimeHistogram histogram;
  std::vector<double> sorted;
  for (int i = 0; i < 100'000; ++i) {
    const double time = std::floor(times(random));
    histogram.add(static_cast<std::int64_t>(time));
    sorted.push_back(time);
  }
  std::sort(sorted.begin(), sorted.end());
  for (const double share : {0.5, 0.9, 0.99, 0.999}) {
    const double exact = sorted[static_cast<std::size_t>(std::ceil(share * 1e5)) - 1];
    EXPECT_NEAR(histogram.quantile_ns(share), exact, std::max(1.0, exact / 64.0)) << share;
  }
  EXPECT_EQ(histogram.max_ns(), sorted.back());
  EXPECT_EQ(histogram.total(), 100'000U);
}

TEST(TimeHistogram, HoldsExtremesWithoutLosingThem) {
  TimeHistogram histogram;
  histogram.add(-5);
  histogram.add(0);
  histogram.add(std::int64_t{1} << 62);
  EXPECT_EQ(histogram.total(), 3U);
  EXPECT_EQ(histogram.max_ns(), std::ldexp(1.0, 62));
  EXPECT_EQ(TimeHistogram{}.quantile_ns(0.5), 0.0);
}

TEST(LatenessHistogram, KeepsTwentyBinsOfAHundredMicrosecondsTheLastOneOpen) {
  LatenessHistogram histogram;
  histogram.add(-3);
  histogram.add(99'999);
  histogram.add(100'000);
  histogram.add(1'950'000);
  histogram.add(50'000'000);
  EXPECT_EQ(histogram.counts()[0], 2U);
  EXPECT_EQ(histogram.counts()[1], 1U);
  EXPECT_EQ(histogram.counts()[19], 2U);
}

}  // namespace
}  // namespace sparsha::haptics
