// The modes of a recorded strike: what `modal: {modes: [...]}` needs to sound like it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "scene/config/audio.h"

namespace sparsha::audio {

/// At most `most` modes of one channel, by falling level; the loudest has level 0. The strike begins 50 ms before the
/// recording's loudest sample or less; what comes before it and a constant offset have no influence. Spectral peaks of
/// the first second after the onset that stand 55 dB below the highest or less, each then followed through windows long
/// enough to tell it from its neighbours: a decaying sinusoid keeps its shape under a window, so that the line through
/// the logarithms of its amplitudes is its decay, and that through its phases its frequency. Empty for silence and for
/// what does not ring. Two modes that beat with each other, less than 7 Hz or some 9 decays apart (9 / the seconds in
/// which they fall by 60 dB), do not fall evenly and are not found; `left_out_hz` gets the frequencies of such peaks
/// that are within 20 dB of the loudest, by rising frequency.
[[nodiscard]] std::vector<scene::ModeConfig> fit_modes(std::span<const float> recorded, double sample_rate_hz,
                                                       std::size_t most = 16,
                                                       std::vector<double>* left_out_hz = nullptr);

}  // namespace sparsha::audio
