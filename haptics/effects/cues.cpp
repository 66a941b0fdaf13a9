#include "haptics/effects/cues.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace sparsha::haptics {
namespace {

using scene::Cue;

constexpr double kSilence_s = 1.0;  // the same thing is told of again only after so long an absence, as words are
constexpr double kDecay_per_s = 120.0;
constexpr double kTick_s = 0.040;  // then nothing is left of it
constexpr double kMostCyclesPerTick = 0.3;
constexpr double kSameScale = 0.01;  // views that differ less are the same one
// One for each cue, between what a hand tells apart and what slow loops render.
constexpr std::array<double, scene::kCues> kFrequencies_hz{120.0, 90.0, 70.0, 160.0, 110.0};

}  // namespace

void Cues::reset() noexcept {
  tick_s_ = -1.0;
  scale_ = 0.0;
}

bool Cues::begins(Watched& watched, bool now, double time_s) noexcept {
  const bool begins = now && !watched.now && time_s - watched.last_s > kSilence_s;
  if (now) watched.last_s = time_s;
  watched.now = now;
  return begins;
}

void Cues::tell(Cue cue, const SurfaceEffects& effects) noexcept {
  const auto index = static_cast<std::size_t>(cue);
  ++counts_[index];
  if (!effects.cues->tick[index]) return;
  tick_s_ = 0.0;
  tick_hz_ = kFrequencies_hz[index];
}

// As words are said of parts, and with the same patience at their borders.
void Cues::watch_parts(const Input& input, const SurfaceEffects& effects) noexcept {
  constexpr double kWellInside_m = 0.002;  // from a border, at the hand
  const Eigen::Vector2d place_m = input.place_m.head<2>();
  const double margin_m = kWellInside_m / input.scale;
  const auto part_at = [&](const Eigen::Vector2d& at_m) -> std::optional<std::size_t> {
    const std::size_t part = effects.part_at({at_m.x(), at_m.y(), input.place_m.z()});
    return part == SurfaceEffects::kNoPart ? std::nullopt : std::optional<std::size_t>(part);
  };
  if (parts_.watch(place_m, margin_m, input.time_s, part_at))
    tell(Cue::part_entered, effects);
  else if (parts_.left(place_m, margin_m, input.time_s, part_at))
    tell(Cue::part_left, effects);
}

void Cues::watch(const Input& input, const SurfaceEffects& effects) noexcept {
  const bool other_view = scale_ > 0.0 && std::abs(input.scale - scale_) > kSameScale * scale_;
  scale_ = input.scale;
  if (other_view) tell(Cue::level, effects);
  const bool fallen = !input.contact && unknown_.now;  // off the stone, and has not come back since
  if (!input.contact && !fallen) return;
  if (input.contact) watch_parts(input, effects);
  if (begins(outside_, input.outside, input.time_s)) tell(Cue::edge, effects);
  if (begins(unknown_, input.unknown && !input.outside, input.time_s)) tell(Cue::unmeasured, effects);
}

double Cues::tick(const Input& input) noexcept {
  if (tick_s_ < 0.0) return 0.0;
  const double frequency_hz = std::min(tick_hz_, kMostCyclesPerTick / input.pace_s);
  const double t = tick_s_ + 0.5 * input.pace_s;
  tick_s_ += std::min(input.period_s, input.pace_s);
  if (tick_s_ > kTick_s) tick_s_ = -1.0;
  const double force_n = kTick_n * std::exp(-kDecay_per_s * t) * std::sin(2.0 * std::numbers::pi * frequency_hz * t);
  return input.contact ? std::max(force_n, -input.pressed_n) : force_n;
}

Eigen::Vector3d Cues::update(const Input& input, const SurfaceEffects* effects) noexcept {
  if (effects == nullptr || !effects->cues) {
    tick_s_ = -1.0;
    return Eigen::Vector3d::Zero();
  }
  watch(input, *effects);
  const double force_n = tick(input);
  return force_n * (input.contact ? input.normal : Eigen::Vector3d::UnitZ());
}

}  // namespace sparsha::haptics
