// Where colours are looked at to find their scale, before a file's points are read: places spread over the file, which
// depend on nothing but the file, so that every way of reading it gives the same bytes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

#include "pipeline/scan/scalar.h"

namespace sparsha::pipeline {

/// The largest channel value among those looked at, and the scale that it tells.
class ColourRange {
 public:
  /// `fractions`: the channels are floating-point numbers.
  explicit ColourRange(bool fractions) : fractions_(fractions) {}

  void look(double value) {
    if (value > largest_) largest_ = value;  // NaN is not
  }
  [[nodiscard]] ColourScale scale() const { return colour_scale(largest_, fractions_); }
  /// No larger value changes the scale.
  [[nodiscard]] bool is_decided() const { return scale() == ColourScale::word; }

 private:
  bool fractions_;
  double largest_ = 0.0;
};

inline constexpr std::uint64_t kColourSample = 1 << 16;  ///< records that are looked at
inline constexpr std::uint64_t kColourRun = 1 << 8;      ///< of which so many follow one another

/// Calls `look(i)` with ascending numbers of records until it gives false: all of kColourSample records or fewer, else
/// runs from the first record to the last, at equal distances.
template <typename Look>
void at_sampled_records(std::uint64_t records, const Look& look) {
  constexpr std::uint64_t kRuns = kColourSample / kColourRun;
  const bool all = records <= kColourSample;
  const std::uint64_t length = all ? records : kColourRun;
  const std::uint64_t step = all ? 0 : (records - kColourRun) / (kRuns - 1);
  for (std::uint64_t run = 0; run < (all ? 1 : kRuns); ++run) {
    const std::uint64_t first = run + 1 < kRuns ? run * step : records - kColourRun;
    for (std::uint64_t i = first; i < first + length; ++i) {
      if (!look(i)) return;
    }
  }
}

/// Parts of whole lines: all of a text of 4 MiB or less, else 256 parts of up to 16 KiB from its beginning to its end.
[[nodiscard]] std::vector<std::string_view> sampled_lines(std::string_view text);

}  // namespace sparsha::pipeline
