// Which contact events and which movements are strikes, and of what.
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
/// the same contact (a hand that flutters on the surface). A hand that slides onto another region plays it too, once it
/// has been there for 4 ms, as loud as press and speed make it. No allocation.
class StrikeGate {
 public:
  [[nodiscard]] std::optional<Strike> strike(const SoundBank& bank, const haptics::ContactEvent& event) noexcept;
  /// Of the newest state; what comes out happened at its time.
  [[nodiscard]] std::optional<Strike> slide(const SoundBank& bank, const haptics::State& state) noexcept;

 private:
  bool touching_ = false;
  double touched_s_ = 0.0;
  bool has_lifted_ = false;
  double lifted_s_ = 0.0;
  std::optional<std::size_t> region_;   ///< under the hand, as far as it has been played
  std::optional<std::size_t> entered_;  ///< under the hand for a moment
  double entered_s_ = 0.0;
  double struck_s_ = 0.0;
};

}  // namespace sparsha::audio
