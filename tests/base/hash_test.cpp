// Hashes: the published numbers, and no more collisions than chance has.
#include "base/numbers/hash.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace sparsha {
namespace {

TEST(Hash, OfWordsInAGoldenStepIsSplitMix64) {
  // What the authors' generator gives for the seed 1234567.
  const std::uint64_t expected[] = {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
                                    4593380528125082431ULL, 16408922859458223821ULL};
  std::uint64_t state = 1234567;
  for (const std::uint64_t number : expected) {
    EXPECT_EQ(hash_word(state), number);
    state += kGoldenStep;
  }
}

TEST(Hash, SpreadsTheCellsOfABlockOverATableAsChanceDoes) {
  // 32^3 cells about zero into as many slots: chance leaves a share of 1/e empty, +- sqrt(n) (1/e)(1 - 2/e) or so.
  constexpr std::size_t kSlots = 32768;
  for (const std::int64_t step : {1, 2, 1000, 1 << 20}) {
    std::vector<bool> taken(kSlots);
    for (std::int64_t x = -16; x < 16; ++x)
      for (std::int64_t y = -16; y < 16; ++y)
        for (std::int64_t z = -16; z < 16; ++z) taken[hash_cell({x * step, y * step, z * step}) % kSlots] = true;
    std::size_t empty = 0;
    for (const bool slot : taken) empty += slot ? 0U : 1U;
    const double expected = kSlots * std::exp(-1.0);
    EXPECT_NEAR(static_cast<double>(empty), expected, 6.0 * std::sqrt(expected * (1.0 - 2.0 * std::exp(-1.0))))
        << "step " << step;
  }
}

}  // namespace
}  // namespace sparsha
