// Where too many clips sound, the quietest one fades out within 5 ms, so that no click is heard.
#include "audio/clip/player.h"

#include <algorithm>
#include <cmath>

#include "audio/decibel.h"

namespace sparsha::audio {
namespace {

constexpr double kFade_s = 0.005;
/// Loudness of a voice is judged over what it is about to play.
constexpr std::size_t kJudgedFrames = 64;

double loudness(const Clip& clip, std::size_t at, double gain) {
  const std::size_t end = std::min(clip.frames(), at + kJudgedFrames);
  double energy = 0.0;
  for (std::size_t i = 2 * at; i < 2 * end; ++i)
    energy += static_cast<double>(clip.samples[i]) * static_cast<double>(clip.samples[i]);
  return energy * gain * gain;
}

}  // namespace

ClipPlayer::ClipPlayer(double sample_rate_hz) : fade_length_(static_cast<std::size_t>(kFade_s * sample_rate_hz)) {}

bool ClipPlayer::start(const Clip& clip, double gain) noexcept {
  if (active_ == voices_.size()) return false;
  std::size_t sounding = 0;
  Voice* quietest = nullptr;
  double least = 0.0;
  for (std::size_t i = 0; i < active_; ++i) {
    Voice& voice = voices_[i];
    if (voice.fading) continue;
    ++sounding;
    const double energy = loudness(*voice.clip, voice.at, voice.gain);
    if (quietest == nullptr || energy < least) {
      quietest = &voice;
      least = energy;
    }
  }
  if (sounding >= kSounding) quietest->fading = true;
  voices_[active_++] = {&clip, 0, gain, false, 0};
  return true;
}

void ClipPlayer::render(double* left, double* right, std::size_t count) noexcept {
  for (std::size_t v = 0; v < active_;) {
    Voice& voice = voices_[v];
    const std::size_t frames = std::min(count, voice.clip->frames() - voice.at);
    const float* in = voice.clip->samples.data() + 2 * voice.at;
    for (std::size_t i = 0; i < frames; ++i) {
      const double gain = voice.fading ? voice.gain * fade(voice.faded++, fade_length_) : voice.gain;
      left[i] += gain * static_cast<double>(in[2 * i]);
      right[i] += gain * static_cast<double>(in[2 * i + 1]);
    }
    voice.at += frames;
    if (voice.at == voice.clip->frames() || voice.faded >= fade_length_) {
      // Order is kept, so that sums do not depend on how time is cut into blocks.
      std::copy(voices_.begin() + static_cast<std::ptrdiff_t>(v) + 1,
                voices_.begin() + static_cast<std::ptrdiff_t>(active_),
                voices_.begin() + static_cast<std::ptrdiff_t>(v));
      --active_;
    } else {
      ++v;
    }
  }
}

}  // namespace sparsha::audio
