// Hashes of integers: the same on every machine and in every run, so that samples and tables chosen by them are, too.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sparsha {

/// 2^64 over the golden ratio, odd.
constexpr std::uint64_t kGoldenStep = 0x9E3779B97F4A7C15ULL;

/// Finaliser of SplitMix64 (Steele, Lea & Flood 2014): a bijection of 64-bit words that mixes every bit; 0 stays 0.
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t word) noexcept {
  word = (word ^ (word >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  word = (word ^ (word >> 27U)) * 0x94D049BB133111EBULL;
  return word ^ (word >> 31U);
}

/// A word's hash that chooses samples: every bit is as good as random.
[[nodiscard]] constexpr std::uint64_t hash_word(std::uint64_t word) noexcept { return mix_bits(word + kGoldenStep); }

/// Hash of up to three words for tables: quick, its lower bits good enough for a place in a table.
template <std::size_t Words>
[[nodiscard]] constexpr std::uint64_t hash_words(const std::array<std::uint64_t, Words>& words) noexcept {
  constexpr std::array<std::uint64_t, 3> kFactors{kGoldenStep, 0xD6E8FEB86659FD93ULL, 0xBF58476D1CE4E5B9ULL};
  static_assert(Words <= kFactors.size());
  std::uint64_t hash = 0;
  for (std::size_t k = 0; k < Words; ++k) hash = (hash ^ (hash >> 32U) ^ words[k]) * kFactors[k];
  return hash ^ (hash >> 32U);
}

/// The same of a cell of a lattice in space.
[[nodiscard]] constexpr std::uint64_t hash_cell(const std::array<std::int64_t, 3>& cell) noexcept {
  return hash_words(std::array<std::uint64_t, 3>{
      static_cast<std::uint64_t>(cell[0]), static_cast<std::uint64_t>(cell[1]), static_cast<std::uint64_t>(cell[2])});
}

}  // namespace sparsha
