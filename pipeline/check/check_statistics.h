// Figures of a sample of distances, and which points or nodes are sampled.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/check/check.h"

namespace sparsha::pipeline {

/// Of signed distances, metres; all but the signed mean are of their magnitudes. `population` is how many items the
/// sample was taken from. Order statistics are nearest ranks.
[[nodiscard]] DistanceStatistics statistics_of(const std::vector<float>& signed_m, std::uint64_t population);

/// Magnitudes in equal bins of `bin_m`; what lies beyond the last bin is not counted.
[[nodiscard]] std::vector<std::uint64_t> histogram_of(const std::vector<float>& signed_m, double bin_m, int bins);

/// Indices, ascending, of the `wanted` (0 = all) items with the smallest keys: with hashes for keys, a sample that
/// depends on the items' own bits alone.
[[nodiscard]] std::vector<std::uint32_t> choose_sample(const std::vector<std::uint64_t>& keys, std::uint64_t wanted);

/// Mixes the bits of a word (finaliser of SplitMix64, Steele, Lea & Flood 2014).
[[nodiscard]] std::uint64_t hash_word(std::uint64_t word) noexcept;

}  // namespace sparsha::pipeline
