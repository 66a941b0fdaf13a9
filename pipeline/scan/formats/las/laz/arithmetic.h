// The arithmetic decoder of LAZ and its two kinds of adaptive models. Damaged streams throw; none reads or writes
// outside of its bytes and tables.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace sparsha::pipeline::laz {

/// What is wrong with packed bytes, and where.
struct Damage {
  std::string what;
  std::size_t byte = 0;  ///< of the file
};

inline constexpr std::uint32_t kLeastLength = 1U << 24U;

/// Symbols 0 to n - 1, 2 <= n <= 2048, whose probabilities follow what was decoded. Takes memory at its first use.
class SymbolModel {
 public:
  explicit SymbolModel(std::uint32_t symbols) : symbols_(symbols) {}

 private:
  friend class Decoder;

  void start();
  void update();
  /// The greatest symbol whose cumulated probability (in 1/32768) is not above `d`.
  [[nodiscard]] std::uint32_t find(std::uint32_t d) const {
    std::uint32_t low = 0;
    std::uint32_t high = symbols_;
    if (shift_ != 0) {
      const std::uint32_t at = std::min(d, 32767U) >> shift_;
      low = table_[at];
      high = table_[at + 1] + 1U;
    }
    while (high > low + 1) {
      const std::uint32_t middle = (low + high) / 2;
      (below_[middle] > d ? high : low) = middle;
    }
    return low;
  }

  std::unique_ptr<std::uint16_t[]> memory_;
  std::uint16_t* below_ = nullptr;  ///< cumulated probabilities
  std::uint16_t* count_ = nullptr;
  std::uint16_t* table_ = nullptr;  ///< where to begin to search, by the upper bits
  std::uint32_t symbols_;
  std::uint32_t shift_ = 0;  ///< 0: no table
  std::uint32_t total_ = 0, cycle_ = 0, left_ = 0;
};

/// One bit whose probability follows what was decoded.
class BitModel {
 private:
  friend class Decoder;
  void update();

  std::uint32_t zeros_ = 1, count_ = 2, probability_ = 4096, cycle_ = 4, left_ = 4;
};

/// Reads one stream. Right streams keep value < length; that is checked at the start and at raw bits, the models keep
/// it.
class Decoder {
 public:
  Decoder() = default;
  /// `place`: of the bytes in the file. Throws Damage, as all reading does.
  Decoder(std::string_view bytes, std::size_t place);

  [[nodiscard]] std::uint32_t symbol(SymbolModel& model) {
    if (!model.memory_) model.start();
    const std::uint32_t unit = length_ >> 15U;
    const std::uint32_t symbol = model.find(value_ / unit);
    const std::uint32_t low = model.below_[symbol] * unit;
    const std::uint32_t high = symbol + 1 == model.symbols_ ? length_ : model.below_[symbol + 1] * unit;
    value_ -= low;
    length_ = high - low;
    if (length_ < kLeastLength) renormalise();
    ++model.count_[symbol];
    if (--model.left_ == 0) model.update();
    return symbol;
  }

  [[nodiscard]] std::uint32_t bit(BitModel& model) {
    const std::uint32_t split = model.probability_ * (length_ >> 13U);
    const bool one = value_ >= split;
    if (one) {
      value_ -= split;
      length_ -= split;
    } else {
      length_ = split;
      ++model.zeros_;
    }
    if (length_ < kLeastLength) renormalise();
    if (--model.left_ == 0) model.update();
    return one ? 1 : 0;
  }

  /// 1 to 32 bits, all values alike.
  [[nodiscard]] std::uint32_t raw(std::uint32_t bits);
  [[nodiscard]] std::uint64_t raw64() {
    const std::uint64_t low = raw(32);
    return static_cast<std::uint64_t>(raw(32)) << 32U | low;
  }

  /// Bytes that were read, those past the end included.
  [[nodiscard]] std::size_t used() const { return static_cast<std::size_t>(at_ - begin_) + past_; }
  /// Of them, those past the end.
  [[nodiscard]] std::uint32_t past() const { return past_; }
  [[noreturn]] void fail(const char* what) const;

 private:
  void renormalise() {
    do {
      value_ = value_ << 8U | next();
      length_ <<= 8U;
    } while (length_ < kLeastLength);
  }
  [[nodiscard]] std::uint32_t next() { return at_ != end_ ? *at_++ : past_end(); }
  std::uint32_t past_end();

  const std::uint8_t* begin_ = nullptr;
  const std::uint8_t* at_ = nullptr;
  const std::uint8_t* end_ = nullptr;
  std::size_t place_ = 0;
  std::uint32_t past_ = 0;
  std::uint32_t value_ = 0, length_ = 0xFFFFFFFFU;
};

}  // namespace sparsha::pipeline::laz
