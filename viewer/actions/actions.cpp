// The table of actions and the table of keys.
#include "viewer/actions/actions.h"

#include <algorithm>
#include <array>

namespace sparsha::viewer {
namespace {

constexpr std::array kActions{
    ActionInfo{Action::zoom_out, Group::touch, "-", "Zoom out", "a wider window, or one level coarser", true, true},
    ActionInfo{Action::zoom_in, Group::touch, "+", "Zoom in", "one level finer, or nearer to the stone", true, true},
    ActionInfo{Action::next_part, Group::touch, "N", "Next part", "go to the next named part", false, false},
    ActionInfo{Action::previous_part, Group::touch, "B", "Previous part", "go to the previous named part", false,
               false},
    ActionInfo{Action::whole_scene, Group::touch, "W", "Whole", "the whole of it", false, false},
    ActionInfo{Action::drag, Group::touch, "D", "Drag", "while it is held, the hand drags the stone", false, false},
    ActionInfo{Action::turn_object_left, Group::touch, "Ctrl Shift \xE2\x86\x90", "Turn it left",
               "turn a whole object in the hand", true, true},
    ActionInfo{Action::turn_object_right, Group::touch, "Ctrl Shift \xE2\x86\x92", "Turn it right",
               "turn a whole object the other way", true, true},
    ActionInfo{Action::turn_object_up, Group::touch, "Ctrl Shift \xE2\x86\x91", "Tip it back",
               "tip a whole object: what is below comes to the front", false, true},
    ActionInfo{Action::turn_object_down, Group::touch, "Ctrl Shift \xE2\x86\x93", "Tip it forward",
               "tip a whole object: what is above comes to the front", false, true},
    ActionInfo{Action::roll_object, Group::touch, "Ctrl PgUp", "Roll it", "a whole object, as a wheel", false, false},
    ActionInfo{Action::roll_object_back, Group::touch, "Ctrl PgDn", "Roll it back", "the other way", false, false},
    ActionInfo{Action::object_front, Group::touch, "Ctrl Home", "Its front", "a whole object shows its front again",
               false, true},
    ActionInfo{Action::pan_left, Group::touch, "\xE2\x86\x90", "Left", "move the window left", false, true},
    ActionInfo{Action::pan_right, Group::touch, "\xE2\x86\x92", "Right", "move the window right", false, true},
    ActionInfo{Action::pan_up, Group::touch, "\xE2\x86\x91", "Up", "move the window up", false, true},
    ActionInfo{Action::pan_down, Group::touch, "\xE2\x86\x93", "Down", "move the window down", false, true},
    ActionInfo{Action::texture, Group::touch, "T", "Texture", "fine texture on or off", true, false},
    ActionInfo{Action::friction, Group::touch, "F", "Friction", "friction on or off", true, false},
    ActionInfo{Action::stiffer, Group::touch, "]", "Harder", "a harder surface", false, false},
    ActionInfo{Action::softer, Group::touch, "[", "Softer", "a softer surface", false, false},
    ActionInfo{Action::describe, Group::touch, "Space", "Where am I?", "say where the hand is", true, true},
    ActionInfo{Action::undo, Group::touch, "Ctrl Z", "Undo", "back to the window before", false, false},
    ActionInfo{Action::mode, Group::hand, "Tab", "Look", "touch: mouse is the hand; look: left drag turns", true,
               false},
    ActionInfo{Action::hand_left, Group::hand, "Shift \xE2\x86\x90", "Hand left", "move the hand left", false, false},
    ActionInfo{Action::hand_right, Group::hand, "Shift \xE2\x86\x92", "Hand right", "move the hand right", false,
               false},
    ActionInfo{Action::hand_up, Group::hand, "Shift \xE2\x86\x91", "Hand up", "move the hand up", false, false},
    ActionInfo{Action::hand_down, Group::hand, "Shift \xE2\x86\x93", "Hand down", "move the hand down", false, false},
    ActionInfo{Action::hand_raise, Group::hand, "Page Up", "Raise hand", "raise the hand", false, false},
    ActionInfo{Action::hand_lower, Group::hand, "Page Down", "Lower hand", "lower the hand", false, false},
    ActionInfo{Action::press, Group::hand, "Enter", "Press", "press the hand down, or lift it", false, false},
    ActionInfo{Action::colour, Group::picture, "C", "Colour", "the next map: height, slope, scan, ...", true, false},
    ActionInfo{Action::colour_back, Group::picture, "Shift C", "Colour back", "the map before", false, false},
    ActionInfo{Action::look, Group::picture, "F4", "Look", "stone, sky light, clay, edges of depth", false, false},
    ActionInfo{Action::look_back, Group::picture, "Shift F4", "Look back", "the look before", false, false},
    ActionInfo{Action::contours_finer, Group::picture, "F3", "Contours", "contour lines, then at finer steps", false,
               false},
    ActionInfo{Action::contours_coarser, Group::picture, "Shift F3", "Contours off", "at coarser steps, then none",
               false, false},
    ActionInfo{Action::light_turn, Group::picture, "L", "Light", "turn the light", true, false},
    ActionInfo{Action::light_back, Group::picture, "Shift L", "Light back", "turn the light back", false, false},
    ActionInfo{Action::light_higher, Group::picture, ".", "Light higher", "raise the light", false, false},
    ActionInfo{Action::light_lower, Group::picture, ",", "Light lower", "lower the light: it rakes", false, false},
    ActionInfo{Action::light_preset, Group::picture, "J", "Light preset", "raking from each side, from the front",
               false, false},
    ActionInfo{Action::stereo, Group::picture, "S", "Stereo", "red-cyan in colours, in grey, side by side, off", true,
               false},
    ActionInfo{Action::swap_eyes, Group::picture, "Shift S", "Swap eyes", "left and right change places", false, false},
    ActionInfo{Action::eyes_apart, Group::picture, "F8", "Eyes apart", "more depth in stereo", false, false},
    ActionInfo{Action::eyes_together, Group::picture, "F7", "Eyes together", "less depth in stereo", false, false},
    ActionInfo{Action::screen_farther, Group::picture, "Shift F8", "Out of screen", "stereo comes out of the screen",
               false, false},
    ActionInfo{Action::screen_nearer, Group::picture, "Shift F7", "Into screen", "stereo goes behind the screen", false,
               false},
    ActionInfo{Action::filled, Group::picture, "M", "Mark filled", "dot the areas that were filled in", false, false},
    ActionInfo{Action::outline, Group::picture, "Shift O", "Outline", "a line around what was measured", false, false},
    ActionInfo{Action::contrast, Group::picture, "X", "Contrast", "high contrast on or off", false, false},
    ActionInfo{Action::large_type, Group::picture, "G", "Large type", "large type on or off", false, false},
    ActionInfo{Action::measure, Group::marks, "U", "Measure", "a distance, an angle, a depth profile, off", false,
               false},
    ActionInfo{Action::measure_save, Group::marks, "Shift U", "Save measures",
               "measures and profile as CSV, and the picture", false, false},
    ActionInfo{Action::pin, Group::marks, "K", "Pin", "a note where the mouse points or the hand touches", false,
               false},
    ActionInfo{Action::erase, Group::marks, "Delete", "Remove", "the pin, measure or part at the mouse", false, false},
    ActionInfo{Action::show_parts, Group::marks, "A", "Parts", "the parts' boxes; drag their corners", false, false},
    ActionInfo{Action::add_part, Group::marks, "Shift K", "New part", "a part at the mouse", false, false},
    ActionInfo{Action::section, Group::marks, "Z", "Section", "cut the stone, along the newest profile", false, false},
    ActionInfo{Action::section_turn, Group::marks, "Shift Z", "Turn section", "turn the section plane", false, false},
    ActionInfo{Action::section_far, Group::marks, "Y", "Section on", "move the section plane on", false, false},
    ActionInfo{Action::section_near, Group::marks, "Shift Y", "Section back", "move the section plane back", false,
               false},
    ActionInfo{Action::turn_left, Group::camera, "Ctrl \xE2\x86\x90", "Turn left", "turn the picture", false, false},
    ActionInfo{Action::turn_right, Group::camera, "Ctrl \xE2\x86\x92", "Turn right", "turn the picture back", false,
               false},
    ActionInfo{Action::tilt_up, Group::camera, "Ctrl \xE2\x86\x91", "Tilt", "look straight down", false, false},
    ActionInfo{Action::tilt_down, Group::camera, "Ctrl \xE2\x86\x93", "Tilt back", "look along the surface", false,
               false},
    ActionInfo{Action::closer, Group::camera, "Ctrl +", "Closer", "camera closer", false, false},
    ActionInfo{Action::farther, Group::camera, "Ctrl -", "Farther", "camera farther", false, false},
    ActionInfo{Action::camera_reset, Group::camera, "0", "Reset view", "camera back to the window", false, false},
    ActionInfo{Action::home, Group::camera, "Home", "Home", "the first view: the whole of it, straight on", true, true},
    ActionInfo{Action::orthographic, Group::camera, "I", "Parallel", "with or without perspective", false, false},
    ActionInfo{Action::rescan, Group::program, "R", "Scan again", "a new depth scan from this side", false, false},
    ActionInfo{Action::orient, Group::program, "O", "Turn object", "the raw scans: turn the object, scan again", true,
               false},
    ActionInfo{Action::next_scene, Group::program, "E", "Next object", "the next object of an exhibition", false, true},
    ActionInfo{Action::previous_scene, Group::program, "Shift E", "Previous object", "the object before", false, false},
    ActionInfo{Action::next_item, Group::program, "F6", "Next button", "go through the buttons; Enter presses", false,
               false},
    ActionInfo{Action::previous_item, Group::program, "Shift F6", "Previous", "back through the buttons", false, false},
    ActionInfo{Action::help, Group::program, "F1 or H", "Help", "this page", true, true},
    ActionInfo{Action::tour, Group::program, "F2", "Tour", "a minute in which the buttons are learnt", false, false},
    ActionInfo{Action::strip_pause, Group::program, "V", "Pause strip",
               "stop and start the strip of force, depth, speed", false, false},
    ActionInfo{Action::strip_save, Group::program, "Shift V", "Save strip", "the strip's ten seconds as CSV", false,
               false},
    ActionInfo{Action::screenshot, Group::program, "P", "Picture", "save the picture as PNG", false, false},
    ActionInfo{Action::save_scene, Group::program, "Ctrl S", "Save scene", "keep the depth scan as a scene folder",
               false, false},
    ActionInfo{Action::full_screen, Group::program, "F11", "Full screen", "full screen or window", false, false},
    ActionInfo{Action::figures, Group::program, "F12", "Figures", "pictures a second, ticks", false, false},
    ActionInfo{Action::escape, Group::program, "Esc", "Close", "close what is open, else leave", false, false},
    ActionInfo{Action::quit, Group::program, "Q", "Quit", "leave", false, false},
};

struct Binding {
  int key;
  int modifiers;
  Action action;
  bool repeats;
};

constexpr int kAny = -1;  // Shift is part of the character

constexpr std::array kBindings{
    // Before those with Control alone, which Shift does not change.
    Binding{key::kLeft, kControl | kShift, Action::turn_object_left, true},
    Binding{key::kRight, kControl | kShift, Action::turn_object_right, true},
    Binding{key::kUp, kControl | kShift, Action::turn_object_up, true},
    Binding{key::kDown, kControl | kShift, Action::turn_object_down, true},
    Binding{key::kPageUp, kControl, Action::roll_object, true},
    Binding{key::kPageDown, kControl, Action::roll_object_back, true},
    Binding{key::kHome, kControl, Action::object_front, false},
    Binding{'+', kAny, Action::zoom_in, false},
    Binding{'=', kAny, Action::zoom_in, false},
    Binding{'-', kAny, Action::zoom_out, false},
    Binding{'N', 0, Action::next_part, false},
    Binding{'B', 0, Action::previous_part, false},
    Binding{'W', 0, Action::whole_scene, false},
    Binding{'D', 0, Action::drag, false},
    Binding{key::kF1 + 1, 0, Action::tour, false},
    Binding{key::kLeft, 0, Action::pan_left, true},
    Binding{key::kRight, 0, Action::pan_right, true},
    Binding{key::kUp, 0, Action::pan_up, true},
    Binding{key::kDown, 0, Action::pan_down, true},
    Binding{key::kLeft, kShift, Action::hand_left, true},
    Binding{key::kRight, kShift, Action::hand_right, true},
    Binding{key::kUp, kShift, Action::hand_up, true},
    Binding{key::kDown, kShift, Action::hand_down, true},
    Binding{key::kPageUp, 0, Action::hand_raise, true},
    Binding{key::kPageDown, 0, Action::hand_lower, true},
    Binding{key::kEnter, 0, Action::press, false},
    Binding{'T', 0, Action::texture, false},
    Binding{'F', 0, Action::friction, false},
    Binding{']', kAny, Action::stiffer, true},
    Binding{'[', kAny, Action::softer, true},
    Binding{'9', kAny, Action::stiffer, true},  // where a bracket's place has another meaning
    Binding{'8', kAny, Action::softer, true},
    Binding{' ', 0, Action::describe, false},
    Binding{'C', 0, Action::colour, false},
    Binding{'C', kShift, Action::colour_back, false},
    Binding{key::kF1 + 3, 0, Action::look, false},
    Binding{key::kF1 + 3, kShift, Action::look_back, false},
    Binding{key::kF1 + 2, 0, Action::contours_finer, true},
    Binding{key::kF1 + 2, kShift, Action::contours_coarser, true},
    Binding{'U', 0, Action::measure, false},
    Binding{'U', kShift, Action::measure_save, false},
    Binding{'K', 0, Action::pin, false},
    Binding{'K', kShift, Action::add_part, false},
    Binding{key::kDelete, 0, Action::erase, false},
    Binding{'A', 0, Action::show_parts, false},
    Binding{'Z', 0, Action::section, false},
    Binding{'Z', kShift, Action::section_turn, true},
    Binding{'Y', 0, Action::section_far, true},
    Binding{'Y', kShift, Action::section_near, true},
    Binding{'L', 0, Action::light_turn, true},
    Binding{'L', kShift, Action::light_back, true},
    Binding{'.', kAny, Action::light_higher, true},
    Binding{',', kAny, Action::light_lower, true},
    Binding{'J', 0, Action::light_preset, false},
    Binding{'S', 0, Action::stereo, false},
    Binding{'S', kShift, Action::swap_eyes, false},
    Binding{key::kF1 + 7, 0, Action::eyes_apart, true},
    Binding{key::kF1 + 6, 0, Action::eyes_together, true},
    Binding{key::kF1 + 7, kShift, Action::screen_farther, true},
    Binding{key::kF1 + 6, kShift, Action::screen_nearer, true},
    Binding{'O', kShift, Action::outline, false},
    Binding{'M', 0, Action::filled, false},
    Binding{'X', 0, Action::contrast, false},
    Binding{'G', 0, Action::large_type, false},
    Binding{key::kLeft, kControl, Action::turn_left, true},
    Binding{key::kRight, kControl, Action::turn_right, true},
    Binding{key::kUp, kControl, Action::tilt_up, true},
    Binding{key::kDown, kControl, Action::tilt_down, true},
    Binding{'+', kControl, Action::closer, true},
    Binding{'=', kControl, Action::closer, true},
    Binding{'-', kControl, Action::farther, true},
    Binding{'0', 0, Action::camera_reset, false},
    Binding{key::kHome, 0, Action::home, false},
    Binding{'I', 0, Action::orthographic, false},
    Binding{'R', 0, Action::rescan, false},
    Binding{'O', 0, Action::orient, false},
    Binding{'E', 0, Action::next_scene, false},
    Binding{'E', kShift, Action::previous_scene, false},
    Binding{key::kTab, 0, Action::mode, false},
    Binding{key::kF1 + 5, 0, Action::next_item, true},
    Binding{key::kF1 + 5, kShift, Action::previous_item, true},
    Binding{'P', 0, Action::screenshot, false},
    Binding{'S', kControl, Action::save_scene, false},
    Binding{'V', 0, Action::strip_pause, false},
    Binding{'V', kShift, Action::strip_save, false},
    Binding{key::kF1 + 10, 0, Action::full_screen, false},
    Binding{key::kF1 + 11, 0, Action::figures, false},
    Binding{'Z', kControl, Action::undo, true},
    Binding{key::kF1, 0, Action::help, false},
    Binding{'H', 0, Action::help, false},
    Binding{key::kEscape, 0, Action::escape, false},
    Binding{'Q', 0, Action::quit, false},
    Binding{'Q', kControl, Action::quit, false},
};

/// What an exhibit's keyboard does: touch, see and hear; nothing that the next visitor would have to put right, and no
/// files.
bool for_visitors(Action action) {
  switch (action) {
    using enum Action;
    case zoom_in:
    case zoom_out:
    case next_part:
    case previous_part:
    case whole_scene:
    case drag:
    case tour:
    case pan_left:
    case pan_right:
    case pan_up:
    case pan_down:
    case hand_left:
    case hand_right:
    case hand_up:
    case hand_down:
    case hand_raise:
    case hand_lower:
    case press:
    case describe:
    case colour:
    case colour_back:
    case light_turn:
    case light_back:
    case light_higher:
    case light_lower:
    case light_preset:
    case contrast:
    case large_type:
    case turn_object_left:
    case turn_object_right:
    case turn_object_up:
    case turn_object_down:
    case roll_object:
    case roll_object_back:
    case object_front:
    case home:
    case next_scene:
    case previous_scene:
    case next_item:
    case previous_item:
    case help:
    case escape:
    case quit:  // only the staff's chord comes this far
      return true;
    default:
      return false;
  }
}

}  // namespace

std::span<const ActionInfo> all_actions() { return kActions; }

const ActionInfo& info_of(Action action) {
  return *std::ranges::find_if(kActions, [&](const ActionInfo& info) { return info.action == action; });
}

std::optional<Action> action_of(const KeyPress& press, bool kiosk) {
  for (const Binding& binding : kBindings) {
    const bool modifiers =
        binding.modifiers == kAny ? (press.modifiers & kControl) == 0 : binding.modifiers == press.modifiers;
    const bool with_control = binding.modifiers == kControl && press.modifiers == (kControl | kShift);
    if (binding.key != press.key || (!modifiers && !with_control)) continue;
    if (press.repeated && !binding.repeats) return std::nullopt;
    if (kiosk && binding.action == Action::quit && (press.modifiers & kControl) == 0) return std::nullopt;
    if (kiosk && !for_visitors(binding.action)) return std::nullopt;
    return binding.action;
  }
  return std::nullopt;
}

bool of_whole_objects(Action action) { return action >= Action::turn_object_left && action <= Action::object_front; }

bool is_key(int key) {
  return std::ranges::any_of(kBindings, [key](const Binding& binding) { return binding.key == key; });
}

const char* name_of(Group group) {
  switch (group) {
    case Group::touch:
      return "Touch";
    case Group::hand:
      return "Hand (pointer device)";
    case Group::picture:
      return "Picture";
    case Group::marks:
      return "Marks on the stone";
    case Group::camera:
      return "Camera";
    case Group::program:
      return "Program";
  }
  return "";
}

}  // namespace sparsha::viewer
