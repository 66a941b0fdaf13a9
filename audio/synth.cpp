// Turns contact events into voices, and mixes the voices into frames.
#include "audio/synth.h"

#include <algorithm>
#include <cmath>

#include "audio/normal_force.h"

namespace sparsha::audio {
namespace {

/// No denormal number leaves.
float audible(double value) { return std::abs(value) < 1e-30 ? 0.0F : static_cast<float>(value); }

}  // namespace

Synth::Synth(std::shared_ptr<const SoundBank> bank)
    : bank_(std::move(bank)),
      clips_(bank_->sample_rate_hz),
      needle_(*bank_),
      earcons_(bank_->cues, bank_->sample_rate_hz),
      limiter_(kCeiling, bank_->sample_rate_hz) {
  pillars_.resize(bank_->regions.size());
  ringing_.reserve(bank_->regions.size());
  for (std::size_t i = 0; i < pillars_.size(); ++i)
    if (const auto* modes = std::get_if<Modes>(&bank_->regions[i].sound))
      pillars_[i] = ModalBank(*modes, bank_->sample_rate_hz);
}

bool Synth::contact(const haptics::ContactEvent& event, std::uint64_t frame) noexcept {
  const auto strike_now = gate_.strike(*bank_, event);
  return strike_now && strike(*strike_now, frame);
}

bool Synth::strike(const Strike& strike, std::uint64_t frame) noexcept { return schedule({frame, strike}); }

bool Synth::state(const haptics::State& state, std::uint64_t frame) noexcept {
  if (bank_->scrape_gain > 0.0) {
    Needle::Point point;
    point.frame = frame;
    point.press_n = normal_force_n(state);
    point.touching = point.press_n > 0.0 && state.scale > 0.0;
    const bool around = (state.flags & haptics::kFlagAround) != 0;
    point.place_m = {state.proxy_m[0], state.proxy_m[1], around ? state.proxy_m[2] : 0.0};
    point.scale = state.scale;
    const auto region = bank_->region_at(state.place_m);
    point.sound = region ? bank_->regions[*region].scrape : 0;
    needle_.move(point);
  }
  earcons_.state(state, frame);
  const auto slides = gate_.slide(*bank_, state);
  return slides && strike(*slides, frame);
}

void Synth::profile(std::shared_ptr<const Profile> profile, std::uint64_t frame) noexcept {
  needle_.set_profile(std::move(profile), frame);
}

bool Synth::schedule(const Event& event) noexcept {
  if (event_count_ == kMostEvents) {
    ++dropped_;
    return false;
  }
  std::size_t at = event_count_++;
  for (; at > 0 && events_[at - 1].frame > event.frame; --at) events_[at] = events_[at - 1];
  events_[at] = event;
  return true;
}

void Synth::begin(const Event& event) noexcept {
  const Strike& strike = event.strike;
  const double level = strike_level(strike.force_n);
  if (const auto* clip = std::get_if<std::shared_ptr<const Clip>>(&bank_->regions[strike.region].sound)) {
    if (!clips_.start(**clip, std::min(1.0, kClipLevel * level))) ++dropped_;
    return;
  }
  ModalBank& pillar = pillars_[strike.region];
  const bool rang = pillar.sounding();
  if (!pillar.strike(kStruckLevel * level, strike.force_n, strike.position)) {
    ++dropped_;
    return;
  }
  // In order of regions, so that sums do not depend on how time is cut into blocks; the capacity is reserved.
  const auto region = static_cast<std::uint32_t>(strike.region);
  if (!rang) ringing_.insert(std::lower_bound(ringing_.begin(), ringing_.end(), region), region);
  limit_banks();
}

void Synth::limit_banks() noexcept {
  std::size_t open = 0;
  ModalBank* quietest = nullptr;
  double least = 0.0;
  for (const std::uint32_t region : ringing_) {
    ModalBank& pillar = pillars_[region];
    if (pillar.damped()) continue;
    ++open;
    if (pillar.struck()) continue;
    const double amplitude = pillar.amplitude();
    if (quietest == nullptr || amplitude < least) {
      quietest = &pillar;
      least = amplitude;
    }
  }
  if (open > kMostBanks && quietest != nullptr) quietest->damp();
}

void Synth::render_block(float* out, std::size_t count) noexcept {
  std::array<double, kBlock> left{}, right{};
  for (std::size_t r = 0; r < ringing_.size();) {
    ModalBank& pillar = pillars_[ringing_[r]];
    pillar.render(left.data(), count);
    if (pillar.sounding()) {
      ++r;
    } else {
      ringing_.erase(ringing_.begin() + static_cast<std::ptrdiff_t>(r));
    }
  }
  needle_.render(left.data(), count, frame_);
  earcons_.render(left.data(), count, frame_);
  right = left;  // what is struck and stroked is in the middle
  clips_.render(left.data(), right.data(), count);
  for (std::size_t i = 0; i < count; ++i) {
    const Limiter::Frame frame = limiter_.process({left[i], right[i]});
    out[2 * i] = audible(frame.left);
    out[2 * i + 1] = audible(frame.right);
  }
  frame_ += count;
  if (!ringing_.empty() || clips_.sounding() || needle_.sounding() || earcons_.sounding()) last_sound_ = frame_;
}

bool Synth::sounding() const noexcept {
  return event_count_ > 0 || !ringing_.empty() || clips_.sounding() || needle_.sounding() || earcons_.sounding() ||
         frame_ < last_sound_ + kBlock + latency_frames();
}

void Synth::render(std::span<float> interleaved) noexcept {
  const std::size_t frames = interleaved.size() / 2;
  std::size_t done = 0;
  while (done < frames) {
    std::size_t ready = 0;
    for (; ready < event_count_ && events_[ready].frame <= frame_; ++ready) begin(events_[ready]);
    if (ready > 0) {
      std::copy(events_.begin() + static_cast<std::ptrdiff_t>(ready),
                events_.begin() + static_cast<std::ptrdiff_t>(event_count_), events_.begin());
      event_count_ -= ready;
    }
    std::size_t count = std::min(frames - done, kBlock);
    if (event_count_ > 0) count = std::min<std::uint64_t>(count, events_[0].frame - frame_);
    render_block(interleaved.data() + 2 * done, count);
    done += count;
  }
}

}  // namespace sparsha::audio
