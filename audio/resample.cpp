// Windowed-sinc resampling (Smith, "Digital Audio Resampling"), used once when a clip is loaded.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "audio/clip.h"

namespace sparsha::audio {
namespace {

constexpr int kCrossings = 32;
constexpr int kStepsPerCrossing = 512;
constexpr double kKaiserBeta = 10.0;  ///< about -100 dB

/// Modified Bessel function of the first kind, order 0.
double bessel_i0(double x) {
  double sum = 1.0, term = 1.0;
  for (int k = 1; k < 64; ++k) {
    term *= (0.5 * x / k) * (0.5 * x / k);
    sum += term;
    if (term < 1e-17 * sum) break;
  }
  return sum;
}

/// The kernel at multiples of 1/kStepsPerCrossing of a zero crossing.
std::vector<double> kernel_table() {
  std::vector<double> table(static_cast<std::size_t>(kCrossings) * kStepsPerCrossing + 2, 0.0);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double x = static_cast<double>(i) / kStepsPerCrossing;
    const double u = x / kCrossings;
    if (u >= 1.0) break;
    const double sinc = i == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
    table[i] = sinc * bessel_i0(kKaiserBeta * std::sqrt(1.0 - u * u)) / bessel_i0(kKaiserBeta);
  }
  return table;
}

}  // namespace

std::vector<float> resample(const std::vector<float>& samples, int channels, double from_hz, double to_hz) {
  if (from_hz == to_hz) return samples;
  static const std::vector<double> table = kernel_table();
  const auto width = static_cast<std::size_t>(channels);
  const auto frames = static_cast<std::ptrdiff_t>(samples.size() / width);
  const auto out_frames = static_cast<std::ptrdiff_t>(std::ceil(static_cast<double>(frames) * to_hz / from_hz));
  // Cut-off a little under the lower Nyquist, so that the transition band folds nothing audible back.
  const double cutoff = std::min(1.0, to_hz / from_hz) * (1.0 - 3.3 / kCrossings / 2.0);
  const double reach = kCrossings / cutoff;
  std::vector<float> out(static_cast<std::size_t>(out_frames) * width);
  std::vector<double> weights;
  for (std::ptrdiff_t n = 0; n < out_frames; ++n) {
    const double centre = static_cast<double>(n) * from_hz / to_hz;
    const auto begin = static_cast<std::ptrdiff_t>(std::ceil(centre - reach));
    const auto end = static_cast<std::ptrdiff_t>(std::floor(centre + reach));
    weights.clear();
    double total = 0.0;
    for (std::ptrdiff_t i = begin; i <= end; ++i) {
      const double x = std::abs(static_cast<double>(i) - centre) * cutoff * kStepsPerCrossing;
      const auto slot = std::min(static_cast<std::size_t>(x), table.size() - 2);
      const double part = x - static_cast<double>(slot);
      weights.push_back(table[slot] + part * (table[slot + 1] - table[slot]));
      total += weights.back();
    }
    for (std::size_t c = 0; c < width; ++c) {
      double sum = 0.0;
      for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(begin, 0); i <= std::min(end, frames - 1); ++i)
        sum += weights[static_cast<std::size_t>(i - begin)] *
               static_cast<double>(samples[static_cast<std::size_t>(i) * width + c]);
      out[static_cast<std::size_t>(n) * width + c] = static_cast<float>(sum / total);
    }
  }
  return out;
}

}  // namespace sparsha::audio
