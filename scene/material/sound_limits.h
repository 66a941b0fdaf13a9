// What a note may be: the same for a configuration that is read and for one that is played.
#pragma once

namespace sparsha::scene {

inline constexpr double kLeastFrequency_hz = 10.0;
inline constexpr double kMostFrequency_hz = 16000.0;  ///< a card below 36 kHz plays the first mode lower, others not
inline constexpr double kLeastDecay_s = 0.005;        ///< the time to fall by 60 dB
inline constexpr double kMostDecay_s = 60.0;
inline constexpr int kMostModes = 32;
inline constexpr double kLeastDamping = 1e-5;  ///< loss factor
inline constexpr double kMostDamping = 1.0;

}  // namespace sparsha::scene
