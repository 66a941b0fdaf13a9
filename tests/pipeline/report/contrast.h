// How light colours are and how far apart, as WCAG 2.1 defines it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "pipeline/report/colour.h"

namespace sparsha::pipeline::testing {

/// Relative luminance, 0 to 1.
inline double luminance(const Rgb& c) {
  const auto channel = [](std::uint8_t v) {
    const double s = v / 255.0;
    return s <= 0.03928 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * channel(c.r) + 0.7152 * channel(c.g) + 0.0722 * channel(c.b);
}

/// 1 to 21.
inline double contrast(const Rgb& a, const Rgb& b) {
  const auto [low, high] = std::minmax({luminance(a), luminance(b)});
  return (high + 0.05) / (low + 0.05);
}

}  // namespace sparsha::pipeline::testing
