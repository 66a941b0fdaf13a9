// The work of the sound card's callback.
#include "audio/live/voice.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

namespace sparsha::audio {
namespace {

/// A strike that waited longer than this (the device was still being opened) is not played: its touch is over.
constexpr double kTooLate_s = 0.1;
/// Without a state of the servo for so long there is no sound of stroking.
constexpr double kServoSilent_s = 0.05;
constexpr double kFade_s = 0.02;
constexpr float kDucked = 0.25F;  // 12 dB
/// Words begin when all else is at most this loud: 0.3 kCeiling and the loudest word, 0.6, stay below full scale.
constexpr float kDuckedEnough = 0.3F;
constexpr float kWhole = 0.9999F;
constexpr double kDuck_s = 0.03;
constexpr double kCut_s = 0.01;
constexpr double kClocksApart_s = 0.05;
constexpr double kClockShare = 0.02;

}  // namespace

LiveVoice::LiveVoice(std::shared_ptr<const SoundBank> bank, haptics::ContactQueue& contacts,
                     const haptics::Seqlock<haptics::State>& state, haptics::ContactQueue* forward,
                     std::atomic<std::uint64_t>& strikes)
    : synth_(std::move(bank)), contacts_(contacts), state_(state), forward_(forward), strikes_(strikes) {}

void LiveVoice::listen(std::size_t frames) noexcept {
  haptics::State now;
  bool fresh = false;
  for (int attempt = 0; attempt < 8 && !fresh; ++attempt) fresh = state_.try_read(now);
  if (fresh && now.tick != last_.tick) {
    last_ = now;
    silent_frames_ = 0;
  } else {
    silent_frames_ += frames;
  }
  const bool moved = silent_frames_ == 0;
  if (static_cast<double>(silent_frames_) > kServoSilent_s * synth_.sample_rate_hz()) synth_.lift(synth_.frame());
  std::shared_ptr<const Profile> profile;
  while (profiles_.pop(profile)) synth_.profile(std::move(profile), synth_.frame());

  haptics::ContactEvent event;
  while (contacts_.pop(event)) {
    if (last_.time_s - event.time_s <= kTooLate_s && synth_.contact(event, synth_.frame()))
      strikes_.fetch_add(1, std::memory_order_relaxed);
    if (forward_ != nullptr) forward_->push(event);
  }
  if (moved && synth_.state(last_, frame_of(last_.time_s, frames))) strikes_.fetch_add(1, std::memory_order_relaxed);
}

/// Servo and card clocks differ; their smoothed difference places a state one block later.
std::uint64_t LiveVoice::frame_of(double time_s, std::size_t block) noexcept {
  const double now = time_s * synth_.sample_rate_hz();
  const double wanted = static_cast<double>(synth_.frame() + block) - now;
  if (!has_clock_ || std::abs(wanted - clock_frames_) > kClocksApart_s * synth_.sample_rate_hz())
    clock_frames_ = wanted;
  has_clock_ = true;
  clock_frames_ += kClockShare * (wanted - clock_frames_);
  return static_cast<std::uint64_t>(std::max(static_cast<double>(synth_.frame()), std::round(now + clock_frames_)));
}

/// Words wait, 80 ms at most, until the other sounds are soft enough: together they never reach full scale.
void LiveVoice::add_speech(std::span<float> interleaved) noexcept {
  const auto duck_share = static_cast<float>(1.0 - std::exp(-1.0 / (kDuck_s * synth_.sample_rate_hz())));
  const auto cut_step = static_cast<float>(1.0 / (kCut_s * synth_.sample_rate_hz()));
  while (words_.pop(next_words_)) newer_words_ = true;  // whoever gave them keeps a share
  for (std::size_t i = 0; i + 1 < interleaved.size(); i += 2) {
    if (newer_words_ && (speech_gain_ == 0.0F || !spoken_)) {
      newer_words_ = false;
      spoken_ = std::move(next_words_);
      spoken_frames_ = 0;
      speech_gain_ = 1.0F;
    }
    const bool speaks = spoken_ && spoken_frames_ < spoken_->frames() && speech_gain_ > 0.0F;
    duck_ += duck_share * ((speaks ? kDucked : 1.0F) - duck_);
    if (!speaks && duck_ > kWhole) duck_ = 1.0F;
    interleaved[i] *= duck_;
    interleaved[i + 1] *= duck_;
    if (!speaks) {
      spoken_.reset();
      continue;
    }
    if (newer_words_) speech_gain_ = std::max(0.0F, speech_gain_ - cut_step);
    if (spoken_frames_ == 0 && duck_ > kDuckedEnough) continue;
    interleaved[i] += speech_gain_ * spoken_->samples[2 * spoken_frames_];
    interleaved[i + 1] += speech_gain_ * spoken_->samples[2 * spoken_frames_ + 1];
    ++spoken_frames_;
  }
}

void LiveVoice::render(std::span<float> interleaved) noexcept {
  listen(interleaved.size() / 2);
  synth_.render(interleaved);
  add_speech(interleaved);
  if (!ending_.load(std::memory_order_relaxed)) return;
  const auto step = static_cast<float>(1.0 / (kFade_s * synth_.sample_rate_hz()));
  for (std::size_t i = 0; i + 1 < interleaved.size(); i += 2) {
    interleaved[i] *= fade_;
    interleaved[i + 1] *= fade_;
    fade_ = std::max(0.0F, fade_ - step);
  }
  if (fade_ == 0.0F) ended_.store(true, std::memory_order_release);
}

void LiveVoice::fade_out() noexcept {
  ending_.store(true, std::memory_order_relaxed);
  for (int i = 0; i < 50 && !ended_.load(std::memory_order_acquire); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

}  // namespace sparsha::audio
