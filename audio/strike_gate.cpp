// Decides which touches and slides become strikes.
#include "audio/strike_gate.h"

#include <algorithm>

#include "audio/normal_force.h"

namespace sparsha::audio {
namespace {

constexpr double kSameContact_s = 0.015;
/// A border that is crossed for less is not crossed.
constexpr double kEntered_s = 0.004;
/// What is played by sliding is not played again sooner.
constexpr double kAgain_s = 0.06;
/// A hand that creeps or trembles on a border plays nothing.
constexpr double kCreeps_m_per_s = 0.008;
/// A hand of this speed plays half as loud as its press.
constexpr double kHalf_m_per_s = 0.05;

double position_along(const SoundRegion& region, double x, double y) {
  if (region.area.box() == nullptr) return 0.5;
  const scene::Area::Box& box = *region.area.box();
  const double width = box[2] - box[0], height = box[3] - box[1];
  if (!(width > 0.0) || !(height > 0.0)) return 0.5;
  return height >= width ? (y - box[1]) / height : (x - box[0]) / width;
}

}  // namespace

std::optional<Strike> StrikeGate::strike(const SoundBank& bank, const haptics::ContactEvent& event) noexcept {
  using Kind = haptics::ContactEvent::Kind;
  if (event.kind == Kind::lift) {
    touching_ = false;
    has_lifted_ = true;
    lifted_s_ = event.time_s;
  }
  if (event.kind != Kind::touch) return std::nullopt;
  const bool same = has_lifted_ && event.time_s >= lifted_s_ && event.time_s - lifted_s_ < kSameContact_s;
  const auto region = bank.region_at(event.place_m);
  touching_ = true;
  touched_s_ = event.time_s;
  if (same) return std::nullopt;
  region_ = entered_ = region;
  if (!region || !(event.peak_force_n > 0.0)) return std::nullopt;
  struck_s_ = event.time_s;
  return Strike{*region, event.peak_force_n, position_along(bank.regions[*region], event.place_m[0], event.place_m[1])};
}

std::optional<Strike> StrikeGate::slide(const SoundBank& bank, const haptics::State& state) noexcept {
  // An event tells of the touch; a state that is older than it tells of the contact before.
  if (!touching_ || state.contact == 0 || !(state.time_s > touched_s_)) return std::nullopt;
  const auto here = bank.region_at(state.place_m);
  if (here != entered_) {
    entered_ = here;
    entered_s_ = state.time_s;
  }
  if (here == region_ || state.time_s - entered_s_ < kEntered_s) return std::nullopt;
  region_ = here;
  const double speed = state.slip_speed_m_per_s;
  const bool plays =
      here && !bank.regions[*here].everywhere && speed > kCreeps_m_per_s && state.time_s - struck_s_ > kAgain_s;
  const double force_n = plays ? normal_force_n(state) * speed / (speed + kHalf_m_per_s) : 0.0;
  if (!(force_n > 0.0)) return std::nullopt;
  struck_s_ = state.time_s;
  return Strike{*here, force_n, position_along(bank.regions[*here], state.place_m[0], state.place_m[1])};
}

}  // namespace sparsha::audio
