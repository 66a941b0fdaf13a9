// Which contact events are strikes, and of what.
#pragma once

#include <cstddef>
#include <optional>

#include "audio/sound_bank.h"
#include "haptics/state/state.h"

namespace sparsha::audio {

/// A region struck. `position`: where along the pillar (the longer side of its box), 0 to 1.
struct Strike {
  std::size_t region = 0;
  double force_n = 0.0;  ///< predicted peak
  double position = 0.5;
};

/// A touch strikes the first region under the proxy, once a contact; a touch within 15 ms of the last lift continues
/// the same contact (a hand that flutters on the surface). No allocation.
class StrikeGate {
 public:
  [[nodiscard]] std::optional<Strike> strike(const SoundBank& bank, const haptics::ContactEvent& event) noexcept;

 private:
  bool has_lifted_ = false;
  double lifted_s_ = 0.0;
};

}  // namespace sparsha::audio
