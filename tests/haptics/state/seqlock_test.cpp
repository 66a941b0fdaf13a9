#include "haptics/state/seqlock.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "haptics/state/state.h"

namespace sparsha::haptics {
namespace {

struct Words {
  std::array<std::uint64_t, 48> word{};
};

TEST(Seqlock, ReadsBackWhatWasPublished) {
  Seqlock<State> lock;
  State state;
  state.tick = 7;
  state.hip_m = {1.0, -2.0, 3.0};
  state.dropped_records = 9;
  lock.publish(state);
  const State read = lock.read();
  EXPECT_EQ(read.tick, 7U);
  EXPECT_EQ(read.hip_m, state.hip_m);
  EXPECT_EQ(read.dropped_records, 9U);
}

TEST(Seqlock, NeverShowsAReaderHalfOfOneValueAndHalfOfAnother) {
  Seqlock<Words> lock;
  std::atomic<bool> stop{false};
  std::atomic<std::uint64_t> torn{0};
  std::atomic<std::uint64_t> backwards{0};
  std::vector<std::thread> readers;
  for (int reader = 0; reader < 3; ++reader)
    readers.emplace_back([&] {
      std::uint64_t last = 0;
      while (!stop.load()) {
        const Words words = lock.read();
        for (std::size_t i = 1; i < words.word.size(); ++i)
          if (words.word[i] != words.word[0] + i * (words.word[0] != 0 ? 1 : 0)) torn.fetch_add(1);
        if (words.word[0] < last) backwards.fetch_add(1);
        last = words.word[0];
      }
    });
  Words words;
  for (std::uint64_t n = 1; n <= 300'000; ++n) {
    for (std::size_t i = 0; i < words.word.size(); ++i) words.word[i] = n + i;
    lock.publish(words);
  }
  stop.store(true);
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(torn.load(), 0U);
  EXPECT_EQ(backwards.load(), 0U);
}

TEST(Seqlock, TryReadGivesUpInsteadOfWaitingAndLeavesTheValueAlone) {
  Seqlock<Words> lock;
  Words words;
  words.word.fill(5);
  lock.publish(words);
  Words read;
  EXPECT_TRUE(lock.try_read(read));
  EXPECT_EQ(read.word.back(), 5U);
}

}  // namespace
}  // namespace sparsha::haptics
