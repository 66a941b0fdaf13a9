#include "pipeline/layers/border.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sparsha::pipeline {
namespace {

constexpr double kReach = 2.5;  // scales
constexpr int kFewest = 4;

using Triple = std::array<double, 3>;

/// Solves a symmetric positive definite 3 x 3 system by Cramer's rule.
Triple solve(const std::array<Triple, 3>& m, const Triple& right) {
  const auto determinant = [](const Triple& a, const Triple& b, const Triple& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  };
  const double all = determinant(m[0], m[1], m[2]);
  return {determinant(right, m[1], m[2]) / all, determinant(m[0], right, m[2]) / all,
          determinant(m[0], m[1], right) / all};
}

}  // namespace

BorderExtension::BorderExtension(double scale, int radius)
    : nodes_(std::max(kFewest, static_cast<int>(std::lround(kReach * scale)) + 1)), radius_(radius) {
  std::vector<double> weight;
  std::array<Triple, 3> moments{};
  for (int m = 0; m < nodes_; ++m) {
    const double u = m / scale;
    weight.push_back(std::exp(-0.5 * u * u));
    const Triple basis = {1, u, u * u};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) moments[a][b] += weight.back() * basis[a] * basis[b];
  }
  for (int k = 1; k <= radius; ++k) {
    const double beyond = -k / scale;
    const Triple c = solve(moments, {1, beyond, beyond * beyond});
    for (int m = 0; m < nodes_; ++m) {
      const double u = m / scale;
      weights_.push_back(static_cast<float>(weight[static_cast<std::size_t>(m)] * (c[0] + c[1] * u + c[2] * u * u)));
    }
  }
}

std::vector<double> BorderExtension::folded(const std::vector<double>& filter, int distance) const {
  std::vector<double> result(static_cast<std::size_t>(std::max(nodes_, distance + radius_ + 1)));
  for (int k = -radius_; k <= radius_; ++k) {
    const double value = filter[static_cast<std::size_t>(k + radius_)];
    if (distance + k >= 0) {
      result[static_cast<std::size_t>(distance + k)] += value;
      continue;
    }
    const float* extension = weights(-(distance + k));
    for (int m = 0; m < nodes_; ++m) result[static_cast<std::size_t>(m)] += value * static_cast<double>(extension[m]);
  }
  return result;
}

}  // namespace sparsha::pipeline
