#include "scene/material/height_spectrum.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/numbers/statistics.h"

namespace sparsha::scene {
namespace {

constexpr double kLeastExponent = 1.0;
constexpr double kMostExponent = 4.0;
constexpr std::size_t kFewestProfiles = 8;

/// Least squares with the middle of the profile as zero, so that mean and slope are independent.
std::vector<double> without_trend(const std::vector<double>& heights_m) {
  const auto n = static_cast<double>(heights_m.size());
  double mean = 0.0;
  double slope = 0.0;
  double spread = 0.0;
  for (std::size_t i = 0; i < heights_m.size(); ++i) {
    const double x = static_cast<double>(i) - 0.5 * (n - 1.0);
    mean += heights_m[i] / n;
    slope += x * heights_m[i];
    spread += x * x;
  }
  slope /= spread;
  std::vector<double> rest(heights_m.size());
  for (std::size_t i = 0; i < heights_m.size(); ++i)
    rest[i] = heights_m[i] - mean - slope * (static_cast<double>(i) - 0.5 * (n - 1.0));
  return rest;
}

}  // namespace

HeightSpectrumFit::HeightSpectrumFit(int length, double spacing_m)
    : length_(length), spacing_m_(spacing_m), first_(std::max(3, length / 16)), last_(length / 4) {
  densities_m3_.resize(static_cast<std::size_t>(last_ - first_) + 1);
  for (int i = 0; i < length; ++i) {
    cosine_.push_back(std::cos(2.0 * std::numbers::pi * i / length));
    window_.push_back(std::sqrt(8.0 / 3.0) * 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * (i + 0.5) / length)));
  }
}

void HeightSpectrumFit::add(const std::vector<double>& heights_m) {
  std::vector<double> rest = without_trend(heights_m);
  for (std::size_t i = 0; i < rest.size(); ++i) rest[i] *= window_[i];
  for (int q = first_; q <= last_; ++q) {
    double even = 0.0;
    double odd = 0.0;
    for (int i = 0; i < length_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const int turn = q * i % length_;
      even += rest[at] * cosine_[static_cast<std::size_t>(turn)];
      odd += rest[at] * cosine_[static_cast<std::size_t>((turn + length_ / 4) % length_)];
    }
    densities_m3_[static_cast<std::size_t>(q - first_)].push_back((even * even + odd * odd) * spacing_m_ / length_);
  }
}

HeightSpectrum HeightSpectrumFit::fit() const {
  HeightSpectrum spectrum;
  if (densities_m3_.front().size() < kFewestProfiles) return spectrum;
  const double nyquist_per_m = 0.5 / spacing_m_;
  double n = 0.0;
  double sum_x = 0.0;
  double sum_y = 0.0;
  double sum_xx = 0.0;
  double sum_xy = 0.0;
  for (int q = first_; q <= last_; ++q) {
    // A periodogram is exponentially distributed about the density: its median is ln 2 times the mean. Steps and
    // grooves are few, and medians do not see them.
    std::vector<double> densities_m3 = densities_m3_[static_cast<std::size_t>(q - first_)];
    const double density_m3 = median(densities_m3) / std::numbers::ln2;
    if (!(density_m3 > 0.0) || !std::isfinite(density_m3)) return spectrum;
    const double x = std::log(q / (length_ * spacing_m_) / nyquist_per_m);
    const double y = std::log(density_m3);
    const double weight = 1.0 / q;  // the same for every octave
    n += weight;
    sum_x += weight * x;
    sum_y += weight * y;
    sum_xx += weight * x * x;
    sum_xy += weight * x * y;
  }
  const double slope = (n * sum_xy - sum_x * sum_y) / (n * sum_xx - sum_x * sum_x);
  if (-slope < kLeastExponent) return spectrum;
  spectrum.exponent = std::min(-slope, kMostExponent);
  // Through the middle of what was fitted.
  spectrum.level_m3 = std::exp(sum_y / n + spectrum.exponent * sum_x / n);
  spectrum.from_per_m = nyquist_per_m;
  return spectrum;
}

}  // namespace sparsha::scene
