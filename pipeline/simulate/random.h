// Counter-based random numbers: each point has its own stream, so that threads and order change no byte.
#pragma once

#include <cstdint>

namespace sparsha::pipeline {

/// Finaliser of SplitMix64 (Steele, Lea & Flood 2014): a bijection of 64-bit words that mixes every bit.
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

/// SplitMix64 whose start is a hash of (seed, stream, index).
class Random {
 public:
  constexpr Random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index)
      : state_(mix_bits(mix_bits(mix_bits(seed + kGamma) ^ (stream + kGamma)) ^ (index * kGamma))) {}

  constexpr std::uint64_t bits() { return mix_bits(state_ += kGamma); }
  /// Uniform in (0, 1), 2^52 values, never an end.
  constexpr double uniform() { return (static_cast<double>(bits() >> 12) + 0.5) * 0x1p-52; }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal (Box & Muller 1958).
  double normal();

 private:
  static constexpr std::uint64_t kGamma = 0x9E3779B97F4A7C15ULL;
  std::uint64_t state_;
};

}  // namespace sparsha::pipeline
