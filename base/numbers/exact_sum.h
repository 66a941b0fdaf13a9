// Sums of float32 numbers that do not depend on their order: all bits are kept (Kulisch & Miranker 1986).
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace sparsha {

/// A whole number of the smallest float, 2^-149, in 320 bits: a float is below 2^277 of them, so that 2^40 floats stay
/// below 2^317.
class ExactSum {
 public:
  /// A float, or a sum of some or what such a sum was rounded by; finite.
  void add(double value) noexcept {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    const auto exponent = static_cast<int>(bits >> 52U & 0x7FFU);
    if (exponent == 0) return;  // zero: the smallest float is no subnormal double
    std::uint64_t digits = (bits & 0xFFFFFFFFFFFFFULL) | 0x10000000000000ULL;
    int place = exponent - 1075 + 149;  // value = digits * 2^(place - 149), place <= 264
    if (place < 0) {
      digits >>= static_cast<unsigned>(-place);  // zeros only
      place = 0;
    }
    const auto shift = static_cast<unsigned>(place % 64);
    const auto word = static_cast<std::size_t>(place / 64);
    add_words(word, digits << shift, shift > 0 ? digits >> (64U - shift) : 0, bits >> 63U != 0);
  }

  /// The sum to within the last place of a double, and exact where a double can be.
  [[nodiscard]] double value() const noexcept {
    const bool negative = words_.back() >> 63U != 0;
    ExactSum magnitude = *this;
    if (negative) {
      for (std::uint64_t& word : magnitude.words_) word = ~word;
      magnitude.add_words(0, 1, 0, false);
    }
    double sum = 0.0;
    for (std::size_t word = kWords; word-- > 0;) sum = sum * 0x1p64 + static_cast<double>(magnitude.words_[word]);
    return std::ldexp(negative ? -sum : sum, -149);
  }

 private:
  static constexpr std::size_t kWords = 5;

  void add_words(std::size_t word, std::uint64_t low, std::uint64_t high, bool negative) noexcept {
    // Two's complement: what is subtracted is added with all bits inverted, plus one.
    const std::uint64_t flip = negative ? ~std::uint64_t{0} : 0;
    std::uint64_t carry = negative ? 1 : 0;
    for (std::uint64_t digits = low; word < kWords; ++word) {
      const std::uint64_t term = (digits ^ flip) + carry;
      carry = term < carry ? 1 : 0;
      words_[word] += term;
      carry += words_[word] < term ? 1 : 0;
      digits = high;
      high = 0;
    }
  }

  std::array<std::uint64_t, kWords> words_{};  ///< two's complement, the lowest first
};

}  // namespace sparsha
