// Methods take turns, and what is said of their times follows from the times alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include "bench/report/turns.h"

namespace sparsha::bench {
namespace {

using ::testing::ElementsAre;

TEST(Turns, EachRoundBeginsWithAnotherMethodAndSlowOnesSitLaterRoundsOut) {
  std::string order;
  const auto method = [&](char name, bool slow) { return Turn{[&order, name] { return order += name, 1.0; }, slow}; };
  const std::vector<TurnTimes> taken = take_turns({method('a', false), method('b', true), method('c', false)}, 4, 2);
  EXPECT_EQ(order, "abcbcacaac");
  EXPECT_EQ(taken[0].times.size(), 4U);
  EXPECT_EQ(taken[1].times.size(), 2U);
}

TEST(Turns, RatiosAreOfTheSameRound) {
  const auto method = [](std::vector<double> times) {
    return Turn{[times, n = std::size_t{0}]() mutable { return times[n++]; }};
  };
  const std::vector<TurnTimes> taken = take_turns({method({1.0, 2.0, 4.0}), method({3.0, 10.0, 8.0})}, 3);
  EXPECT_THAT(taken[0].times, ElementsAre(1.0, 2.0, 4.0));
  EXPECT_EQ(taken[0].ratio, 1.0);
  EXPECT_EQ(taken[0].ratio_low, 1.0);
  EXPECT_EQ(taken[0].ratio_high, 1.0);
  EXPECT_EQ(taken[1].ratio, 3.0);
  EXPECT_EQ(taken[1].ratio_low, 2.0);
  EXPECT_EQ(taken[1].ratio_high, 5.0);
  EXPECT_EQ(taken[1].best(), 3.0);
  EXPECT_EQ(taken[1].median(), 8.0);
  EXPECT_EQ(taken[1].longest(), 10.0);
  EXPECT_TRUE(std::isnan(TurnTimes{}.median()));
}

TEST(Turns, TheRangeOfRatiosHoldsTheMedianAsOftenAsIsSaid) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);  // median 0
  for (const int rounds : {2, 5, 7}) {
    constexpr int kTrials = 20000;
    int held = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      int above = 0;
      for (int round = 0; round < rounds; ++round) above += uniform(random) > 0.0 ? 1 : 0;
      held += above > 0 && above < rounds ? 1 : 0;
    }
    const double p = range_confidence(rounds);
    EXPECT_NEAR(static_cast<double>(held) / kTrials, p, 4.0 * std::sqrt(p * (1.0 - p) / kTrials)) << rounds;
  }
}

TEST(TickTimes, EveryTickRunsOnceARoundInItsOrder) {
  TickTimes times(3, 12, 4);
  std::vector<std::size_t> ticks;
  EXPECT_GE(times.time_round([&](std::size_t tick) { return ticks.push_back(tick), 1.0; }), 0.0);
  ASSERT_EQ(ticks.size(), 15U);
  for (std::size_t k = 0; k < ticks.size(); ++k) EXPECT_EQ(ticks[k], k);
  EXPECT_LE(times.quantile_ns(0.5), times.quantile_ns(1.0));
}

TEST(TickTimes, AnotherRoundOnlyLowersThem) {
  TickTimes times(0, 64);
  const auto work = [](std::size_t tick) { return std::sqrt(static_cast<double>(tick)); };
  times.time_round(work);
  const double once_ns = times.quantile_ns(0.99);
  for (int round = 0; round < 5; ++round) times.time_round(work);
  EXPECT_LE(times.quantile_ns(0.99), once_ns);
}

}  // namespace
}  // namespace sparsha::bench
