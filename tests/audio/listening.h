// How the tests listen: measurements on samples that share no code with the synthesiser.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

namespace listening {

using Samples = std::vector<double>;

/// Every second value of interleaved stereo, from `channel`.
inline Samples channel(const std::vector<float>& interleaved, std::size_t channel) {
  Samples result;
  for (std::size_t i = channel; i < interleaved.size(); i += 2) result.push_back(static_cast<double>(interleaved[i]));
  return result;
}

inline double hann(std::size_t i, std::size_t n) {
  return 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(n));
}

/// Amplitude at one frequency of the Hann-windowed piece [begin, end): a sinusoid of amplitude a gives a.
inline double amplitude_at(const Samples& x, double frequency_hz, double rate_hz, std::size_t begin, std::size_t end) {
  const double step = -2.0 * std::numbers::pi * frequency_hz / rate_hz;
  const std::complex<double> turn = std::polar(1.0, step),
                             window_turn = std::polar(1.0, 2.0 * std::numbers::pi / static_cast<double>(end - begin));
  std::complex<double> sum = 0.0, phase, window_phase;
  for (std::size_t i = begin; i < end; ++i) {
    if ((i - begin) % 256 == 0) {  // exact again, before rounding of the turns adds up
      const auto t = static_cast<double>(i - begin);
      phase = std::polar(1.0, step * t);
      window_phase = std::polar(1.0, 2.0 * std::numbers::pi * (t + 0.5) / static_cast<double>(end - begin));
    }
    sum += (0.5 - 0.5 * window_phase.real()) * x[i] * phase;
    phase *= turn;
    window_phase *= window_turn;
  }
  return 4.0 * std::abs(sum) / static_cast<double>(end - begin);
}

/// Radix-2 transform in place.
inline void fourier(std::vector<std::complex<double>>& x) {
  const std::size_t n = x.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1U;
    for (; (j & bit) != 0; bit >>= 1U) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(x[i], x[j]);
  }
  for (std::size_t length = 2; length <= n; length *= 2)
    for (std::size_t k = 0; k < length / 2; ++k) {
      const auto turn = std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(length));
      for (std::size_t i = k; i < n; i += length) {
        const auto odd = turn * x[i + length / 2];
        x[i + length / 2] = x[i] - odd;
        x[i] += odd;
      }
    }
}

/// Magnitudes of the Hann-windowed piece, zero-padded to a power of two of at least twice its length; bin k is at
/// k * rate / (2 * size).
inline Samples spectrum(const Samples& x, std::size_t begin, std::size_t end) {
  std::size_t size = 2;
  while (size < 2 * (end - begin)) size *= 2;
  std::vector<std::complex<double>> line(size);
  for (std::size_t i = begin; i < end; ++i) line[i - begin] = x[i] * hann(i - begin, end - begin);
  fourier(line);
  Samples result(size / 2);
  for (std::size_t k = 0; k < result.size(); ++k) result[k] = std::abs(line[k]);
  return result;
}

/// Frequency of the strongest line between two limits: the highest bin, refined by golden section.
inline double strongest_frequency(const Samples& x, double from_hz, double to_hz, double rate_hz, std::size_t begin,
                                  std::size_t end) {
  const Samples line = spectrum(x, begin, end);
  const double bin = rate_hz / (2.0 * static_cast<double>(line.size()));
  const auto first = line.begin() + static_cast<std::ptrdiff_t>(from_hz / bin);
  const auto last = line.begin() + static_cast<std::ptrdiff_t>(to_hz / bin) + 1;
  const double best = bin * static_cast<double>(std::max_element(first, last) - line.begin());
  double low = best - bin, high = best + bin;
  for (int i = 0; i < 16; ++i) {
    const double a = low + 0.382 * (high - low), b = low + 0.618 * (high - low);
    const bool left = amplitude_at(x, a, rate_hz, begin, end) > amplitude_at(x, b, rate_hz, begin, end);
    (left ? high : low) = left ? b : a;
  }
  return 0.5 * (low + high);
}

