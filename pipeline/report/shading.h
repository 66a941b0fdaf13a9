// Fields of one value per pixel, and the shading of heights.
#pragma once

#include <limits>
#include <vector>

namespace sparsha::pipeline {

/// Top row first, NaN where unknown.
struct Field {
  int width, height;
  std::vector<float> values;

  Field(int w, int h)
      : width(w),
        height(h),
        values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), std::numeric_limits<float>::quiet_NaN()) {}
  [[nodiscard]] float& at(int column, int row) {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
  }
  [[nodiscard]] float at(int column, int row) const {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
  }
};

struct Shading {
  Field light;              ///< 0 to 1
  double exaggeration = 1;  ///< of slopes, chosen so that shallow reliefs show
};

/// Light from the upper left with two weaker ones beside it. Heights in metres.
[[nodiscard]] Shading shade(const Field& heights, double pixel_m);

/// Mean of the known values within a square of `radius` pixels about each pixel, applied twice.
[[nodiscard]] Field average_about(const Field& field, int radius);

}  // namespace sparsha::pipeline
