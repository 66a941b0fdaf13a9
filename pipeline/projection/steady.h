// Sizes that choose which points are looked at.
#pragma once

#include <cmath>

namespace sparsha::pipeline {

/// The power of the fourth root of two that is next to `value` by ratio, so that blocks and cells keep their places
/// when an estimate changes in its last digits. Requires value > 0.
[[nodiscard]] inline double steady(double value) { return std::exp2(0.25 * std::round(4.0 * std::log2(value))); }

}  // namespace sparsha::pipeline
