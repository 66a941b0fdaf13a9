// Counter-based random numbers: each point has its own stream, so that threads and order change no byte.
#pragma once

#include <cstdint>

#include "base/numbers/hash.h"

namespace sparsha::pipeline {

/// SplitMix64 whose start is a hash of (seed, stream, index).
class Random {
 public:
  constexpr Random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index)
      : state_(mix_bits(mix_bits(hash_word(seed) ^ (stream + kGoldenStep)) ^ (index * kGoldenStep))) {}

  constexpr std::uint64_t bits() { return mix_bits(state_ += kGoldenStep); }
  /// Uniform in (0, 1), 2^52 values, never an end.
  constexpr double uniform() { return (static_cast<double>(bits() >> 12) + 0.5) * 0x1p-52; }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal (Box & Muller 1958).
  double normal();

 private:
  std::uint64_t state_;
};

}  // namespace sparsha::pipeline
