// Weighted least squares with Tukey's biweight (Beaton & Tukey 1974) where residuals exceed three sigma.
#include "pipeline/grid/project_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sparsha::pipeline {
namespace {

constexpr double kTukey = 4.685;  // 95 % efficiency under Gaussian noise
constexpr int kRounds = 3;
constexpr double kSlopePrior = 1.5;

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

// Weighted plane about the centroid of the weights, slopes held by the prior.
bool fit_plane(std::span<const NodePoint> points, const double* w, double ridge, double z0, Coefficients& c) {
  double sw = 0, su = 0, sv = 0, sz = 0, suu = 0, suv = 0, svv = 0, suz = 0, svz = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double u = static_cast<double>(points[k].u);
    const double v = static_cast<double>(points[k].v);
    const double z = static_cast<double>(points[k].z) - z0;
    const double wu = w[k] * u;
    const double wv = w[k] * v;
    sw += w[k];
    su += wu;
    sv += wv;
    sz += w[k] * z;
    suu += wu * u;
    suv += wu * v;
    svv += wv * v;
    suz += wu * z;
    svz += wv * z;
  }
  if (!(sw > 0.0)) return false;
  const double mu = su / sw;
  const double mv = sv / sw;
  const double mz = sz / sw;
  const double auu = suu - su * mu + ridge + 1e-6 * sw;
  const double avv = svv - sv * mv + ridge + 1e-6 * sw;
  const double auv = suv - su * mv;
  const double bu = suz - su * mz;
  const double bv = svz - sv * mz;
  const double determinant = auu * avv - auv * auv;
  if (!(determinant > 0.0)) return false;
  const double gu = (bu * avv - bv * auv) / determinant;
  const double gv = (bv * auu - bu * auv) / determinant;
  c = {z0 + mz - gu * mu - gv * mv, gu, gv, 0.0, 0.0, 0.0};
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

// Weighted mean of Tukey's loss, 0 to 1; what lies beyond kTukey scales costs 1.
double loss(std::span<const NodePoint> points, const double* kernel, double scale, const Coefficients& c) {
  double sum = 0.0;
  double weight = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double r = (static_cast<double>(points[k].z) - value(c, points[k])) / (kTukey * scale);
    const double inside = std::max(0.0, 1.0 - r * r);
    sum += kernel[k] * (1.0 - inside * inside * inside);
    weight += kernel[k];
  }
  return sum / weight;
}

void tukey_weights(std::span<const NodePoint> points, const double* kernel, double scale, const Coefficients& c,
                   double* w) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double r = (static_cast<double>(points[k].z) - value(c, points[k])) / (kTukey * scale);
    const double inside = std::max(0.0, 1.0 - r * r);
    w[k] = kernel[k] * inside * inside;
  }
}

}  // namespace

double residual_scale(double noise_m, double spacing_m) { return std::max(noise_m, 0.01 * spacing_m); }

double slope_ridge(double scale_m, double spacing_m) {
  const double ratio = scale_m / (kSlopePrior * spacing_m);
  return ratio * ratio;
}

LocalFit fit_locally(std::span<const NodePoint> points, const LocalFitRule& rule, std::vector<double>& scratch) {
  LocalFit result;
  result.height_m = std::numeric_limits<double>::quiet_NaN();
  scratch.resize(2 * points.size());
  double* kernel = scratch.data();
  double* w = kernel + points.size();
  const double per_r2 = 1.0 / (rule.radius * rule.radius);
  double z0 = 0.0;
  double total = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double u = static_cast<double>(points[k].u);
    const double v = static_cast<double>(points[k].v);
    const double t = std::max(0.0, 1.0 - (u * u + v * v) * per_r2);
    kernel[k] = t * t;
    result.support += t > 0.0 ? 1 : 0;
    z0 += kernel[k] * static_cast<double>(points[k].z);
    total += kernel[k];
  }
  if (!(total > 0.0)) return result;
  z0 /= total;
  const double scale = residual_scale(rule.noise_m, rule.spacing_m);
  const double ridge = slope_ridge(scale, rule.spacing_m);
  Coefficients plane{};
  if (!fit_plane(points, kernel, ridge, z0, plane)) return result;
  double worst = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (kernel[k] <= 0.0) continue;
    worst = std::max(worst, std::abs(static_cast<double>(points[k].z) - value(plane, points[k])));
  }
  Coefficients best = plane;
  if (worst > 3.0 * scale) {
    for (int round = 0; round < kRounds; ++round) {
      tukey_weights(points, kernel, scale, best, w);
      if (!fit_plane(points, w, ridge, z0, best)) break;
    }
    const double best_loss = loss(points, kernel, scale, best);
    result.loss = best_loss;
    Coefficients quadric{};
    // Four and a half sigma are not noise any more: the surface may be bent.
    if (result.support >= 10 && worst > 4.5 * scale && fit_quadric(points, kernel, ridge, z0, quadric)) {
      for (int round = 0; round < kRounds; ++round) {
        tukey_weights(points, kernel, scale, quadric, w);
        if (!fit_quadric(points, w, ridge, z0, quadric)) break;
      }
      // Three more coefficients earn their variance only with a clearly better fit.
      const double quadric_loss = loss(points, kernel, scale, quadric);
      if (quadric_loss * (1.0 + 6.0 / static_cast<double>(result.support)) < best_loss) {
        best = quadric;
        result.loss = quadric_loss;
      }
    }
  }
  result.height_m = best[0];
  result.slope_u_m = best[1];
  result.slope_v_m = best[2];
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
  const auto middle = scratch.begin() + static_cast<std::ptrdiff_t>(scratch.size() / 2);
  std::nth_element(scratch.begin(), middle, scratch.end());
  const auto count = static_cast<double>(points.size());
  return 1.4826 * *middle * std::sqrt(count / (count - 6.0));
}

}  // namespace sparsha::pipeline
