// Frequencies, shapes and resonators of a struck pillar; see modal.h for the sources.
#include "audio/modal/modal.h"

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
/// Far below what is heard, far above denormal numbers.
constexpr double kGone = 1e-30;
constexpr std::size_t kBarPartials = 8;
constexpr std::array<double, 7> kPlateRatios = {1.0, 1.73, 2.33, 3.91, 4.11, 6.30, 6.71};
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

/// The same loudness for few modes and many.
void equalise(Modes& modes) {
  double power = 0.0;
  for (std::size_t n = 0; n < modes.count; ++n) power += modes.partials[n].gain * modes.partials[n].gain;
  for (std::size_t n = 0; n < modes.count; ++n) modes.partials[n].gain /= std::sqrt(power);
}

}  // namespace

Modes pillar_modes(const scene::ModalConfig& config, double limit_hz) {
  Modes modes;
  if (!config.modes.empty()) {
    const auto loudest =
        std::max_element(config.modes.begin(), config.modes.end(),
                         [](const auto& one, const auto& other) { return one.level_db < other.level_db; });
    for (const scene::ModeConfig& mode : config.modes)
      if (modes.count < kMaxPartials && mode.frequency_hz < limit_hz)
        modes.partials[modes.count++] = {mode.frequency_hz, mode.decay_s,
                                         from_decibel(mode.level_db - loudest->level_db)};
    equalise(modes);
    return modes;
  }
  modes.is_bar = true;
  const double first = relative_frequency(0);
  for (std::size_t n = 0; n < kBarPartials; ++n) {
    const double ratio = relative_frequency(n) / first;
    if (n > 0 && config.frequency_hz * ratio >= limit_hz) break;
    const double frequency = std::min(config.frequency_hz * ratio, limit_hz);
    modes.partials[modes.count++] = {frequency, config.decay_s / ratio, 1.0};
  }
  return modes;
}

scene::MaterialSound sound_of(const scene::MaterialSoundConfig& config) {
  scene::MaterialSound sound = scene::touch_of(config.material).sound;
  sound.frequency_hz = config.frequency_hz.value_or(sound.frequency_hz);
  sound.damping = config.damping.value_or(sound.damping);
  sound.brightness = config.brightness.value_or(sound.brightness);
  return sound;
}

Modes plate_modes(const scene::MaterialSound& sound, double limit_hz) {
  Modes modes;
  double gain = 1.0;
  for (const double ratio : kPlateRatios) {
    if (modes.count > 0 && (sound.frequency_hz * ratio >= limit_hz || !(gain > 0.0))) break;
    const double frequency = std::min(sound.frequency_hz * ratio, limit_hz);
    // exp(-pi damping f t) falls by 60 dB in ln(1000) / (pi damping f).
    const double t60_s = std::log(1000.0) / (kPi * sound.damping * frequency);
    modes.partials[modes.count++] = {frequency, std::clamp(t60_s, scene::kLeastDecay_s, scene::kMostDecay_s), gain};
    gain *= sound.brightness;
  }
  equalise(modes);
  return modes;
}

double relative_deflection(std::size_t mode, double position) {
  const double x = std::clamp(position, 0.2, 0.8);
  return deflection(mode, x) / deflection(0, x);
}

double contact_time_s(double force_n) {
  return std::clamp(0.00025 / std::cbrt(std::max(force_n, 1e-3)), 0.00005, 0.001);
}

