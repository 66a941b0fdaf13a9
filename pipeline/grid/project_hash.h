// A hash of coordinates, by which samples are chosen so that they do not depend on the order of points.
#pragma once

#include <bit>
#include <cstdint>

namespace sparsha::pipeline {

/// Finalizer of SplitMix64: every input bit reaches every output bit.
[[nodiscard]] inline std::uint64_t mix_bits(std::uint64_t h) {
  h = (h ^ (h >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  h = (h ^ (h >> 27U)) * 0x94d049bb133111ebULL;
  return h ^ (h >> 31U);
}

/// Good enough to draw a sample by, and quick enough to ask every point.
[[nodiscard]] inline std::uint32_t quick_hash(float x, float y, float z) {
  const std::uint64_t xy = (static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(x)) << 32U) |
                           static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(y));
  const std::uint64_t h = (xy ^ (std::bit_cast<std::uint32_t>(z) * 0x9e3779b97f4a7c15ULL)) * 0xbf58476d1ce4e5b9ULL;
  return static_cast<std::uint32_t>((h ^ (h >> 29U)) * 0x94d049bb133111ebULL >> 32U);
}

}  // namespace sparsha::pipeline
