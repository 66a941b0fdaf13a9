#include "haptics/session/buttons.h"

#include <cstddef>
#include <optional>

namespace sparsha::haptics {
namespace {

struct Meaning {
  Gesture click;
  Gesture hold;
  double hold_s;  ///< pressed for so long it is held
  std::optional<Gesture> release;
  std::optional<Gesture> hold_longer;
  std::optional<Gesture> hold_longest;
};

constexpr double kLong_s = 2.0, kLongest_s = 5.0;
/// Without a fresh sample for so long, a button that is up was not let go: the device has gone.
constexpr double kGone_s = 0.05;

// Right, forward, centre, left: bits 0 to 3 of State::buttons, from the front of a Falcon's grip.
constexpr std::array<Meaning, 4> kMeanings{
    {{Gesture::zoom_in, Gesture::next_part, 0.6, {}, Gesture::guide, {}},
     {Gesture::whole_scene, Gesture::drag, 0.2, Gesture::let_go, {}, {}},
     {Gesture::describe, Gesture::help, 0.8, {}, Gesture::speech_on, Gesture::speech_off},
     {Gesture::zoom_out, Gesture::previous_part, 0.6, {}, Gesture::guide, {}}}};

constexpr std::size_t kForward = 1;
/// Clicks on a whole object while forward is held.
constexpr std::array<std::optional<Gesture>, 4> kTurns{
    {Gesture::turn_right, std::nullopt, Gesture::tip, Gesture::turn_left}};

}  // namespace

std::vector<Gesture> Buttons::read(const State& state) {
  std::vector<Gesture> gestures;
  if ((state.flags & kFlagStale) == 0) fresh_s_ = state.time_s;
  const bool turns = (state.flags & kFlagAround) != 0 && (state.buttons >> kForward & 1U) != 0;
  const bool gone = state.time_s - fresh_s_ > kGone_s;
  for (std::size_t k = 0; k < buttons_.size(); ++k) {
    Button& button = buttons_[k];
    const Meaning& meaning = kMeanings[k];
    const bool down = (state.buttons >> k & 1U) != 0;
    // A contact that bounces between two looks is one press; one that came and went between them is a click.
    const bool pressed = state.button_presses[k] != button.presses;
    button.presses = state.button_presses[k];
    if (pressed && !button.down) button = {button.presses, true, false, false, false, state.time_s};
    if (!button.down) continue;
    if (!down) {
      if (!button.held && !gone)
        gestures.push_back(turns ? kTurns[k].value_or(meaning.click) : meaning.click);
      else if (button.held && meaning.release)
        gestures.push_back(*meaning.release);
      button.down = false;
    } else if (!button.held && state.time_s - button.since_s >= meaning.hold_s) {
      button.held = true;
      gestures.push_back(meaning.hold);
    }
    if (down && meaning.hold_longer && !button.held_longer && state.time_s - button.since_s >= kLong_s) {
      button.held_longer = true;
      gestures.push_back(*meaning.hold_longer);
    }
    if (down && meaning.hold_longest && !button.held_longest && state.time_s - button.since_s >= kLongest_s) {
      button.held_longest = true;
      gestures.push_back(*meaning.hold_longest);
    }
  }
  return gestures;
}

}  // namespace sparsha::haptics