/// Time to fall by 60 dB of the line at one frequency: least squares through the levels (dB) of 50 ms windows.
inline double t60_s(const Samples& x, double frequency_hz, double rate_hz, double from_s, double to_s) {
  const auto width = static_cast<std::size_t>(0.05 * rate_hz);
  double n = 0, st = 0, sl = 0, stt = 0, stl = 0;
  for (double t = from_s; t + 0.05 <= to_s; t += 0.025) {
    const auto begin = static_cast<std::size_t>(t * rate_hz);
    const double level = 20.0 * std::log10(amplitude_at(x, frequency_hz, rate_hz, begin, begin + width));
    n += 1, st += t, sl += level, stt += t * t, stl += t * level;
  }
  return -60.0 * (n * stt - st * st) / (n * stl - st * sl);
}

inline double rms(const Samples& x, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (std::size_t i = begin; i < end; ++i) sum += x[i] * x[i];
  return std::sqrt(sum / static_cast<double>(end - begin));
}

inline double peak(const Samples& x) {
  double most = 0.0;
  for (const double value : x) most = std::max(most, std::abs(value));
  return most;
}

/// Largest magnitude between samples too: 8 times oversampled by a 48-tap Hann-windowed sinc (BS.1770 asks for 4
/// times).
inline double true_peak(const Samples& x) {
  constexpr int kTaps = 24, kFactor = 8;
  double most = peak(x);
  for (std::size_t i = kTaps; i + kTaps < x.size(); ++i) {
    if (std::abs(x[i]) < 0.5 * most) continue;  // peaks between samples lie beside high ones
    for (int k = 1; k < kFactor; ++k) {
      double sum = 0.0;
      for (int j = -kTaps + 1; j <= kTaps; ++j) {
        const double d = static_cast<double>(k) / kFactor - j;
        const double window = 0.5 + 0.5 * std::cos(std::numbers::pi * d / kTaps);
        sum += x[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + j)] * window *
               std::sin(std::numbers::pi * d) / (std::numbers::pi * d);
      }
      most = std::max(most, std::abs(sum));
    }
  }
  return most;
}

/// Index of the first sample that is not exactly zero; size when there is none.
inline std::size_t onset(const Samples& x) {
  return static_cast<std::size_t>(std::find_if(x.begin(), x.end(), [](double value) { return value != 0.0; }) -
                                  x.begin());
}

/// Integrated loudness of stereo in LUFS (ITU-R BS.1770-4): K-weighting at 48 kHz with the published coefficients,
/// blocks of 400 ms with 75 % overlap, gates at -70 LUFS and 10 LU below what is left.
inline double integrated_lufs(const std::vector<float>& interleaved) {
  const auto filtered = [](Samples x, const std::array<double, 3>& b, const std::array<double, 2>& a) {
    double x1 = 0, x2 = 0, y1 = 0, y2 = 0;
    for (double& value : x) {
      const double y = b[0] * value + b[1] * x1 + b[2] * x2 - a[0] * y1 - a[1] * y2;
      x2 = x1, x1 = value, y2 = y1, y1 = y;
      value = y;
    }
    return x;
  };
  std::vector<double> powers;
  for (std::size_t side = 0; side < 2; ++side) {
    Samples x = filtered(channel(interleaved, side), {1.53512485958697, -2.69169618940638, 1.19839281085285},
                         {-1.69065929318241, 0.73248077421585});
    x = filtered(x, {1.0, -2.0, 1.0}, {-1.99004745483398, 0.99007225036621});
    std::size_t block = 0;
    for (std::size_t begin = 0; begin + 19200 <= x.size(); begin += 4800, ++block) {
      const double level = rms(x, begin, begin + 19200);
      if (side == 0) powers.push_back(0.0);
      powers[block] += level * level;
    }
  }
  const auto gated = [&](double least) {
    double sum = 0.0;
    int count = 0;
    for (const double power : powers)
      if (power > least) sum += power, ++count;
    return count > 0 ? sum / count : 0.0;
  };
  const double absolute = std::pow(10.0, (-70.0 + 0.691) / 10.0);
  return -0.691 + 10.0 * std::log10(gated(std::max(absolute, 0.1 * gated(absolute))));
}

inline double decibel(double ratio) { return 20.0 * std::log10(ratio); }

/// Largest second difference: a click is a step or a corner that the sound itself does not have.
inline double sharpest_corner(const Samples& x, std::size_t begin, std::size_t end) {
  double most = 0.0;
  for (std::size_t i = std::max<std::size_t>(begin, 2); i < end; ++i)
    most = std::max(most, std::abs(x[i] - 2.0 * x[i - 1] + x[i - 2]));
  return most;
}

}  // namespace listening
