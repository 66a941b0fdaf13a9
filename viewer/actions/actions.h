// Everything a visitor can do, with its key. Buttons, keys and the help page all come from this one table.
#pragma once

#include <optional>
#include <span>

namespace sparsha::viewer {

enum class Action {
  zoom_in,
  zoom_out,
  next_part,
  previous_part,
  whole_scene,
  drag,
  turn_object_left,
  turn_object_right,
  turn_object_up,
  turn_object_down,
  roll_object,
  roll_object_back,
  object_front,
  tour,
  pan_left,
  pan_right,
  pan_up,
  pan_down,
  hand_left,
  hand_right,
  hand_up,
  hand_down,
  hand_raise,
  hand_lower,
  press,
  texture,
  friction,
  stiffer,
  softer,
  describe,
  undo,
  mode,
  colour,
  colour_back,
  look,
  look_back,
  contours_finer,
  contours_coarser,
  light_turn,
  light_back,
  light_higher,
  light_lower,
  light_preset,
  stereo,
  swap_eyes,
  eyes_apart,
  eyes_together,
  screen_nearer,
  screen_farther,
  filled,
  outline,
  contrast,
  large_type,
  measure,
  measure_save,
  pin,
  erase,
  show_parts,
  add_part,
  section,
  section_turn,
  section_near,
  section_far,
  turn_left,
  turn_right,
  tilt_up,
  tilt_down,
  closer,
  farther,
  camera_reset,
  home,
  orthographic,
  rescan,
  orient,
  next_scene,
  previous_scene,
  screenshot,
  save_scene,
  full_screen,
  figures,
  strip_pause,
  strip_save,
  help,
  next_item,
  previous_item,
  escape,
  quit
};

/// Keys as the layout names them: printable ones are their upper-case character, others have names here.
namespace key {
inline constexpr int kLeft = 256, kRight = 257, kUp = 258, kDown = 259, kPageUp = 260, kPageDown = 261, kHome = 262,
                     kEnter = 263, kEscape = 264, kTab = 265, kF1 = 266,  ///< kF1 + n - 1 is the n-th
    kDelete = 278, kBackspace = 279;
}  // namespace key

/// Bits of KeyPress::modifiers.
inline constexpr int kShift = 1, kControl = 2;

struct KeyPress {
  int key = 0;
  int modifiers = 0;
  bool repeated = false;  ///< the key is held down
};

enum class Group { touch, hand, picture, marks, camera, program };

struct ActionInfo {
  Action action;
  Group group;
  const char* keys;   ///< as shown
  const char* label;  ///< of its button
  const char* what;   ///< for the help page and for speech
  bool button;        ///< in the bar
  bool kiosk_button;  ///< in the kiosk's bar
};

[[nodiscard]] std::span<const ActionInfo> all_actions();
[[nodiscard]] const ActionInfo& info_of(Action action);
/// The action of a key, or nothing. In kiosk mode only Control+Q ends the program.
[[nodiscard]] std::optional<Action> action_of(const KeyPress& press, bool kiosk);
/// True of actions on a whole object alone.
[[nodiscard]] bool of_whole_objects(Action action);
/// True when the key has an action with some modifiers.
[[nodiscard]] bool is_key(int key);
[[nodiscard]] const char* name_of(Group group);

}  // namespace sparsha::viewer
