// What a visitor means by the buttons of a device's grip: clicks, and buttons that are held.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "haptics/state/state.h"

namespace sparsha::haptics {

/// The grip's four buttons as seen from the front: right and left zoom, held they go to the next and previous part,
/// held for 2 s they turn the guide along an outline on; while it is on, held they end it and do nothing else; the
/// centre says where the hand is, held it helps, held for 2 s it turns speech on, for 5 s off: whoever listens to the
/// help must not lose the voice by holding on; forward drags the stone while it is held, clicked it shows the whole
/// scene. While forward is held on a whole object, a click of right or left turns it, and one of the centre tips it.
enum class Gesture {
  zoom_in,
  zoom_out,
  next_part,
  previous_part,
  describe,
  help,
  drag,
  let_go,
  whole_scene,
  speech_on,
  speech_off,
  guide,
  turn_right,
  turn_left,
  tip
};

/// Session's thread only.
class Buttons {
 public:
  /// What has been done since the last call, in the order of the buttons. Clicks count when the button is let go; a
  /// button that goes with its device is no click.
  [[nodiscard]] std::vector<Gesture> read(const State& state);

 private:
  struct Button {
    std::uint64_t presses = 0;  ///< seen
    bool down = false;
    bool held = false;         ///< long enough, and said so
    bool held_longer = false;  ///< likewise
    bool held_longest = false;
    double since_s = 0.0;
  };
  std::array<Button, 4> buttons_{};
  double fresh_s_ = 0.0;  ///< of the last state that knew the hand
};

}  // namespace sparsha::haptics
