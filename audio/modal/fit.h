// The modes of a recorded strike: what `modal: {modes: [...]}` needs to sound like it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "scene/config.h"

namespace sparsha::audio {

/// At most `most` modes of one channel, by falling level; the loudest has level 0. The strike begins 50 ms before the
/// recording's loudest sample or less; what comes before it and a constant offset have no influence. Spectral peaks of
/// the first second after the onset that stand 55 dB below the highest or less, each then followed through windows long
/// enough to tell it from its neighbours: a decaying sinusoid keeps its shape under a window, so that the line through
/// the logarithms of its amplitudes is its decay, and that through its phases its frequency. Empty for silence and for
/// what does not ring.
[[nodiscard]] std::vector<pipeline::ModeConfig> fit_modes(std::span<const float> recorded, double sample_rate_hz,
                                                          std::size_t most = 16);

}  // namespace sparsha::audio
