#include "pipeline/scan/formats/splat/splats.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace sparsha::pipeline {

void note_splats(RawScan& scan) {
  if (std::find(scan.notes.begin(), scan.notes.end(), kSplatNote) == scan.notes.end())
    scan.notes.emplace_back(kSplatNote);
}

void SplatSieve::look_at(double opacity, double longest) {
  if (opacity >= kLeastOpacity && std::isfinite(longest)) axes_.push_back(longest);
}

void SplatSieve::decide() {
  most_ = std::numeric_limits<double>::infinity();
  if (axes_.empty()) return;
  const auto middle = axes_.begin() + static_cast<std::ptrdiff_t>(axes_.size() / 2);
  std::nth_element(axes_.begin(), middle, axes_.end());
  if (*middle > 0.0) most_ = kMostMedians * *middle;
  axes_ = {};
}

void SplatSieve::warn(RawScan& scan) const {
  note_splats(scan);
  const std::uint64_t gone = faint_ + large_ + not_numbers_;
  if (gone == 0) return;
  scan.warnings.push_back(fmt::format(
      "{} of {} splats are no surface and are counted as invalid: {} have an opacity below {}, {} an axis "
      "longer than {} times the median's{}",
      gone, seen_, faint_, kLeastOpacity, large_, kMostMedians,
      not_numbers_ > 0 ? fmt::format(", {} an opacity or an axis that is not a number", not_numbers_) : ""));
}

}  // namespace sparsha::pipeline
