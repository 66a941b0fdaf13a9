// Median and 95th percentile of the last ticks' times, without allocation: how long the loop really takes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace sparsha::haptics {

/// Of the last `kWindow` times, a power of two. Times from 64 us to 131 ms in steps of a sixteenth of an octave (4.4
/// %), the ends open. One writer, some 10 ns a time.
template <std::size_t kWindow = 512>
class LoopMeter {
 public:
  void add(double time_s) noexcept {
    if (!(time_s > 0.0)) return;
    const auto bin = static_cast<std::uint8_t>(
        std::clamp(kSteps * std::log2(time_s / kShortest_s), 0.0, static_cast<double>(kBins - 1)));
    if (count_ == kWindow)
      --bins_[ring_[next_]];
    else
      ++count_;
    ring_[next_] = bin;
    ++bins_[bin];
    next_ = (next_ + 1) % kWindow;
    if (next_ % kRenewed == 0) p95_s_ = upper_quantile(20);
    if (next_ % (count_ < kRenewed ? kFirst : kRenewed) == 0) median_s_ = upper_quantile(2);
  }
  /// The upper edge of the bin, renewed every 32 times; `otherwise` before the first of them.
  [[nodiscard]] double p95_s(double otherwise) const noexcept { return p95_s_ > 0.0 ? p95_s_ : otherwise; }
  /// The same, known after 8 times.
  [[nodiscard]] double median_s(double otherwise) const noexcept { return median_s_ > 0.0 ? median_s_ : otherwise; }

 private:
  /// Of the longest 1 / `part` of the times, the shortest.
  [[nodiscard]] double upper_quantile(std::size_t part) const noexcept {
    std::size_t above = 0;
    for (std::size_t bin = kBins; bin-- > 0;) {
      above += bins_[bin];
      if (part * above > count_) return kShortest_s * std::exp2(static_cast<double>(bin + 1) / kSteps);
    }
    return 0.0;
  }

  static constexpr std::size_t kRenewed = 32;
  static constexpr std::size_t kFirst = 8;
  static constexpr std::size_t kBins = 176;
  static constexpr double kSteps = 16.0;
  static constexpr double kShortest_s = 64e-6;

  std::array<std::uint16_t, kBins> bins_{};
  std::array<std::uint8_t, kWindow> ring_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  double p95_s_ = 0.0;
  double median_s_ = 0.0;
};

}  // namespace sparsha::haptics
