// Frequencies, shapes and resonators of a struck pillar; see modal.h for the sources.
#include "audio/modal.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "audio/decibel.h"

namespace sparsha::audio {
namespace {

constexpr double kPi = std::numbers::pi;
/// Radius of gyration over length of a round pillar ten times as long as thick.
constexpr double kGyration = 0.025;
/// E / (kappa G) of stone: Poisson's ratio 0.2, shear coefficient 0.9 (round section).
constexpr double kShear = 2.0 * (1.0 + 0.2) / 0.9;
/// -140 dB full scale: below this a pillar is silent.
constexpr double kSilence = 1e-7;
constexpr double kDampTime_s = 0.005;
/// exp(-20): a pulse's end that nobody hears.
constexpr double kPulseEnd = 2e-9;

/// Wavenumber times length of mode n (from 0) of a clamped-clamped bar: roots of cos x cosh x = 1.
double wavenumber(std::size_t mode) {
  double x = (static_cast<double>(mode) + 1.5) * kPi;
  for (int i = 0; i < 8; ++i) {  // Newton on cos x - 1/cosh x
    const double sech = 1.0 / std::cosh(x);
    x -= (std::cos(x) - sech) / (-std::sin(x) + sech * std::tanh(x));
  }
  return x;
}

/// Frequency of mode n up to a constant factor.
double relative_frequency(std::size_t mode) {
  const double k = wavenumber(mode);
  const double slender = k * kGyration;
  return k * k / std::sqrt(1.0 + slender * slender * (1.0 + kShear));
}

double deflection(std::size_t mode, double position) {
  const double k = wavenumber(mode);
  const double sigma = (std::cosh(k) - std::cos(k)) / (std::sinh(k) - std::sin(k));
  const double x = k * std::min(position, 1.0 - position);  // the near half: cosh and sinh of the far one cancel badly
  const double sign = position > 0.5 && mode % 2 == 1 ? -1.0 : 1.0;
  return sign * (std::cosh(x) - std::cos(x) - sigma * (std::sinh(x) - std::sin(x)));
}

/// |sum over n of (n + 1/2)/time * exp(-(n + 1/2)/time) e^{-i omega n}|, a geometric sum and its derivative.
double pulse_spectrum(double time, double omega) {
  const std::complex<double> q = std::polar(std::exp(-1.0 / time), -omega);
  return std::abs(q / ((1.0 - q) * (1.0 - q)) + 0.5 / (1.0 - q)) * std::exp(-0.5 / time) / time;
}

}  // namespace

PillarModes pillar_modes(const pipeline::ModalConfig& config, double limit_hz) {
  PillarModes modes;
  const double first = relative_frequency(0);
  for (std::size_t n = 0; n < kMaxPartials; ++n) {
    const double ratio = relative_frequency(n) / first;
    const double frequency = config.frequency_hz * ratio;
    if (n > 0 && frequency >= limit_hz) break;
    modes.partials[modes.count++] = {frequency, config.decay_s / ratio};
  }
  return modes;
}

double relative_deflection(std::size_t mode, double position) {
  const double x = std::clamp(position, 0.2, 0.8);
  return deflection(mode, x) / deflection(0, x);
}

double contact_time_s(double force_n) {
  return std::clamp(0.00025 / std::cbrt(std::max(force_n, 1e-3)), 0.00005, 0.001);
}

ModalBank::ModalBank(const PillarModes& modes, double sample_rate_hz)
    : count_(modes.count), sample_rate_hz_(sample_rate_hz) {
  damp_length_ = static_cast<std::size_t>(kDampTime_s * sample_rate_hz);
  for (std::size_t n = 0; n < count_; ++n) {
    frequency_hz_[n] = modes.partials[n].frequency_hz;
    const double omega = 2.0 * kPi * frequency_hz_[n] / sample_rate_hz;
    const double radius = std::pow(1e-3, 1.0 / (modes.partials[n].t60_s * sample_rate_hz));
    rotate_re_[n] = radius * std::cos(omega);
    rotate_im_[n] = radius * std::sin(omega);
  }
}

bool ModalBank::strike(double amplitude, double force_n, double position) noexcept {
  if (pulse_count_ == kMaxPulses || count_ == 0) return false;
  Pulse& pulse = pulses_[pulse_count_++];
  pulse.at = 0;
  pulse.time = contact_time_s(force_n) * sample_rate_hz_;
  pulse.ratio = std::exp(-1.0 / pulse.time);
  pulse.decay = std::exp(-0.5 / pulse.time);
  // The fundamental reaches `amplitude` whatever the pulse's length; the pulse's spectrum shapes only what lies above.
  const double unit = amplitude / pulse_spectrum(pulse.time, 2.0 * kPi * frequency_hz_[0] / sample_rate_hz_);
  for (std::size_t n = 0; n < count_; ++n) pulse.gain[n] = unit * relative_deflection(n, position);
  if (damping_) {  // goes on from where the fade has come
    const double left = fade(damped_, damp_length_);
    for (std::size_t n = 0; n < count_; ++n) {
      re_[n] *= left;
      im_[n] *= left;
    }
    damping_ = false;
    damped_ = 0;
  }
  sounding_ = true;
  return true;
}

double ModalBank::amplitude() const noexcept {
  double sum = 0.0;
  for (std::size_t n = 0; n < count_; ++n) sum += std::hypot(re_[n], im_[n]);
  return sum;
}

void ModalBank::render(double* out, std::size_t count) noexcept {
  if (!sounding_) return;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t p = 0; p < pulse_count_;) {
      Pulse& pulse = pulses_[p];
      const double value = (static_cast<double>(pulse.at) + 0.5) / pulse.time * pulse.decay;
      pulse.decay *= pulse.ratio;
      ++pulse.at;
      for (std::size_t n = 0; n < kMaxPartials; ++n) re_[n] += value * pulse.gain[n];
      if (pulse.decay < kPulseEnd) {
        pulse = pulses_[--pulse_count_];
      } else {
        ++p;
      }
    }
    double sum = 0.0;
    for (std::size_t n = 0; n < kMaxPartials; ++n) {
      const double re = re_[n] * rotate_re_[n] - im_[n] * rotate_im_[n];
      im_[n] = re_[n] * rotate_im_[n] + im_[n] * rotate_re_[n];
      re_[n] = re;
      sum += re;  // what radiates is velocity: cosine phase, no push of the air while in contact
    }
    if (damping_) sum *= fade(damped_++, damp_length_);
    out[i] += sum;
    const bool faded = damping_ && damped_ >= damp_length_;
    if (faded || (pulse_count_ == 0 && std::abs(sum) < kSilence && amplitude() < kSilence)) {
      re_ = {};
      im_ = {};
      pulse_count_ = damped_ = 0;
      sounding_ = damping_ = false;
      return;
    }
  }
}

}  // namespace sparsha::audio
