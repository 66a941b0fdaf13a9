// What rings when it is struck: a pillar (the bending modes of a bar held at both ends), a piece of some material
// (those of a free plate), or modes as they were measured; rung by a contact pulse.
//
// Frequencies of a pillar: Timoshenko's correction of the clamped-clamped Euler-Bernoulli bar (Fletcher & Rossing 1998,
// ch. 2), so the partials are inharmonic and closer than the bar's 1 : 2.76 : 5.40. Decay: structural damping with one
// loss factor for all modes, hence T60 proportional to 1/f (van den Doel & Pai 1998). Strike: a raised-cosine pulse
// whose length shrinks with force as a finger pad stiffens (felt-hammer law, Hall & Askenfelt 1988), so harder is
// brighter.
#pragma once

#include <array>
#include <cstddef>

#include "scene/config/audio.h"
#include "scene/material/sound_limits.h"

namespace sparsha::audio {

inline constexpr std::size_t kMaxPartials = scene::kMostModes;

/// One damped sinusoid. `t60_s` is the time to fall by 60 dB.
struct Partial {
  double frequency_hz = 0.0;
  double t60_s = 0.0;
  double gain = 1.0;  ///< amplitude relative to the others
};

/// Modes below a limit. The first is the reference: a strike's amplitude is its amplitude at gain 1.
struct Modes {
  std::array<Partial, kMaxPartials> partials{};
  std::size_t count = 0;
  bool is_bar = false;  ///< the place that is struck shapes the partials
};
/// Of a pillar (at most eight), whose fundamental has the configured frequency and T60; or those that are listed.
[[nodiscard]] Modes pillar_modes(const scene::ModalConfig& config, double limit_hz);
/// Of a free round plate (Fletcher & Rossing 1998, table 3.2) with the material's loss factor for all modes. Together
/// they are as loud as one mode of gain 1.
[[nodiscard]] Modes plate_modes(const scene::MaterialSound& sound, double limit_hz);
/// The table's, with what the configuration changes.
[[nodiscard]] scene::MaterialSound sound_of(const scene::MaterialSoundConfig& config);

/// Deflection of mode n (from 0) of a clamped-clamped bar at `position` (0 to 1 along it), relative to the
/// fundamental's there. `position` is kept within 0.2 to 0.8, where the fundamental speaks.
[[nodiscard]] double relative_deflection(std::size_t mode, double position);

/// Time constant tau of a strike's contact pulse, seconds: 0.25 ms at 1 N, proportional to force^(-1/3), within 0.05 to
/// 1 ms.
[[nodiscard]] double contact_time_s(double force_n);

/// The resonators of one struck thing. Striking it again adds to what still rings, as on the real thing: no voice is
/// ever cut. No allocation; one thread.
class ModalBank {
 public:
  ModalBank() = default;
  ModalBank(const Modes& modes, double sample_rate_hz);

  /// Begins a contact pulse at the next sample. `amplitude` is what the first mode reaches at gain 1. Returns false
  /// when kMaxPulses pulses are still in contact.
  bool strike(double amplitude, double force_n, double position) noexcept;
  /// Fades what rings within 5 ms, as a hand laid on the stone would.
  void damp() noexcept { damping_ = true; }

  [[nodiscard]] bool sounding() const noexcept { return sounding_; }
  [[nodiscard]] bool damped() const noexcept { return damping_; }
  /// True while a pulse is in contact.
  [[nodiscard]] bool struck() const noexcept { return pulse_count_ > 0; }
  /// Sum of the partials' present amplitudes.
  [[nodiscard]] double amplitude() const noexcept;
  /// Adds `count` samples to `out`.
  void render(double* out, std::size_t count) noexcept;

 private:
  static constexpr std::size_t kMaxPulses = 8;
  struct Pulse {
    std::size_t at = 0;
    double time = 0.0;   ///< tau in samples
    double decay = 0.0;  ///< exp(-t/tau) at the present sample
    double ratio = 0.0;  ///< exp(-1/tau)
    std::array<double, kMaxPartials> gain{};
  };

  static constexpr std::size_t kLanes = 4;  ///< modes that are computed side by side

  static constexpr std::size_t kCheckEvery = 64;  ///< samples

  void ring(std::array<double, kLanes>* lanes, std::size_t count) noexcept;
  void press() noexcept;
  void end() noexcept;

  std::size_t count_ = 0;
  std::size_t lanes_ = 0;  ///< count_, rounded up; the modes beyond it are zeros
  bool is_bar_ = false;
  double sample_rate_hz_ = 48000.0;
  std::size_t damp_length_ = 0;
  std::size_t age_ = 0;     ///< samples since it began to sound
  std::size_t damped_ = 0;  ///< samples since damp()
  bool damping_ = false;
  bool sounding_ = false;
  std::size_t pulse_count_ = 0;
  std::array<Pulse, kMaxPulses> pulses_{};
  std::array<double, kMaxPartials> gain_{};
  double reference_hz_ = 0.0;
  std::array<double, kMaxPartials> rotate_re_{}, rotate_im_{};  ///< r e^{i theta} a sample
  std::array<double, kMaxPartials> re_{}, im_{};
};

}  // namespace sparsha::audio
