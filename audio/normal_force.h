// How hard the stone that the hand is given presses back.
#pragma once

#include <algorithm>
#include <cstddef>

#include "haptics/state/state.h"

namespace sparsha::audio {

/// As the hand gets it: 0 in the air, in a fault, while the device gives no fresh position and while the governor holds
/// the force back.
[[nodiscard]] inline double normal_force_n(const haptics::State& state) noexcept {
  constexpr std::uint64_t kSilent = haptics::kFlagStale | haptics::kFlagFault;
  if (state.contact == 0 || (state.flags & kSilent) != 0) return 0.0;
  double force_n = 0.0;
  for (std::size_t i = 0; i < 3; ++i) force_n += state.force_n[i] * state.normal[i];
  return std::max(0.0, force_n * state.given_share);
}

}  // namespace sparsha::audio