ModalBank::ModalBank(const Modes& modes, double sample_rate_hz)
    : count_(modes.count),
      lanes_((modes.count + kLanes - 1) / kLanes * kLanes),
      is_bar_(modes.is_bar),
      sample_rate_hz_(sample_rate_hz),
      reference_hz_(modes.partials[0].frequency_hz) {
  damp_length_ = static_cast<std::size_t>(kDampTime_s * sample_rate_hz);
  for (std::size_t n = 0; n < count_; ++n) {
    gain_[n] = modes.partials[n].gain;
    const double omega = 2.0 * kPi * modes.partials[n].frequency_hz / sample_rate_hz;
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
  // The first mode reaches `amplitude` whatever the pulse's length; the pulse's spectrum shapes only what lies above.
  const double unit = amplitude / pulse_spectrum(pulse.time, 2.0 * kPi * reference_hz_ / sample_rate_hz_);
  for (std::size_t n = 0; n < count_; ++n)
    pulse.gain[n] = unit * gain_[n] * (is_bar_ ? relative_deflection(n, position) : 1.0);
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

/// `lanes[k]` of a sample gets the sum of the modes n with n mod kLanes = k, whatever the number of samples.
void ModalBank::ring(std::array<double, kLanes>* lanes, std::size_t count) noexcept {
  for (std::size_t n = 0; n < lanes_; n += kLanes) {
    std::array<double, kLanes> re{}, im{}, turn_re{}, turn_im{};
    std::copy_n(re_.begin() + static_cast<std::ptrdiff_t>(n), kLanes, re.begin());
    std::copy_n(im_.begin() + static_cast<std::ptrdiff_t>(n), kLanes, im.begin());
    std::copy_n(rotate_re_.begin() + static_cast<std::ptrdiff_t>(n), kLanes, turn_re.begin());
    std::copy_n(rotate_im_.begin() + static_cast<std::ptrdiff_t>(n), kLanes, turn_im.begin());
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        const double turned = re[k] * turn_re[k] - im[k] * turn_im[k];
        im[k] = re[k] * turn_im[k] + im[k] * turn_re[k];
        re[k] = turned;
        lanes[i][k] += turned;  // what radiates is velocity: cosine phase, no push of the air while in contact
      }
    }
    std::copy_n(re.begin(), kLanes, re_.begin() + static_cast<std::ptrdiff_t>(n));
    std::copy_n(im.begin(), kLanes, im_.begin() + static_cast<std::ptrdiff_t>(n));
  }
}

void ModalBank::press() noexcept {
  for (std::size_t p = 0; p < pulse_count_;) {
    Pulse& pulse = pulses_[p];
    const double value = (static_cast<double>(pulse.at) + 0.5) / pulse.time * pulse.decay;
    pulse.decay *= pulse.ratio;
    ++pulse.at;
    for (std::size_t n = 0; n < lanes_; ++n) re_[n] += value * pulse.gain[n];
    if (pulse.decay < kPulseEnd) {
      pulse = pulses_[--pulse_count_];
    } else {
      ++p;
    }
  }
}

void ModalBank::end() noexcept {
  re_ = {};
  im_ = {};
  pulse_count_ = damped_ = age_ = 0;
  sounding_ = damping_ = false;
}

void ModalBank::render(double* out, std::size_t count) noexcept {
  std::array<std::array<double, kLanes>, kCheckEvery> lanes;
  while (count > 0 && sounding_) {
    // Looks for silence at fixed ages, so that the sound does not depend on how time is cut into blocks.
    const std::size_t some = std::min(count, kCheckEvery - age_ % kCheckEvery);
    std::fill_n(lanes.begin(), some, std::array<double, kLanes>{});
    for (std::size_t i = 0; i < some;) {
      const bool pressed = pulse_count_ > 0;
      press();
      const std::size_t alone = pressed ? 1 : some - i;
      ring(lanes.data() + i, alone);
      i += alone;
    }
    age_ += some;
    for (std::size_t i = 0; i < some; ++i) {
      double sum = (lanes[i][0] + lanes[i][1]) + (lanes[i][2] + lanes[i][3]);
      if (damping_) sum *= fade(damped_++, damp_length_);
      out[i] += sum;
    }
    out += some;
    count -= some;
    const bool faded = damping_ && damped_ >= damp_length_;
    if (faded || (age_ % kCheckEvery == 0 && pulse_count_ == 0 && amplitude() < kSilence)) end();
  }
  // A short mode beside a long one would become denormal, which is slow.
  for (std::size_t n = 0; n < lanes_; ++n)
    if (std::abs(re_[n]) + std::abs(im_[n]) < kGone) re_[n] = im_[n] = 0.0;
}

}  // namespace sparsha::audio
