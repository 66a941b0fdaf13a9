// How hard the stone that the hand is given presses back.
#pragma once

#include <algorithm>
#include <cstddef>

#include "haptics/state/stone_gives.h"

namespace sparsha::audio {

/// As the hand gets it: 0 in the air, in a fault, when the device has given no fresh position for too long and while
/// the governor holds the force back.
[[nodiscard]] inline double normal_force_n(const haptics::State& state) noexcept {
  if (!haptics::stone_gives(state)) return 0.0;
  double force_n = 0.0;
  for (std::size_t i = 0; i < 3; ++i) force_n += state.force_n[i] * state.normal[i];
  return std::max(0.0, force_n * state.given_share);
}

}  // namespace sparsha::audio
