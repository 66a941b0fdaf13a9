// Turns changes of State into events at their times, and events into notes.
#include "audio/earcons.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace sparsha::audio {
namespace {

using scene::Cue;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kAttack_s = 0.006;

/// A note that glides from one pitch to another and flutters so many times a second.
struct Note {
  double begin_s = 0.0, length_s = 0.0;
  double from_hz = 0.0, to_hz = 0.0;
  double flutter_hz = 0.0;
};
/// The figure of each kind but the beep; a length of 0 is no note.
using Figure = std::array<Note, 2>;
constexpr std::array<Figure, 6> kFigures{{
    {{{0.0, 0.16, 392.0, 784.0, 0.0}, {}}},                                 // closer
    {{{0.0, 0.16, 784.0, 392.0, 0.0}, {}}},                                 // farther
    {{{0.0, 0.05, 220.0, 220.0, 0.0}, {0.09, 0.05, 220.0, 220.0, 0.0}}},    // edge
    {{{0.0, 0.24, 330.0, 330.0, 30.0}, {}}},                                // unmeasured
    {{{0.0, 0.07, 880.0, 880.0, 0.0}, {0.08, 0.10, 1175.0, 1175.0, 0.0}}},  // entered
    {{{0.0, 0.07, 1175.0, 1175.0, 0.0}, {0.08, 0.10, 880.0, 880.0, 0.0}}},  // left
}};
/// Small loudspeakers lose low fundamentals; these keep the pitch. Their sum, at worst, is full level.
constexpr std::array<double, 3> kPartials{0.70, 0.20, 0.10};

constexpr double kBeep_s = 0.07;
/// A beep as far as this or farther, and one at the stone: once in so many seconds, so high.
constexpr double kFar_m = 0.1;
constexpr double kFarPause_s = 0.7, kNearPause_s = 0.14;
constexpr double kFarPitch_hz = 262.0, kNearPitch_hz = 524.0;

/// Rises and falls as half a cosine: neither a step nor a corner.
double envelope(double at_s, double length_s) {
  const double fall_s = length_s - kAttack_s;
  const double share = at_s < kAttack_s ? at_s / kAttack_s : (length_s - at_s) / fall_s;
  return 0.5 - 0.5 * std::cos(0.5 * kTurn * std::clamp(share, 0.0, 1.0));
}

double sounds(const Note& note, double at_s) {
  const double t = at_s - note.begin_s;
  if (t < 0.0 || t >= note.length_s) return 0.0;
  const double phase = kTurn * (note.from_hz * t + 0.5 * (note.to_hz - note.from_hz) * t * t / note.length_s);
  double sum = 0.0;
  for (std::size_t n = 0; n < kPartials.size(); ++n) sum += kPartials[n] * std::sin(static_cast<double>(n + 1) * phase);
  const double flutter = note.flutter_hz > 0.0 ? 0.5 - 0.5 * std::cos(kTurn * note.flutter_hz * t) : 1.0;
  return flutter * envelope(t, note.length_s) * sum;
}

double length_s(const Figure& figure) {
  double end_s = 0.0;
  for (const Note& note : figure) end_s = std::max(end_s, note.begin_s + note.length_s);
  return end_s;
}

double near(double away_m) { return 1.0 - std::clamp(away_m / kFar_m, 0.0, 1.0); }

}  // namespace

Earcons::Earcons(const std::optional<scene::CuesConfig>& config, int sample_rate_hz)
    : config_(config), step_s_(1.0 / sample_rate_hz) {}

/// What has been counted since the last state, as bits of Kind.
std::uint32_t Earcons::told(const haptics::State& state) noexcept {
  std::uint32_t begins = 0;
  const auto begin = [&](Kind kind) { begins |= 1U << static_cast<unsigned>(kind); };
  for (std::size_t cue = 0; cue < scene::kCues; ++cue) {
    if (state.cues[cue] <= counts_[cue] || !config_->sound[cue]) continue;
    switch (static_cast<Cue>(cue)) {
      case Cue::level:
        begin(state.scale >= scale_ ? Kind::level_closer : Kind::level_farther);
        break;
      case Cue::edge:
        begin(Kind::edge);
        break;
      case Cue::unmeasured:
        begin(Kind::unmeasured);
        break;
      case Cue::part_entered:
        begin(Kind::part_entered);
        break;
      case Cue::part_left:
        begin(Kind::part_left);
        break;
    }
  }
  counts_ = state.cues;
  scale_ = state.scale;
  return begins;
}

