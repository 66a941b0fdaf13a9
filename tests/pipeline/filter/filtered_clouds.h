// Made clouds for filters.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline::testing {

using Points = std::vector<std::array<float, 3>>;

inline Cloud cloud_of(const Points& points, bool attributes = false) {
  Cloud cloud;
  cloud.resize_points(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) cloud.xyz1()[4 * i + k] = points[i][k];
    if (attributes) {
      cloud.rgba.push_back(static_cast<std::uint32_t>(i));
      cloud.intensity.push_back(static_cast<float>(i));
    }
  }
  return cloud;
}

inline Points points_of(const Cloud& cloud) {
  Points points(cloud.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) points[i][k] = cloud.xyz1()[4 * i + k];
  }
  return points;
}

/// A noisy relief with outliers, density varying 1:100 and some duplicates.
inline Points relief(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::normal_distribution<float> normal(0.0F, 2e-4F);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const float u = uniform(random);
    const float x = u * u * u;
    const float y = uniform(random);
    float z = 0.05F * std::sin(6.0F * x) * std::cos(7.0F * y) + normal(random);
    if (i % 150 == 0) z += uniform(random);
    if (i % 97 == 1) {
      points.push_back(points.back());
    } else {
      points.push_back({x, y, z});
    }
  }
  points.push_back({1e4F, -1e4F, 3e3F});
  return points;
}

}  // namespace sparsha::pipeline::testing
