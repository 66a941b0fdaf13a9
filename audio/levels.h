// Levels of all sounds: the one place where strikes and strokes are weighed against each other.
#pragma once

#include <algorithm>

namespace sparsha::audio {

/// Amplitude of the first mode of a strike of 1 N, and a clip's gain for it, relative to full scale.
inline constexpr double kStruckLevel = 0.235;
inline constexpr double kClipLevel = 0.25;
/// Root mean square that the roughest stroke with 1 N stays below, at friction_sound's default gain and, times
/// kMostStrokeGain, at any: 6 dB under the first 50 ms of the shortest of all strikes.
inline constexpr double kStrokeLevel = 0.026;
inline constexpr double kMostStrokeGain = 1.4;
/// A force beyond this sounds no louder.
inline constexpr double kLoudest_n = 20.0;

/// Amplitude of a strike relative to one of 1 N: proportional to its peak force, as a linear body answers an impulse.
[[nodiscard]] inline double strike_level(double force_n) { return force_n > 0.0 ? std::min(force_n, kLoudest_n) : 0.0; }

}  // namespace sparsha::audio