/// Whether the hand is lost: far from the stone for a while, and not at rest.
bool Earcons::loses(const haptics::State& state) noexcept {
  constexpr std::uint64_t kNoHand = haptics::kFlagStale | haptics::kFlagFault | haptics::kFlagDragged;
  double moved_m = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    moved_m = std::max(moved_m, std::abs(state.device_m[axis] - rests_at_m_[axis]));
  if (moved_m > kRests_m) {
    rests_at_m_ = state.device_m;
    moved_s_ = state.time_s;
  }
  const bool hand = (state.flags & haptics::kFlagArmed) != 0 && (state.flags & kNoHand) == 0;
  const bool away = config_->lost && hand && state.contact == 0 &&
                    state.away_m > (told_lost_ ? kFound_m : kLost_m);  // also infinitely far: nothing known in view
  if (away && !away_) away_since_s_ = state.time_s;
  away_ = away;
  return away && state.time_s - away_since_s_ >= kLostFor_s && state.time_s - moved_s_ < kRests_s;
}

void Earcons::push(const Event& event) noexcept {
  if (waiting_ == kMostEvents) {  // so much is never behind; what it began is kept, its distance is old
    events_[(first_ + 1) % kMostEvents].begins |= events_[first_].begins;
    first_ = (first_ + 1) % kMostEvents;
    --waiting_;
  }
  events_[(first_ + waiting_) % kMostEvents] = event;
  ++waiting_;
}

void Earcons::leave(std::uint64_t frame) noexcept {
  away_ = false;
  if (std::exchange(told_lost_, false)) push({.frame = frame});
}

void Earcons::state(const haptics::State& state, std::uint64_t frame) noexcept {
  if (!config_) return;
  if (!seen_) {
    seen_ = true;
    counts_ = state.cues;
    scale_ = state.scale;
    rests_at_m_ = state.device_m;
    moved_s_ = state.time_s;
  }
  const std::uint32_t begins = told(state);
  const bool lost = loses(state);
  const bool news = begins != 0 || lost || told_lost_;
  told_lost_ = lost;
  if (news) push({frame, begins, lost, state.away_m});
}

/// One that still sounds goes on: it has told of the same thing a moment ago.
void Earcons::begin(Kind kind, double pitch_hz) noexcept {
  Voice& voice = voices_[static_cast<std::size_t>(kind)];
  if (voice.playing) return;
  voice = {true, 0.0, pitch_hz};
  ++playing_;
}

void Earcons::take(const Event& event) noexcept {
  for (std::size_t kind = 0; kind < kKinds; ++kind)
    if ((event.begins >> kind & 1U) != 0) begin(static_cast<Kind>(kind));
  if (event.lost && !lost_) next_beep_s_ = 0.0;
  lost_ = event.lost;
  away_m_ = event.away_m;
}

void Earcons::render(double* out, std::size_t count, std::uint64_t frame) noexcept {
  for (std::size_t i = 0; i < count && sounding(); ++i) {
    for (; waiting_ > 0 && events_[first_].frame <= frame + i; --waiting_) {
      take(events_[first_]);
      first_ = (first_ + 1) % kMostEvents;
    }
    if (lost_) {
      // The pause that the distance asks for, from the last beep on: it shortens at once when the hand comes nearer.
      if (next_beep_s_ <= 0.0) {
        begin(Kind::beep, kFarPitch_hz * std::pow(kNearPitch_hz / kFarPitch_hz, near(away_m_)));
        next_beep_s_ = 1.0;
      }
      next_beep_s_ -= step_s_ / (kFarPause_s * std::pow(kNearPause_s / kFarPause_s, near(away_m_)));
    }
    double sum = 0.0;
    for (std::size_t kind = 0; playing_ > 0 && kind < kKinds; ++kind) {
      Voice& voice = voices_[kind];
      if (!voice.playing) continue;
      const bool beep = static_cast<Kind>(kind) == Kind::beep;
      if (beep) {
        sum += sounds({0.0, kBeep_s, voice.pitch_hz, voice.pitch_hz, 0.0}, voice.at_s);
      } else {
        for (const Note& note : kFigures[kind]) sum += sounds(note, voice.at_s);
      }
      voice.at_s += step_s_;
      if (voice.at_s < (beep ? kBeep_s : length_s(kFigures[kind]))) continue;
      voice.playing = false;
      --playing_;
    }
    out[i] += kLevel * sum;
  }
}

}  // namespace sparsha::audio
