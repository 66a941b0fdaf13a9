// Clips through libsndfile.
#include "audio/clip/clip.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <system_error>

#include <sndfile.h>

#include "audio/decibel.h"
#include "base/error.h"

namespace sparsha::audio {
namespace {

constexpr double kLongest_s = 600.0;
constexpr double kFade_s = 0.005;
constexpr float kSilent = 0.001F;  // a step to silence that is no click
constexpr const char* kExpected = "a mono or stereo sound file (WAV, FLAC, Ogg, AIFF)";

struct CloseSound {
  void operator()(SNDFILE* file) const { sf_close(file); }
};

}  // namespace

Clip load_clip(const std::filesystem::path& file, int sample_rate_hz) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(file, status))
    throw input_error(file.string(), std::filesystem::exists(file, status) ? "not a regular file" : "no such file",
                      kExpected);
  SF_INFO info{};
  const std::unique_ptr<SNDFILE, CloseSound> sound(sf_open(file.c_str(), SFM_READ, &info));
  if (!sound) throw input_error(file.string(), std::string("cannot read the clip: ") + sf_strerror(nullptr), kExpected);
  if (info.channels < 1 || info.channels > 2)
    throw input_error(file.string(), "the clip has " + std::to_string(info.channels) + " channels", "one or two");
  if (info.samplerate < 1000 || info.samplerate > 768000)
    throw input_error(file.string(), "impossible sample rate " + std::to_string(info.samplerate) + " Hz", kExpected);

  // The header's length may be wrong: read block by block and count what comes.
  const auto channels = static_cast<std::size_t>(info.channels);
  const auto most = static_cast<std::size_t>(kLongest_s * info.samplerate) * channels;
  std::vector<float> samples;
  std::vector<float> block(65536 * channels);
  for (;;) {
    const sf_count_t got = sf_readf_float(sound.get(), block.data(), 65536);
    if (got <= 0) break;
    samples.insert(samples.end(), block.begin(), block.begin() + got * info.channels);
    if (samples.size() > most) throw input_error(file.string(), "the clip is longer than 10 minutes", "a short sound");
  }
  if (sf_error(sound.get()) != SF_ERR_NO_ERROR)
    throw input_error(file.string(), std::string("the clip is damaged: ") + sf_strerror(sound.get()), kExpected);
  if (samples.empty()) throw input_error(file.string(), "the clip is empty", kExpected);
  const auto read = static_cast<sf_count_t>(samples.size() / channels);
  if (info.seekable != 0 && info.frames > 0 && read < info.frames)
    throw input_error(
        file.string(),
        "the clip is cut short: " + std::to_string(read) + " of " + std::to_string(info.frames) + " frames", kExpected);
  for (const float value : samples)
    if (!std::isfinite(value)) throw input_error(file.string(), "the clip holds values that are not finite", kExpected);

  samples = resample(samples, info.channels, info.samplerate, sample_rate_hz);
  Clip clip;
  if (channels == 2) {
    clip.samples = std::move(samples);
  } else {
    clip.samples.reserve(2 * samples.size());
    for (const float value : samples) clip.samples.insert(clip.samples.end(), {value, value});
  }
  return clip;
}

void end_softly(Clip& clip, int sample_rate_hz) {
  const std::size_t frames = clip.frames();
  if (frames == 0) return;
  if (std::abs(clip.samples[2 * frames - 2]) <= kSilent && std::abs(clip.samples[2 * frames - 1]) <= kSilent) return;
  const std::size_t length = std::min(frames / 2, static_cast<std::size_t>(kFade_s * sample_rate_hz));
  for (std::size_t k = 0; k < length; ++k) {
    const auto gain = static_cast<float>(fade(length - 1 - k, length));
    clip.samples[2 * (frames - 1 - k)] *= gain;
    clip.samples[2 * (frames - 1 - k) + 1] *= gain;
  }
}

}  // namespace sparsha::audio
