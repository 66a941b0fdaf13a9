// Integers as differences from a prediction, and the median that predicts coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/scan/formats/las/laz/arithmetic.h"

namespace sparsha::pipeline::laz {

/// Decodes integers of 8, 16 or 32 bits. Each context has a model of the difference's size; the differences' models are
/// shared by all contexts.
class IntegerModel {
 public:
  IntegerModel(std::uint32_t bits, std::uint32_t contexts) : bits_(bits) {
    for (std::uint32_t i = 0; i < contexts; ++i) sizes_.emplace_back(bits + 1);
    for (std::uint32_t i = 1; i <= bits; ++i) differences_.emplace_back(1U << std::min(i, 8U));
  }

  [[nodiscard]] std::int32_t get(Decoder& stream, std::int32_t prediction, std::uint32_t context = 0) {
    size_ = stream.symbol(sizes_[context]);
    std::uint32_t value = static_cast<std::uint32_t>(prediction) + difference(stream);
    if (bits_ < 32) {
      const auto signed_value = static_cast<std::int32_t>(value);
      const std::int32_t range = std::int32_t{1} << bits_;
      if (signed_value < 0) {
        value += static_cast<std::uint32_t>(range);
      } else if (signed_value >= range) {
        value -= static_cast<std::uint32_t>(range);
      }
    }
    return static_cast<std::int32_t>(value);
  }

  /// Bits of the last difference, 0 to the integers' bits; chooses the context of what follows.
  [[nodiscard]] std::uint32_t size() const { return size_; }

 private:
  [[nodiscard]] std::uint32_t difference(Decoder& stream) {
    if (size_ == 0) return stream.bit(small_);
    if (size_ == 32) return 0x80000000U;
    std::uint32_t u = stream.symbol(differences_[size_ - 1]);
    if (size_ > 8) u = u << (size_ - 8) | stream.raw(size_ - 8);
    return u >= 1U << (size_ - 1) ? u + 1 : u - ((1U << size_) - 1);
  }

  std::uint32_t bits_;
  std::uint32_t size_ = 0;
  std::vector<SymbolModel> sizes_, differences_;
  BitModel small_;
};

/// Median of about the last five values.
class RunningMedian {
 public:
  [[nodiscard]] std::int32_t get() const { return v_[2]; }

  void add(std::int32_t x) {
    if (high_) {
      if (x < v_[2]) {
        v_[4] = v_[3];
        v_[3] = v_[2];
        if (x < v_[0]) {
          v_[2] = v_[1];
          v_[1] = v_[0];
          v_[0] = x;
        } else if (x < v_[1]) {
          v_[2] = v_[1];
          v_[1] = x;
        } else {
          v_[2] = x;
        }
      } else {
        if (x < v_[3]) {
          v_[4] = v_[3];
          v_[3] = x;
        } else {
          v_[4] = x;
        }
        high_ = false;
      }
      return;
    }
    if (v_[2] < x) {
      v_[0] = v_[1];
      v_[1] = v_[2];
      if (v_[4] < x) {
        v_[2] = v_[3];
        v_[3] = v_[4];
        v_[4] = x;
      } else if (v_[3] < x) {
        v_[2] = v_[3];
        v_[3] = x;
      } else {
        v_[2] = x;
      }
    } else {
      if (v_[1] < x) {
        v_[0] = v_[1];
        v_[1] = x;
      } else {
        v_[0] = x;
      }
      high_ = true;
    }
  }

 private:
  std::array<std::int32_t, 5> v_{};
  bool high_ = true;
};

}  // namespace sparsha::pipeline::laz
