// The callback's work.
#include "audio/live_voice.h"

#include <algorithm>
#include <chrono>
#include <thread>

namespace sparsha::audio {
namespace {

/// A strike that waited longer than this (the device was still being opened) would be a ghost.
constexpr double kTooLate_s = 0.1;
/// A servo that says nothing for this long scrapes nothing.
constexpr double kServoSilent_s = 0.05;
constexpr double kFade_s = 0.02;

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
  const bool gone = static_cast<double>(silent_frames_) > kServoSilent_s * synth_.sample_rate_hz();
  synth_.scrape(gone ? ScrapeInput{} : scrape_input(last_), synth_.frame());

  haptics::ContactEvent event;
  while (contacts_.pop(event)) {
    if (last_.time_s - event.time_s <= kTooLate_s && synth_.contact(event, synth_.frame()))
      strikes_.fetch_add(1, std::memory_order_relaxed);
    if (forward_ != nullptr) forward_->push(event);
  }
}

void LiveVoice::render(std::span<float> interleaved) noexcept {
  listen(interleaved.size() / 2);
  synth_.render(interleaved);
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
