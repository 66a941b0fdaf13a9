// One period of a recording, repeated: the way the pillars of Hampi were sounded by Aniyath et al. 2014.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "audio/clip/clip.h"
#include "audio/modal/fit.h"
#include "base/error.h"
#include "base/numbers/smooth_step.h"
#include "scene/material/sound_limits.h"

namespace sparsha::audio {
namespace {

constexpr double kAttack_s = 0.03;  // what the strike adds before the note stands
constexpr double kLowest_hz = 40.0;
constexpr double kHighest_hz = 4000.0;
constexpr double kJudged_s = 0.25;  // of the note
constexpr double kAlike = 0.9;      // of the best correlation: the shortest period that repeats as well
constexpr double kHeard_db = 35.0;
constexpr double kLook_s = 0.02;
constexpr double kQuietest_db = 80.0;
constexpr double kLongest_s = 10.0;
constexpr double kRise_s = 0.0005;
constexpr double kNear_octaves = 0.3;  // of a mode's pitch from that of the zero crossings
constexpr double kSoftest_db = -15.0;  // of a mode that counts
constexpr double kMultiple = 0.1;      // of the pitch: as far a partial may be from a multiple
constexpr double kBlended = 0.25;      // of the period

double value_at(const std::vector<double>& x, double at) {  // cubic through four samples
  const auto i = static_cast<std::ptrdiff_t>(std::floor(at));
  const double t = at - static_cast<double>(i);
  const auto sample = [&](std::ptrdiff_t k) {
    return x[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, static_cast<std::ptrdiff_t>(x.size()) - 1))];
  };
  const double a = sample(i - 1), b = sample(i), c = sample(i + 1), d = sample(i + 2);
  return b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)));
}

/// Lag at which the sound is most like itself, samples.
std::size_t rough_period(const std::vector<double>& x, std::size_t begin, std::size_t length, double rate_hz) {
  const auto shortest = static_cast<std::size_t>(rate_hz / kHighest_hz);
  const std::size_t longest = std::min(length / 2, static_cast<std::size_t>(rate_hz / kLowest_hz));
  std::vector<double> alike(longest + 2, 0.0);
  double best = 0.0;
  for (std::size_t lag = shortest; lag <= longest; ++lag) {
    double product = 0.0, own = 0.0, other = 0.0;
    for (std::size_t i = begin; i + lag < begin + length; ++i) {
      product += x[i] * x[i + lag];
      own += x[i] * x[i];
      other += x[i + lag] * x[i + lag];
    }
    alike[lag] = own > 0.0 && other > 0.0 ? product / std::sqrt(own * other) : 0.0;
    // The slope down from lag 0 is no peak.
    if (lag > shortest && alike[lag] > best && alike[lag] >= alike[lag - 1]) best = alike[lag];
  }
  for (std::size_t lag = shortest + 1; lag < longest; ++lag)
    if (alike[lag] > kAlike * best && alike[lag] >= alike[lag - 1] && alike[lag] >= alike[lag + 1]) return lag;
  return 0;
}

/// Places where the sound rises through zero, between samples.
std::vector<double> rising_zeros(const std::vector<double>& x, std::size_t begin, std::size_t end) {
  std::vector<double> zeros;
  for (std::size_t i = begin; i + 1 < end; ++i)
    if (x[i] < 0.0 && x[i + 1] >= 0.0) zeros.push_back(static_cast<double>(i) + x[i] / (x[i] - x[i + 1]));
  return zeros;
}

double nearest(const std::vector<double>& zeros, double at) {
  return *std::min_element(zeros.begin(), zeros.end(),
                           [&](double a, double b) { return std::abs(a - at) < std::abs(b - at); });
}

/// Follows the like crossing from period to period: what `count` periods take.
double followed_period(const std::vector<double>& zeros, double first, double period, std::size_t& count) {
  double last = first;
  count = 0;
  while (last + 1.5 * period < zeros.back()) {
    const double next = nearest(zeros, last + period);
    if (std::abs(next - last - period) > 0.1 * period) break;
    last = next;
    ++count;
    period = (last - first) / static_cast<double>(count);
  }
  return period;
}

/// Of the loudest mode near a period's pitch: partials that are no multiples of it move zero crossings by a semitone
/// and more. Without such a mode the period as it is.
double tuned_period(const std::vector<scene::ModeConfig>& modes, double period, double rate_hz) {
  for (const scene::ModeConfig& mode : modes) {
    const double of_mode = rate_hz / mode.frequency_hz;
    if (mode.level_db > kSoftest_db && std::abs(std::log2(of_mode / period)) < kNear_octaves) return of_mode;
  }
  return period;
}

/// A sound whose partials are no multiples of a pitch may be most like itself after several periods of the lowest: that
/// one's period, in samples. 0 where the lag is one period.
double period_of_lowest(const std::vector<scene::ModeConfig>& modes, std::size_t lag, double rate_hz) {
  const double pitch_hz = rate_hz / static_cast<double>(lag);
  double lowest_hz = HUGE_VAL;
  bool multiples = true;
  for (const scene::ModeConfig& mode : modes) {
    if (mode.level_db <= kSoftest_db) continue;
    lowest_hz = std::min(lowest_hz, mode.frequency_hz);
    const double multiple = mode.frequency_hz / pitch_hz;
    multiples = multiples && std::abs(multiple - std::round(multiple)) < kMultiple;
  }
  return !multiples && lowest_hz > 1.5 * pitch_hz ? rate_hz / lowest_hz : 0.0;
}

