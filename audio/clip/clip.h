// A recorded sound in memory, at the rate of the stream it is played on.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace sparsha::audio {

/// Interleaved stereo; a mono file fills both channels.
struct Clip {
  std::vector<float> samples;
  [[nodiscard]] std::size_t frames() const { return samples.size() / 2; }
};

/// Reads any file that libsndfile reads (mono or stereo, at most 10 minutes) and resamples it to `sample_rate_hz`; at
/// the file's own rate samples stay as they are. Throws Error{input} with the file and the reason.
[[nodiscard]] Clip load_clip(const std::filesystem::path& file, int sample_rate_hz);

/// Fades the last 5 ms, at most half of the clip, when it stops while it still sounds: a cut would click.
void end_softly(Clip& clip, int sample_rate_hz);

/// A note made of one period of the clip, cut between zero crossings of like slope 30 ms or more after its loudest
/// moment, and repeated with the clip's own decay (10 s at most). The last quarter of the period fades into what was
/// before the period, so that partials which are no multiples of the pitch make no step. The pitch is that of the
/// periods there, of the loudest mode near it, or, where the sound repeats only after several periods of its lowest
/// mode, of that mode. Throws Error{input} that names `name` when there is no such period.
[[nodiscard]] Clip loop_one_period(const Clip& clip, int sample_rate_hz, const std::string& name);

/// Band-limited resampling of interleaved frames with linear phase (libsoxr's "very high quality": 28 bits, pass band
/// to 0.95 of the lower Nyquist frequency). ceil(frames * to / from) frames come back. Throws Error{failure}.
[[nodiscard]] std::vector<float> resample(const std::vector<float>& samples, int channels, double from_hz,
                                          double to_hz);

}  // namespace sparsha::audio
