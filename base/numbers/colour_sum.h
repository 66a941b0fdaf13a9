// Means of packed colours.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sparsha {

/// Of colours 0xAABBGGRR, of which 0, transparent black, is none and does not count. Sums are integers, so that the
/// order of what is added changes nothing.
class ColourSum {
 public:
  void add(std::uint32_t rgba, std::int64_t weight = 1) noexcept {
    if (rgba == 0) return;
    for (std::size_t c = 0; c < 4; ++c) channels_[c] += weight * static_cast<std::int64_t>(rgba >> (8 * c) & 255U);
    weight_ += weight;
  }
  /// Rounded; 0 where nothing was added.
  [[nodiscard]] std::uint32_t mean() const noexcept {
    std::uint32_t rgba = 0;
    for (std::size_t c = 0; c < 4 && weight_ > 0; ++c)
      rgba |= static_cast<std::uint32_t>((channels_[c] + weight_ / 2) / weight_) << (8 * c);
    return rgba;
  }

 private:
  std::array<std::int64_t, 4> channels_{};
  std::int64_t weight_ = 0;
};

}  // namespace sparsha
