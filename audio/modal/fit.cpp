// Finds the onset of the strike, the peaks of its spectrum, and each mode's decay through time.
#include "audio/modal/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <optional>

#include "audio/decibel.h"
#include "scene/material/sound_limits.h"

namespace sparsha::audio {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;
constexpr float kOnset = 0.1F;       // of the loudest sample
constexpr double kRise_s = 0.05;     // from the onset to the loudest sample, at most
constexpr double kAttack_s = 0.002;  // what a hammer adds
// Spectra are taken over so long: short ones for modes that are over soon.
constexpr std::array<double, 3> kSpectra_s = {1.0, 0.25, 0.06};
constexpr double kShortest_s = 0.03;  // a sound that is shorter does not ring
constexpr double kFaintest_db = -55.0;
/// A mode is so many times the median of the spectrum around it. Levels of noise have a Rayleigh distribution: one in
/// 2^(5 * 5) reaches five times its median.
constexpr double kAboveNoise = 5.0;
constexpr std::size_t kAroundLobes = 8;  // on either side
constexpr double kLoud_db = -20.0;       // of the loudest peak: one that is left out is told of
constexpr double kFollowed_db = 40.0;    // of a mode's decay
constexpr double kClosest_hz = 6.0;      // modes that are closer are one
constexpr int kRounds = 4;
constexpr double kFewestSamples = 32.0;  // of a window
constexpr int kFewestWindows = 12;       // an eighth of their length apart
constexpr double kUneven = 0.2;          // of the logarithm of the amplitude
constexpr double kLeastFall = 0.3;       // of the same, from the first window to the last
constexpr double kLn1000 = 6.907755278982137;

double hann(double share) { return 0.5 - 0.5 * std::cos(2.0 * kPi * share); }

void transform(std::vector<Complex>& x) {  // radix 2, in place
  const std::size_t n = x.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n / 2;
    for (; (j & bit) != 0; bit /= 2) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(x[i], x[j]);
  }
  for (std::size_t length = 2; length <= n; length *= 2)
    for (std::size_t k = 0; k < length / 2; ++k) {
      const Complex turn = std::polar(1.0, -2.0 * kPi * static_cast<double>(k) / static_cast<double>(length));
      for (std::size_t i = k; i < n; i += length) {
        const Complex odd = turn * x[i + length / 2];
        x[i + length / 2] = x[i] - odd;
        x[i] += odd;
      }
    }
}

/// Without the constant that a recorder adds.
std::vector<float> without_offset(std::span<const float> sound) {
  double sum = 0.0;
  for (const float value : sound) sum += static_cast<double>(value);
  const auto mean = static_cast<float>(sum / static_cast<double>(sound.size()));
  std::vector<float> result(sound.begin(), sound.end());
  for (float& value : result) value -= mean;
  return result;
}

/// The first sample that belongs to the strike, and the one from which on it rings alone.
struct Begin {
  std::size_t onset = 0;
  std::size_t ringing = 0;
};
Begin begin_of(std::span<const float> sound, double rate_hz) {
  const auto louder = [](float a, float b) { return std::abs(a) < std::abs(b); };
  const auto loudest = std::max_element(sound.begin(), sound.end(), louder);
  const float threshold = kOnset * std::abs(*loudest);
  // Steps, clicks and softer strikes come earlier than the strike's own rise.
  const auto rise = std::min(loudest - sound.begin(), static_cast<std::ptrdiff_t>(kRise_s * rate_hz));
  const auto first = std::find_if(loudest - rise, loudest, [&](float value) { return std::abs(value) >= threshold; });
  return {static_cast<std::size_t>(first - sound.begin()),
          static_cast<std::size_t>(loudest - sound.begin()) + static_cast<std::size_t>(kAttack_s * rate_hz)};
}

struct Peak {
  double frequency_hz = 0.0;
  double amplitude = 0.0;
  bool noise = false;  ///< no mode, but what a mode next to it is told apart from
};

/// Four terms (Blackman-Harris): side lobes 92 dB down, so that they are no peaks; four bins to the first zero.
double blackman_harris(double share) {
  const double turn = 2.0 * kPi * share;
  return 0.35875 - 0.48829 * std::cos(turn) + 0.14128 * std::cos(2.0 * turn) - 0.01168 * std::cos(3.0 * turn);
}

/// Of the levels up to `reach` bins from bin `k`.
double median_around(const std::vector<double>& level, std::size_t k, std::size_t reach) {
  const auto first = level.begin() + static_cast<std::ptrdiff_t>(k - std::min(k, reach));
  const auto last = level.begin() + static_cast<std::ptrdiff_t>(std::min(level.size(), k + reach + 1));
  std::vector<double> around(first, last);
  const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
  std::nth_element(around.begin(), middle, around.end());
  return *middle;
}

