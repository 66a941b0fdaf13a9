#include "haptics/around/block_index.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <tuple>
#include <vector>

namespace sparsha::haptics {
namespace {

TEST(BlockIndex, FindsWhatWasPutIn) {
  std::mt19937_64 random(1);
  std::uniform_int_distribution<int> place(-40, 40);
  std::uniform_int_distribution<std::uint32_t> sheet(0, 9);
  std::map<std::tuple<int, int, int>, std::set<std::uint32_t>> truth;
  std::vector<BlockIndex::Entry> entries;
  for (int k = 0; k < 20'000; ++k) {
    const BlockPlace block(place(random), place(random), place(random));
    const std::uint32_t s = sheet(random);
    truth[{block.x(), block.y(), block.z()}].insert(s);
    entries.push_back({BlockIndex::key_of(block), s});
  }
  const BlockIndex index(0.5, entries);
  EXPECT_EQ(index.blocks(), truth.size());
  for (int x = -42; x <= 42; ++x) {
    for (int y = -42; y <= 42; ++y) {
      for (int z = -42; z <= 42; ++z) {
        const auto found = index.sheets({x, y, z});
        const auto want = truth.find({x, y, z});
        const std::vector<std::uint32_t> list =
            want == truth.end() ? std::vector<std::uint32_t>{}
                                : std::vector<std::uint32_t>(want->second.begin(), want->second.end());
        std::vector<std::uint32_t> numbers;
        for (const Passing& passing : found) numbers.push_back(passing.sheet);
        ASSERT_EQ(numbers, list);
      }
    }
  }
}

TEST(BlockIndex, KnowsBlocksOfPlacesNearAndFar) {
  const BlockIndex index(0.5, {});
  EXPECT_EQ(index.block_of({0.1, -0.1, 0.5}), BlockPlace(0, -1, 1));
  EXPECT_TRUE(index.sheets_at({1e300, -1e300, 0.0}).empty());
  EXPECT_TRUE(BlockIndex().sheets_at({0.0, 0.0, 0.0}).empty());
}

}  // namespace
}  // namespace sparsha::haptics
