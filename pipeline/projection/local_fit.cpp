// Hands layers to the kernels; the fits that noise is estimated from are in double.
#include "pipeline/projection/local_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/numbers/statistics.h"
#include "pipeline/projection/simd/kernels.h"

namespace sparsha::pipeline {
namespace {

constexpr double kSlopePrior = 1.5;
// Of quadrics through few points; at the kernel's radius a bend is as unlikely as a quarter of a slope.
constexpr float kBendPrior = 16.0F;

// z = c0 + c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2, metres and spacings; a plane has c3 = c4 = c5 = 0.
using Coefficients = std::array<double, 6>;

double value(const Coefficients& c, const NodePoint& p) {
  const double u = static_cast<double>(p.u);
  const double v = static_cast<double>(p.v);
  return c[0] + u * (c[1] + c[3] * u + c[4] * v) + v * (c[2] + c[5] * v);
}

// Cholesky of a symmetric positive definite system with `n` unknowns; false when it is singular.
template <std::size_t N>
bool solve(std::array<std::array<double, N>, N>& a, std::array<double, N>& b) {
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = a[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      if (i == j) {
        if (!(sum > 1e-12 * a[i][i])) return false;
        a[i][i] = std::sqrt(sum);
      } else {
        a[i][j] = sum / a[j][j];
      }
    }
  }
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (std::size_t i = N; i-- > 0;) {
    for (std::size_t k = i + 1; k < N; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
  return true;
}

bool fit_quadric(std::span<const NodePoint> points, const double* w, double ridge, double z0, Coefficients& c) {
  std::array<double, 27> sums{};
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (w[k] <= 0.0) continue;
    const double u = static_cast<double>(points[k].u);
    const double v = static_cast<double>(points[k].v);
    const double z = static_cast<double>(points[k].z) - z0;
    const std::array<double, 6> row{1.0, u, v, u * u, u * v, v * v};
    std::size_t s = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      const double wi = w[k] * row[i];
      for (std::size_t j = 0; j <= i; ++j) sums[s++] += wi * row[j];
    }
    for (std::size_t i = 0; i < 6; ++i) sums[s++] += w[k] * row[i] * z;
  }
  std::array<std::array<double, 6>, 6> a{};
  std::array<double, 6> b{};
  std::size_t s = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j <= i; ++j) a[i][j] = sums[s++];
  }
  for (std::size_t i = 0; i < 6; ++i) b[i] = sums[s++];
  for (std::size_t i = 1; i < 6; ++i) a[i][i] += ridge;
  if (!solve(a, b)) return false;
  b[0] += z0;
  c = b;
  return true;
}

}  // namespace

double residual_scale(double noise_m, double spacing_m) { return std::max(noise_m, 0.01 * spacing_m); }

double slope_ridge(double scale_m, double spacing_m) {
  const double ratio = scale_m / (kSlopePrior * spacing_m);
  return ratio * ratio;
}

LocalFit fit_locally(std::span<const NodePoint> points, const LocalFitRule& rule, std::vector<float>& scratch) {
  LocalFit result;
  result.height_m = std::numeric_limits<double>::quiet_NaN();
  if (points.empty()) return result;
  const std::size_t stride = points.size() + LayerKernel::kReadAhead;
  scratch.resize(4 * stride);
  LayerKernel kernel;
  kernel.u = scratch.data();
  kernel.v = kernel.u + stride;
  kernel.z = kernel.v + stride;
  kernel.w = kernel.z + stride;
  // In units of the kernel's radius, so that the normal equations of wide windows fit a float.
  const auto per_radius = static_cast<float>(1.0 / rule.radius);
  const float z0 = points.front().z;
  for (std::size_t k = 0; k < points.size(); ++k) {
    kernel.u[k] = points[k].u * per_radius;
    kernel.v[k] = points[k].v * per_radius;
    kernel.z[k] = points[k].z - z0;
  }
  const double scale = residual_scale(rule.noise_m, rule.spacing_m);
  kernel.per_r2 = 1.0F;
  kernel.scale_m = static_cast<float>(scale);
  kernel.ridge = static_cast<float>(slope_ridge(scale, rule.spacing_m * rule.radius));
  kernel.bend_ridge = kBendPrior * kernel.ridge;
  const LayerFit fit = fastest_kernels().fit_layer(kernel, points.size());
  result.support = fit.support;
  if (!fit.good) return result;
  result.height_m = static_cast<double>(z0) + static_cast<double>(fit.height_m);
  result.slope_u_m = static_cast<double>(fit.slope_u_m * per_radius);
  result.slope_v_m = static_cast<double>(fit.slope_v_m * per_radius);
  result.loss = static_cast<double>(fit.loss);
  return result;
}

double residual_scale_m(std::span<const NodePoint> points, std::vector<double>& scratch) {
  constexpr std::size_t kLeast = 12;
  if (points.size() < kLeast) return -1.0;
  scratch.assign(points.size(), 1.0);
  Coefficients quadric{};
  const double z0 = static_cast<double>(points[points.size() / 2].z);
  if (!fit_quadric(points, scratch.data(), 1e-9, z0, quadric)) return -1.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    scratch[k] = std::abs(static_cast<double>(points[k].z) - value(quadric, points[k]));
  }
  const auto count = static_cast<double>(points.size());
  return 1.4826 * median(scratch) * std::sqrt(count / (count - 6.0));
}

}  // namespace sparsha::pipeline