/// Adds the peaks of the spectrum of the first `length` samples that lie apart from those that are known.
void add_peaks(std::span<const float> sound, double rate_hz, std::size_t length, std::vector<Peak>& peaks) {
  std::size_t size = 1;
  while (size < 2 * length) size *= 2;
  std::vector<Complex> line(size);
  for (std::size_t i = 0; i < length; ++i)
    line[i] =
        static_cast<double>(sound[i]) * blackman_harris((static_cast<double>(i) + 0.5) / static_cast<double>(length));
  transform(line);
  const double bin_hz = rate_hz / static_cast<double>(size);
  std::vector<double> level(size / 2);
  for (std::size_t k = 0; k < level.size(); ++k) level[k] = std::abs(line[k]) / static_cast<double>(length);
  // A peak is the highest within the width of the window's main lobe.
  const double lobe_hz = std::max(kClosest_hz, 4.0 * rate_hz / static_cast<double>(length));
  const auto reach = static_cast<std::size_t>(std::ceil(lobe_hz / bin_hz));
  const double faintest = *std::max_element(level.begin(), level.end()) * from_decibel(kFaintest_db);
  const std::size_t known = peaks.size();
  for (std::size_t k = reach; k + reach < level.size(); ++k) {
    const double frequency = static_cast<double>(k) * bin_hz;
    if (frequency < 2.0 * scene::kLeastFrequency_hz || frequency > scene::kMostFrequency_hz) continue;
    const auto first = level.begin() + static_cast<std::ptrdiff_t>(k - reach);
    const auto last = level.begin() + static_cast<std::ptrdiff_t>(k + reach + 1);
    if (!(level[k] > faintest) || *std::max_element(first, last) != level[k]) continue;
    const bool apart =
        std::none_of(peaks.begin(), peaks.begin() + static_cast<std::ptrdiff_t>(known),
                     [&](const Peak& peak) { return std::abs(peak.frequency_hz - frequency) < lobe_hz; });
    if (!apart) continue;
    const bool noise = level[k] < kAboveNoise * median_around(level, k, kAroundLobes * reach);
    peaks.push_back({frequency, level[k], noise});
  }
}

std::vector<Peak> peaks_of(std::span<const float> sound, double rate_hz, std::size_t most) {
  std::vector<Peak> peaks;
  for (const double seconds : kSpectra_s)
    add_peaks(sound, rate_hz, std::min(sound.size(), static_cast<std::size_t>(seconds * rate_hz)), peaks);
  std::sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.amplitude > b.amplitude; });
  if (peaks.size() > 4 * most) peaks.resize(4 * most);
  return peaks;
}

/// The windowed sum of the sound at one frequency, as an amplitude.
Complex amplitude_at(std::span<const float> sound, double frequency_hz, double rate_hz, std::size_t begin,
                     std::size_t length) {
  const Complex turn = std::polar(1.0, -2.0 * kPi * frequency_hz / rate_hz);
  const double step = 2.0 * kPi * frequency_hz / rate_hz;
  Complex sum = 0.0, phase;
  for (std::size_t i = 0; i < length; ++i) {
    if (i % 512 == 0) phase = std::polar(1.0, -step * static_cast<double>(begin + i));
    sum += static_cast<double>(sound[begin + i]) * hann((static_cast<double>(i) + 0.5) / static_cast<double>(length)) *
           phase;
    phase *= turn;
  }
  return 4.0 * sum / static_cast<double>(length);
}

struct Line {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void add(double at, double value, double weight) {
    n += weight, x += weight * at, y += weight * value;
    xx += weight * at * at, xy += weight * at * value, yy += weight * value * value;
  }
  /// Root of the mean square distance from the line.
  [[nodiscard]] double residual() const {
    const double spread = yy / n - (y / n) * (y / n), along = xx / n - (x / n) * (x / n);
    return std::sqrt(std::max(0.0, spread - slope() * slope() * along));
  }
  [[nodiscard]] double slope() const { return (n * xy - x * y) / (n * xx - x * x); }
  [[nodiscard]] double value() const { return (y - slope() * x) / n; }
};

/// How much smaller a window sees a mode that decays while it lasts.
double seen_share(double decay_per_sample, std::size_t length) {
  double sum = 0.0;
  for (std::size_t i = 0; i < length; ++i)
    sum += hann((static_cast<double>(i) + 0.5) / static_cast<double>(length)) *
           std::exp(-decay_per_sample * static_cast<double>(i));
  return 2.0 * sum / static_cast<double>(length);
}

struct Mode {
  scene::ModeConfig config;
  double amplitude = 0.0;
};

