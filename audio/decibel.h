// Decibels, amplitudes, and the fade that nobody hears.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>

namespace sparsha::audio {

/// Amplitude ratio of a level in dB.
[[nodiscard]] inline double from_decibel(double decibel) { return std::pow(10.0, decibel / 20.0); }
/// Level of an amplitude ratio in dB; minus infinity for 0.
[[nodiscard]] inline double to_decibel(double amplitude) { return 20.0 * std::log10(std::abs(amplitude)); }

/// Half a cosine from 1 (at 0) to 0 (at `length` and beyond): neither a step nor a corner.
[[nodiscard]] inline double fade(std::size_t at, std::size_t length) {
  if (at >= length) return 0.0;
  return 0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(at) / static_cast<double>(length));
}

}  // namespace sparsha::audio
