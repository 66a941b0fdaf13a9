#include "bench/effects/wavelet.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace sparsha::bench {
namespace {

const double kRoot3 = std::sqrt(3.0);
const double kScale = 4.0 * std::sqrt(2.0);
const std::array<double, 4> kLow = {(1.0 + kRoot3) / kScale, (3.0 + kRoot3) / kScale, (3.0 - kRoot3) / kScale,
                                    (1.0 - kRoot3) / kScale};
const std::array<double, 4> kHigh = {kLow[3], -kLow[2], kLow[1], -kLow[0]};
constexpr std::size_t kShortest = 4;

}  // namespace

std::vector<double> wavelet_transform(std::vector<double> samples) {
  for (std::size_t length = samples.size(); length >= kShortest; length /= 2) {
    std::vector<double> next(length, 0.0);
    for (std::size_t n = 0; n < length / 2; ++n)
      for (std::size_t tap = 0; tap < 4; ++tap) {
        const double value = samples[(2 * n + tap) % length];
        next[n] += kLow[tap] * value;
        next[length / 2 + n] += kHigh[tap] * value;
      }
    for (std::size_t n = 0; n < length; ++n) samples[n] = next[n];
  }
  return samples;
}

std::vector<double> inverse_wavelet_transform(std::vector<double> coefficients) {
  for (std::size_t length = kShortest; length <= coefficients.size(); length *= 2) {
    std::vector<double> next(length, 0.0);
    for (std::size_t n = 0; n < length / 2; ++n)
      for (std::size_t tap = 0; tap < 4; ++tap)
        next[(2 * n + tap) % length] += kLow[tap] * coefficients[n] + kHigh[tap] * coefficients[length / 2 + n];
    for (std::size_t n = 0; n < length; ++n) coefficients[n] = next[n];
  }
  return coefficients;
}

}  // namespace sparsha::bench
