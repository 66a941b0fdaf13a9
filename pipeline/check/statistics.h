// Figures of a sample of distances, and which points or nodes are sampled.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "pipeline/check/check.h"

namespace sparsha::pipeline {

/// Of signed distances, metres; all but the signed mean are of their magnitudes. `population` is how many items the
/// sample was taken from. Order statistics are nearest ranks.
[[nodiscard]] DistanceStatistics statistics_of(const std::vector<float>& signed_m, std::uint64_t population);

/// Magnitudes in equal bins of `bin_m`; what lies beyond the last bin is not counted.
[[nodiscard]] std::vector<std::uint64_t> histogram_of(const std::vector<float>& signed_m, double bin_m, int bins);

/// An item and the key that decides whether it is sampled.
struct Keyed {
  std::uint64_t key;
  std::uint64_t item;
};
/// Hashes up to this are all that a sample of `wanted` out of `population` needs, but once in many million times.
[[nodiscard]] std::uint64_t sample_threshold(std::uint64_t population, std::uint64_t wanted) noexcept;
/// Room for that many and the few more that a threshold lets through.
[[nodiscard]] constexpr std::uint64_t sample_room(std::uint64_t population, std::uint64_t wanted) noexcept {
  return std::min(population, wanted + wanted / 8 + 1024);
}
/// Items, ascending, of the `wanted` smallest keys.
[[nodiscard]] std::vector<std::uint64_t> smallest_keys(std::vector<Keyed> candidates, std::uint64_t wanted);

/// Of `population` items the `wanted` (0 = all) with the smallest keys, ascending: with hashes for keys, a sample that
/// depends on the items' own bits alone. `each(offer)` calls offer(key, item) for all of them, perhaps twice.
template <typename Each>
[[nodiscard]] std::vector<std::uint64_t> choose_sample(std::uint64_t population, std::uint64_t wanted,
                                                       const Each& each) {
  if (wanted == 0 || wanted > population) wanted = population;
  std::vector<Keyed> candidates;
  candidates.reserve(sample_room(population, wanted));
  for (std::uint64_t threshold = sample_threshold(population, wanted);; threshold = ~std::uint64_t{0}) {
    candidates.clear();
    each([&](std::uint64_t key, std::uint64_t item) {
      if (key <= threshold) candidates.push_back({key, item});
    });
    if (candidates.size() >= wanted) return smallest_keys(std::move(candidates), wanted);
  }
}

}  // namespace sparsha::pipeline
