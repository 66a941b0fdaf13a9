// Touches into strikes.
#include "audio/strike_gate.h"

namespace sparsha::audio {
namespace {

constexpr double kSameContact_s = 0.015;

double position_along(const std::array<double, 4>& box, double x, double y) {
  const double width = box[2] - box[0], height = box[3] - box[1];
  if (!(width > 0.0) || !(height > 0.0)) return 0.5;
  return height >= width ? (y - box[1]) / height : (x - box[0]) / width;
}

}  // namespace

std::optional<Strike> StrikeGate::strike(const SoundBank& bank, const haptics::ContactEvent& event) noexcept {
  using Kind = haptics::ContactEvent::Kind;
  if (event.kind == Kind::lift) {
    has_lifted_ = true;
    lifted_s_ = event.time_s;
  }
  if (event.kind != Kind::touch || !(event.peak_force_n > 0.0)) return std::nullopt;
  if (has_lifted_ && event.time_s >= lifted_s_ && event.time_s - lifted_s_ < kSameContact_s) return std::nullopt;
  const auto region = bank.region_at(event.place_m[0], event.place_m[1]);
  if (!region) return std::nullopt;
  return Strike{*region, event.peak_force_n,
                position_along(*bank.regions[*region].box_m, event.place_m[0], event.place_m[1])};
}

}  // namespace sparsha::audio
