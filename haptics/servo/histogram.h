// Counts of times without allocation: exact below 128 ns, then 64 steps an octave (0.8 % wide at most 1.6 %).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace sparsha::haptics {

/// One writer; read it when the writer has stopped.
class TimeHistogram {
 public:
  void add(std::int64_t time_ns) noexcept {
    const std::uint64_t value = time_ns > 0 ? static_cast<std::uint64_t>(time_ns) : 0;
    ++counts_[bin(value)];
    ++total_;
    if (value > max_) max_ = value;
  }
  [[nodiscard]] std::uint64_t total() const noexcept { return total_; }
  [[nodiscard]] double max_ns() const noexcept { return static_cast<double>(max_); }
  /// Smallest bin edge with at least `share` of the counts at or below it; 0 when empty.
  [[nodiscard]] double quantile_ns(double share) const noexcept {
    const double wanted = share * static_cast<double>(total_);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      sum += counts_[i];
      if (sum > 0 && static_cast<double>(sum) >= wanted) {
        const double edge = lower_edge(i);
        return edge < max_ns() ? edge : max_ns();
      }
    }
    return max_ns();
  }

 private:
  static constexpr std::size_t kSteps = 64;
  static constexpr std::size_t kOctaves = 40;
  static constexpr std::size_t kBins = kSteps * (kOctaves + 2);

  [[nodiscard]] static std::size_t bin(std::uint64_t value) noexcept {
    if (value < 2 * kSteps) return static_cast<std::size_t>(value);
    const auto octave = static_cast<std::size_t>(std::bit_width(value)) - 7;  // 1 for 128 to 255
    const auto index = (octave + 1) * kSteps + static_cast<std::size_t>(value >> octave) - kSteps;
    return index < kBins ? index : kBins - 1;
  }
  [[nodiscard]] static double lower_edge(std::size_t index) noexcept {
    if (index < 2 * kSteps) return static_cast<double>(index);
    const std::size_t octave = index / kSteps - 1;
    const std::uint64_t mantissa = index % kSteps + kSteps;
    return static_cast<double>(mantissa << octave);
  }

  std::array<std::uint64_t, kBins> counts_{};
  std::uint64_t total_ = 0;
  std::uint64_t max_ = 0;
};

/// Lateness in 20 bins of 100 us, the last one open.
class LatenessHistogram {
 public:
  static constexpr std::size_t kBins = 20;
  static constexpr std::int64_t kBin_ns = 100'000;
  void add(std::int64_t late_ns) noexcept {
    const std::int64_t index = late_ns > 0 ? late_ns / kBin_ns : 0;
    ++counts_[index < static_cast<std::int64_t>(kBins) ? static_cast<std::size_t>(index) : kBins - 1];
    max_ns_ = std::max(max_ns_, late_ns);
  }
  [[nodiscard]] std::int64_t max_ns() const noexcept { return max_ns_; }
  [[nodiscard]] const std::array<std::uint64_t, kBins>& counts() const noexcept { return counts_; }

 private:
  std::array<std::uint64_t, kBins> counts_{};
  std::int64_t max_ns_ = 0;
};

}  // namespace sparsha::haptics
