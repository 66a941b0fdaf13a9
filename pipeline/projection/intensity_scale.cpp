#include "pipeline/projection/intensity_scale.h"

#include <algorithm>
#include <cmath>

namespace sparsha::pipeline {

std::optional<std::int64_t> IntensityScale::of(float intensity) const {
  if (!std::isfinite(intensity)) return std::nullopt;
  return std::llround(static_cast<double>(intensity) * per_one_);
}

float largest_magnitude(const float* values, std::size_t count) {
  float largest = 0.0F;
  for (std::size_t k = 0; k < count; ++k) {
    if (std::isfinite(values[k])) largest = std::max(largest, std::abs(values[k]));
  }
  return largest;
}

}  // namespace sparsha::pipeline