/// Follows one mode; `apart_hz` to the nearest other one.
std::optional<Mode> follow(std::span<const float> sound, double frequency_hz, double apart_hz, double rate_hz) {
  // Four bins of the window between it and its neighbour: their side lobes are 60 dB down and fall further.
  const double wished_s = std::max({4.0 / apart_hz, 6.0 / frequency_hz, kFewestSamples / rate_hz});
  const auto length = static_cast<std::size_t>(std::min(wished_s * rate_hz, 0.5 * static_cast<double>(sound.size())));
  if (length < static_cast<std::size_t>(kFewestSamples)) return std::nullopt;
  const std::size_t hop = std::max<std::size_t>(1, length / 8);
  Mode mode;
  double slope = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    Line levels, phases;
    double first = 0.0, last_phase = 0.0, turned = 0.0, before = 0.0;
    int count = 0;
    for (std::size_t begin = 0; begin + length <= sound.size(); begin += hop) {
      const Complex value = amplitude_at(sound, frequency_hz, rate_hz, begin, length);
      const double amplitude = std::abs(value);
      if (!(amplitude > 0.0)) break;
      if (count == 0) first = amplitude;
      // Noise and echoes do not decay.
      if (amplitude < first * from_decibel(-kFollowed_db) || (count > 0 && amplitude > 1.3 * before)) break;
      before = amplitude;
      const double phase = std::arg(value);
      if (count > 0) turned += std::remainder(phase - last_phase, 2.0 * kPi);
      last_phase = phase;
      const double weight = amplitude / first;
      levels.add(static_cast<double>(begin), std::log(amplitude), weight);
      phases.add(static_cast<double>(begin), turned, weight);
      ++count;
    }
    // Noise has peaks too, which neither last nor fall evenly.
    if (count < kFewestWindows || levels.residual() > kUneven) return std::nullopt;
    slope = -levels.slope();
    if (slope * static_cast<double>(hop) * count < kLeastFall) return std::nullopt;
    frequency_hz += phases.slope() * rate_hz / (2.0 * kPi);
    if (!(slope > 0.0) || !(frequency_hz > 0.0)) return std::nullopt;
    mode.amplitude = std::exp(levels.value()) / seen_share(slope, length);
  }
  mode.config.frequency_hz = frequency_hz;
  mode.config.decay_s = kLn1000 / (slope * rate_hz);
  const bool possible = frequency_hz >= scene::kLeastFrequency_hz && frequency_hz <= scene::kMostFrequency_hz &&
                        mode.config.decay_s >= scene::kLeastDecay_s && mode.config.decay_s <= scene::kMostDecay_s;
  return possible ? std::optional(mode) : std::nullopt;
}

}  // namespace

std::vector<scene::ModeConfig> fit_modes(std::span<const float> recorded, double sample_rate_hz, std::size_t most,
                                         std::vector<double>* left_out_hz) {
  if (recorded.empty()) return {};
  const std::vector<float> sound = without_offset(recorded);
  const Begin begin = begin_of(sound, sample_rate_hz);
  if (static_cast<double>(sound.size()) < static_cast<double>(begin.ringing) + kShortest_s * sample_rate_hz) return {};
  const std::span<const float> ringing = std::span(sound).subspan(begin.ringing);
  const auto late = static_cast<double>(begin.ringing - begin.onset);
  const std::vector<Peak> peaks = peaks_of(ringing, sample_rate_hz, most);
  std::vector<Mode> modes;
  std::vector<double> lost_hz;
  for (const Peak& peak : peaks) {
    if (peak.noise) continue;
    double apart_hz = peak.frequency_hz;
    for (const Peak& other : peaks)
      if (&other != &peak) apart_hz = std::min(apart_hz, std::abs(other.frequency_hz - peak.frequency_hz));
    if (const auto mode = follow(ringing, peak.frequency_hz, apart_hz, sample_rate_hz)) {
      modes.push_back(*mode);  // as loud as it was at the onset
      modes.back().amplitude *= std::exp(kLn1000 * late / (mode->config.decay_s * sample_rate_hz));
    } else if (peak.amplitude > peaks.front().amplitude * from_decibel(kLoud_db)) {
      lost_hz.push_back(peak.frequency_hz);
    }
  }
  std::sort(modes.begin(), modes.end(), [](const Mode& a, const Mode& b) { return a.amplitude > b.amplitude; });
  std::vector<scene::ModeConfig> result;
  for (const Mode& mode : modes) {
    const bool known = std::any_of(result.begin(), result.end(), [&](const scene::ModeConfig& other) {
      return std::abs(other.frequency_hz - mode.config.frequency_hz) < 0.5 * kClosest_hz;
    });
    if (known || result.size() == most) continue;
    result.push_back(mode.config);
    result.back().level_db = to_decibel(mode.amplitude / modes.front().amplitude);
  }
  if (left_out_hz == nullptr) return result;
  for (const double lost : lost_hz) {
    const bool found = std::any_of(result.begin(), result.end(), [&](const scene::ModeConfig& mode) {
      return std::abs(mode.frequency_hz - lost) < kClosest_hz;
    });
    if (!found) left_out_hz->push_back(lost);
  }
  std::sort(left_out_hz->begin(), left_out_hz->end());
  return result;
}

}  // namespace sparsha::audio
