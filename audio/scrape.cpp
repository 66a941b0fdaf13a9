// Noise through a state-variable band-pass (trapezoidal integrators, Zavalishin 2012: stable while its centre moves).
#include "audio/scrape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sparsha::audio {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kGrain_m = 80e-6;
constexpr double kLowest_hz = 200.0;
constexpr double kHighest_hz = 8000.0;
constexpr double kQuality = 0.8;  ///< centre over bandwidth
/// Root-mean-square level of a brisk stroke at gain 1 (-26 dB full scale), and that stroke's dissipated power: friction
/// 0.5, 2 N, 0.1 m/s.
constexpr double kReferenceLevel = 0.05;
constexpr double kReferencePower_w = 0.1;
/// Even frictionless skin on stone is heard a little.
constexpr double kLeastFriction = 0.05;
/// Loudest scrape: 8 dB above the reference.
constexpr double kMostLevel = 2.5;
constexpr double kLevelGlide_s = 0.008;
constexpr double kFrequencyGlide_s = 0.015;
constexpr double kSilence = 1e-6;
constexpr std::uint32_t kRetuneEvery = 16;  ///< frames

}  // namespace

Scrape::Scrape(double gain, double sample_rate_hz)
    : gain_(gain),
      sample_rate_hz_(sample_rate_hz),
      level_glide_(1.0 - std::exp(-1.0 / (kLevelGlide_s * sample_rate_hz))),
      frequency_glide_(1.0 - std::exp(-static_cast<double>(kRetuneEvery) / (kFrequencyGlide_s * sample_rate_hz))),
      target_frequency_hz_(kLowest_hz),
      frequency_hz_(kLowest_hz) {}

void Scrape::set(const ScrapeInput& input) noexcept {
  const double power = (kLeastFriction + std::max(0.0, input.friction_coefficient)) *
                       std::max(0.0, input.normal_force_n) * std::max(0.0, input.speed_m_per_s);
  const double relative = std::min(std::sqrt(power / kReferencePower_w), kMostLevel);
  if (!(relative > 0.0)) {  // at rest, in the air, or not a number
    target_level_ = 0.0;
    return;
  }
  target_level_ = gain_ * kReferenceLevel * relative;
  target_frequency_hz_ = std::clamp(input.speed_m_per_s / kGrain_m, kLowest_hz, kHighest_hz);
  if (level_ == 0.0) frequency_hz_ = target_frequency_hz_;
}

double Scrape::noise() noexcept {  // xorshift64*, uniform with variance 1
  random_ ^= random_ >> 12U;
  random_ ^= random_ << 25U;
  random_ ^= random_ >> 27U;
  const auto bits = static_cast<std::int64_t>(random_ * 0x2545F4914F6CDD1DU) >> 11;
  return static_cast<double>(bits) * (std::numbers::sqrt3 / 4503599627370496.0);
}

void Scrape::retune() noexcept {
  frequency_hz_ += frequency_glide_ * (target_frequency_hz_ - frequency_hz_);
  warped_ = std::tan(kPi * frequency_hz_ / sample_rate_hz_);
  // White noise of variance 1 fills half the sample rate; the band's noise bandwidth is pi/2 of its width.
  normalise_ = std::sqrt(0.5 * sample_rate_hz_ / (0.5 * kPi * frequency_hz_ / kQuality));
}

double Scrape::next() noexcept {
  if (!sounding()) return 0.0;
  if (until_retune_ == 0) {
    until_retune_ = kRetuneEvery;
    retune();
  }
  --until_retune_;
  level_ += level_glide_ * (target_level_ - level_);
  if (target_level_ == 0.0 && level_ < kSilence) {
    level_ = state_1_ = state_2_ = 0.0;
    until_retune_ = 0;
    return 0.0;
  }
  const double damping = 1.0 / kQuality;
  const double in = noise();
  const double high = (in - (damping + warped_) * state_1_ - state_2_) / (1.0 + warped_ * (damping + warped_));
  const double band = warped_ * high + state_1_;
  state_1_ = 2.0 * warped_ * high + state_1_;
  state_2_ = 2.0 * warped_ * band + state_2_;
  return level_ * normalise_ * damping * band;
}

}  // namespace sparsha::audio
