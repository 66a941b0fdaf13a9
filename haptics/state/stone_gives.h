// Whether the stone under the hand gives it a force.
#pragma once

#include "haptics/state/state.h"

namespace sparsha::haptics {

/// The hand is on stone that gives it a force. One that begins inside the stone, or comes back from a fault or a gap,
/// is in contact without a force until it has been in the air; pictures, sounds and words go by what it gets.
[[nodiscard]] inline bool stone_gives(const State& state) noexcept {
  return state.contact != 0 && state.given_share > 0.0 && (state.flags & kFlagFault) == 0;
}

}  // namespace sparsha::haptics
