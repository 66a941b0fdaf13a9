// Places what is heard at a servo time at the matching frame of the file.
#include "audio/wav/sink.h"

#include <algorithm>
#include <cmath>

namespace sparsha::audio {
namespace {

constexpr double kBehind_s = 0.25;
constexpr double kLongestTail_s = 5.0;
constexpr double kFade_s = 0.05;
constexpr std::size_t kBlockFrames = 1024;

}  // namespace

WavSink::WavSink(const std::shared_ptr<const SoundBank>& bank, const std::filesystem::path& target, int bits)
    : synth_(bank), writer_(target, bank->sample_rate_hz, bits) {
  block_.resize(2 * kBlockFrames);
}

std::uint64_t WavSink::frame_of(double time_s) const {
  return static_cast<std::uint64_t>(std::llround(std::max(0.0, time_s) * synth_.sample_rate_hz()));
}

bool WavSink::contact(const haptics::ContactEvent& event) { return synth_.contact(event, frame_of(event.time_s)); }

bool WavSink::state(const haptics::State& state) {
  if (has_state_ && state.tick == last_tick_) return false;
  has_state_ = true;
  last_tick_ = state.tick;
  const bool strikes = synth_.state(state, frame_of(state.time_s));
  if (state.time_s > kBehind_s) render_until(frame_of(state.time_s - kBehind_s));
  return strikes;
}

void WavSink::profile(std::shared_ptr<const Profile> profile, double time_s) {
  synth_.profile(std::move(profile), frame_of(time_s));
}

void WavSink::render_until(std::uint64_t frame) {
  // The limiter's look-ahead is dropped, so that frame 0 of the file is time 0.
  if (synth_.frame() == 0 && frame > 0) synth_.render(std::span(block_.data(), 2 * Synth::latency_frames()));
  while (writer_.frames() < frame) {
    const std::span<float> block(block_.data(), 2 * std::min<std::uint64_t>(kBlockFrames, frame - writer_.frames()));
    synth_.render(block);
    writer_.write(block);
  }
}

void WavSink::finish(double end_s) {
  const std::uint64_t end = static_cast<std::uint64_t>(std::ceil(std::max(0.0, end_s) * synth_.sample_rate_hz()));
  synth_.lift(end);
  render_until(end);
  const auto rate = static_cast<double>(synth_.sample_rate_hz());
  const auto most = writer_.frames() + static_cast<std::uint64_t>(kLongestTail_s * rate);
  const auto fade = static_cast<std::uint64_t>(kFade_s * rate);
  while (synth_.sounding() && writer_.frames() < most) {
    const std::uint64_t first = writer_.frames();
    const std::span<float> block(block_.data(), 2 * std::min<std::uint64_t>(kBlockFrames, most - first));
    synth_.render(block);
    for (std::size_t i = 0; i < block.size(); ++i) {
      const std::uint64_t left = most - (first + i / 2);
      if (left <= fade) block[i] *= static_cast<float>(left - 1) / static_cast<float>(fade);
    }
    writer_.write(block);
  }
  writer_.commit();
}

}  // namespace sparsha::audio