double rms(const std::vector<double>& x, std::size_t begin, std::size_t length) {
  double sum = 0.0;
  for (std::size_t i = begin; i < std::min(x.size(), begin + length); ++i) sum += x[i] * x[i];
  return std::sqrt(sum / static_cast<double>(length));
}

/// Where the note has fallen by kHeard_db, looked at every kLook_s: what follows is silence or the noise of the place.
std::size_t end_of_decay(const std::vector<double>& x, std::size_t begin, double rate_hz) {
  const auto block = static_cast<std::size_t>(kLook_s * rate_hz);
  const double least = rms(x, begin, block) * std::pow(10.0, -kHeard_db / 20.0);
  for (std::size_t at = begin + block; at + block <= x.size(); at += block)
    if (rms(x, at, block) < least) return at;
  return x.size();
}

}  // namespace

Clip loop_one_period(const Clip& clip, int sample_rate_hz, const std::string& name) {
  const double rate_hz = sample_rate_hz;
  std::vector<double> x(clip.frames());
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = 0.5 * (static_cast<double>(clip.samples[2 * i]) + static_cast<double>(clip.samples[2 * i + 1]));
    sum += x[i];
  }
  // Without the constant that a recorder adds, which does not decay.
  const double mean = x.empty() ? 0.0 : sum / static_cast<double>(x.size());
  double largest = 0.0;
  std::size_t loudest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] -= mean;
    if (std::abs(x[i]) > largest) largest = std::abs(x[i]), loudest = i;
  }
  const auto refuse = [&](const char* why) {
    return input_error(name, std::string("no single period can be cut from the clip: ") + why,
                       "a recorded note of 0.1 s or more");
  };
  const std::size_t begin = loudest + static_cast<std::size_t>(kAttack_s * rate_hz);
  if (begin + static_cast<std::size_t>(0.06 * rate_hz) > x.size()) throw refuse("it is too short");
  const std::size_t length = std::min(x.size() - begin, static_cast<std::size_t>(kJudged_s * rate_hz));
  const std::vector<scene::ModeConfig> modes = fit_modes(std::vector<float>(x.begin(), x.end()), rate_hz);
  const std::size_t lag = rough_period(x, begin, length, rate_hz);
  const std::vector<double> zeros = rising_zeros(x, begin, begin + length);
  if (lag == 0 || zeros.size() < 3) throw refuse("it has no pitch");
  const double of_lowest = period_of_lowest(modes, lag, rate_hz);
  const double rough = of_lowest > 0.0 ? of_lowest : static_cast<double>(lag);
  // Of the crossings of one period the steepest tells its place best.
  double first = zeros.front();
  for (const double zero : zeros) {
    if (zero > zeros.front() + rough) break;
    const auto steep = [&](double at) { return value_at(x, at + 0.5) - value_at(x, at - 0.5); };
    if (steep(zero) > steep(first)) first = zero;
  }
  double period = of_lowest;
  if (!(period > 0.0)) {
    std::size_t count = 0;
    const double followed = followed_period(zeros, first, rough, count);
    period = tuned_period(modes, followed, rate_hz);
    // A mode tells the period where other partials move the crossings.
    if (count == 0 && period == followed) throw refuse("no two zero crossings of like slope are a period apart");
  }
  // Decay from the first to the last quarter of the time in which the note is heard.
  const std::size_t quarter = (end_of_decay(x, begin, rate_hz) - begin) / 4;
  if (static_cast<double>(quarter) < period) throw refuse("it ends within four periods");
  const double early = rms(x, begin, quarter), late = rms(x, begin + 3 * quarter, quarter);
  double decay = late > 0.0 && early > late ? std::log(early / late) / static_cast<double>(3 * quarter) : 0.0;
  decay = std::clamp(decay, std::log(1000.0) / (scene::kMostDecay_s * rate_hz),
                     std::log(1000.0) / (scene::kLeastDecay_s * rate_hz));
  const double frames = std::min(kLongest_s * rate_hz, kQuietest_db / 20.0 * std::log(10.0) / decay);
  const double gain = std::exp(decay * (first - static_cast<double>(loudest)));
  Clip looped;
  looped.samples.reserve(2 * static_cast<std::size_t>(frames));
  const double fade_from = frames - 0.02 * rate_hz;
  for (double i = 0.0; i < frames; i += 1.0) {
    const double phase = std::fmod(i, period);
    // The period's own decay is taken out, so that its end meets its beginning.
    double value = value_at(x, first + phase) * std::exp(decay * phase);
    // Partials that are no multiples of the pitch do not come back after a period: its end fades into what was before
    // it.
    const double blend = (phase / period - 1.0 + kBlended) / kBlended;
    if (blend > 0.0) {
      const double before = value_at(x, first + phase - period) * std::exp(decay * (phase - period));
      value += smooth_step(blend) * (before - value);
    }
    const double rise = std::min(1.0, i / (kRise_s * rate_hz));
    const double end = i > fade_from ? std::max(0.0, (frames - 1.0 - i) / (frames - fade_from)) : 1.0;
    const auto sample = static_cast<float>(gain * value * std::exp(-decay * i) * rise * end);
    looped.samples.insert(looped.samples.end(), {sample, sample});
  }
  return looped;
}

}  // namespace sparsha::audio
