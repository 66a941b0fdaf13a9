// The limiter: transparent below its ceiling, never above it.
#include "audio/limiter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using sparsha::audio::Limiter;

TEST(Limiter, PassesWhatIsUnderTheCeilingBitForBit) {
  Limiter limiter(0.8, 48000.0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> value(-0.8, 0.8);
  std::vector<Limiter::Frame> in, out;
  for (int i = 0; i < 5000; ++i) {
    in.push_back({value(random), value(random)});
    out.push_back(limiter.process(in.back()));
  }
  for (std::size_t i = Limiter::kDelay; i < in.size(); ++i) {
    ASSERT_EQ(out[i].left, in[i - Limiter::kDelay].left);
    ASSERT_EQ(out[i].right, in[i - Limiter::kDelay].right);
  }
}

TEST(Limiter, NeverExceedsTheCeilingForAnyInput) {
  std::mt19937 random(2);
  std::normal_distribution<double> value(0.0, 1.0);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Limiter limiter(0.8, 48000.0);
  for (int i = 0; i < 1000000; ++i) {
    const double size = unit(random) < 0.001 ? 100.0 : 0.5;
    const auto out = limiter.process({size * value(random), size * value(random)});
    ASSERT_LE(std::abs(out.left), 0.8);
    ASSERT_LE(std::abs(out.right), 0.8);
  }
}

TEST(Limiter, BecomesExactAgainAfterAPeak) {
  Limiter limiter(0.8, 48000.0);
  limiter.process({3.0, 0.0});
  for (int i = 0; i < 96000; ++i) limiter.process({0.3, 0.0});
  EXPECT_EQ(limiter.process({0.3, 0.0}).left, 0.3);
}

TEST(Limiter, GainFallsGraduallyNotInAStep) {
  Limiter limiter(0.8, 48000.0);
  double last = 0.5, steepest = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double in = i < 500 ? 0.5 : 1.0;  // gain must go from 1 to 0.8
    const auto out = limiter.process({0.5, in});
    if (i >= 100) steepest = std::max(steepest, std::abs(out.left - last));
    last = i >= 99 ? out.left : last;
  }
  EXPECT_LT(steepest, 0.5 * 0.2 / 40.0);
}

}  // namespace
