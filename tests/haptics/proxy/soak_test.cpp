#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

#include "soak.h"

namespace sparsha::haptics::test {

TEST(ExactProxy, RestsAtEveryOneOfAMillionRandomMoves) {
  constexpr std::uint64_t kSeed = 20240607;
  const SoakCount count = run_soak(1'000'000, kSeed);
  std::printf("seed %llu: %llu moves, %llu contacts, %llu unfinished, at most %llu segments, worst excess %g cells\n",
              static_cast<unsigned long long>(kSeed), static_cast<unsigned long long>(count.moves),
              static_cast<unsigned long long>(count.contacts), static_cast<unsigned long long>(count.unfinished),
              static_cast<unsigned long long>(count.most_segments), count.worst_excess_cells);
  EXPECT_EQ(count.non_stationary, 0U);
  EXPECT_EQ(count.below, 0U);
  EXPECT_EQ(count.not_a_number, 0U);
  EXPECT_EQ(count.stuck, 0U);
  EXPECT_EQ(count.rose, 0U);
  EXPECT_EQ(count.tunnelled, 0U);
  EXPECT_GT(count.contacts, count.moves / 2);
}

}  // namespace sparsha::haptics::test
