// Lambert's law under three lights; one light alone hides the edges that run along it.
#include "pipeline/report/shading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/numbers/statistics.h"

namespace sparsha::pipeline {
namespace {

struct Light {
  double x, y, z, strength;
};
// Unit vectors: 45 degrees up from the upper left, 40 degrees up from the left and from above.
constexpr std::array<Light, 3> kLights = {
    {{-0.5, 0.5, 0.70710678, 0.66}, {-0.76604444, 0, 0.64278761, 0.17}, {0, 0.76604444, 0.64278761, 0.17}}};
constexpr double kShownSlope = 0.55;  // the 80th percentile of slopes is drawn as steep as this
constexpr int kSteepnessStep = 7;     // pixels; the percentile needs no more
constexpr double kLeast = 0.7, kMost = 12;

/// Difference quotient along one axis from whichever neighbours are known.
double slope(float before, float here, float after, double pixel_m) {
  const bool has_before = !std::isnan(before), has_after = !std::isnan(after);
  if (has_before && has_after) return (static_cast<double>(after) - before) / (2 * pixel_m);
  if (has_after) return (static_cast<double>(after) - here) / pixel_m;
  if (has_before) return (static_cast<double>(here) - before) / pixel_m;
  return 0;
}

/// Sums over a sliding window of 2 radius + 1 pixels along each row.
Field sum_along_rows(const Field& field, int radius) {
  Field result(field.width, field.height);
  for (int row = 0; row < field.height; ++row) {
    const float* in = field.values.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(field.width);
    double sum = 0;
    for (int k = 0; k < std::min(radius, field.width); ++k) sum += in[k];
    for (int k = 0; k < field.width; ++k) {
      if (k + radius < field.width) sum += in[k + radius];
      if (k > radius) sum -= in[k - radius - 1];
      result.at(k, row) = static_cast<float>(sum);
    }
  }
  return result;
}

/// The same along each column, row by row as memory lies.
Field sum_along_columns(const Field& field, int radius) {
  Field result(field.width, field.height);
  std::vector<double> sum(static_cast<std::size_t>(field.width));
  const auto add = [&](int row, double sign) {
    if (row < 0 || row >= field.height) return;
    const float* in = field.values.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(field.width);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += sign * in[k];
  };
  for (int row = 0; row < radius; ++row) add(row, 1);
  for (int row = 0; row < field.height; ++row) {
    add(row + radius, 1);
    add(row - radius - 1, -1);
    for (std::size_t k = 0; k < sum.size(); ++k) result.at(static_cast<int>(k), row) = static_cast<float>(sum[k]);
  }
  return result;
}

}  // namespace

Shading shade(const Field& heights, double pixel_m) {
  const int width = heights.width, height = heights.height;
  Field along(width, height), up(width, height);
  std::vector<float> steepness;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const float here = heights.at(column, row);
      if (std::isnan(here)) continue;
      const auto neighbour = [&](int c, int r) {
        return c < 0 || r < 0 || c >= width || r >= height ? std::numeric_limits<float>::quiet_NaN() : heights.at(c, r);
      };
      const double sx = slope(neighbour(column - 1, row), here, neighbour(column + 1, row), pixel_m);
      const double sy = slope(neighbour(column, row + 1), here, neighbour(column, row - 1), pixel_m);
      along.at(column, row) = static_cast<float>(sx);
      up.at(column, row) = static_cast<float>(sy);
      if ((row + column) % kSteepnessStep == 0) steepness.push_back(static_cast<float>(std::sqrt(sx * sx + sy * sy)));
    }
  Shading result{Field(width, height), 1};
  if (!steepness.empty()) {
    const auto steep = static_cast<double>(sparsha::quantile(steepness, 0.8));
    if (steep > 0) result.exaggeration = std::clamp(kShownSlope / steep, kLeast, kMost);
  }
  for (std::size_t n = 0; n < result.light.values.size(); ++n) {
    if (std::isnan(along.values[n])) continue;
    const double x = -result.exaggeration * along.values[n], y = -result.exaggeration * up.values[n];
    const double norm = 1 / std::sqrt(x * x + y * y + 1);
    double light = 0;
    for (const Light& l : kLights) light += l.strength * std::max(0.0, (x * l.x + y * l.y + l.z) * norm);
    result.light.values[n] = static_cast<float>(light);
  }
  return result;
}

Field average_about(const Field& field, int radius) {
  Field sum = field, count = field;
  for (std::size_t n = 0; n < field.values.size(); ++n) {
    const bool known = !std::isnan(field.values[n]);
    sum.values[n] = known ? field.values[n] : 0.0F;
    count.values[n] = known ? 1.0F : 0.0F;
  }
  for (int pass = 0; pass < 2; ++pass) {
    sum = sum_along_columns(sum_along_rows(sum, radius), radius);
    count = sum_along_columns(sum_along_rows(count, radius), radius);
  }
  for (std::size_t n = 0; n < sum.values.size(); ++n)
    sum.values[n] = count.values[n] > 0.5F ? sum.values[n] / count.values[n] : std::numeric_limits<float>::quiet_NaN();
  return sum;
}

}  // namespace sparsha::pipeline
