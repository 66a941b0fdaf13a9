// The table of what can be done with the raw cloud, and the table of its keys.
#include <algorithm>
#include <array>

#include "viewer/cloud/controller.h"

namespace sparsha::viewer {
namespace {

using enum CloudAction;

constexpr std::array kActions{
    CloudActionInfo{scan, "Enter", "Scan", "make the depth scan from this side"},
    CloudActionInfo{save_scene, "Ctrl S", "Save scene", "keep the depth scan as a scene folder"},
    CloudActionInfo{save, "Ctrl Shift S", "Save", "write this orientation into a configuration"},
    CloudActionInfo{back, "Esc", "Back", "stop what runs, else back to the scene"},
    CloudActionInfo{front, "1", "Front", "look at the front"},
    CloudActionInfo{rear, "2", "Back side", "look at the back"},
    CloudActionInfo{left, "3", "Left", "look at the left side"},
    CloudActionInfo{right, "4", "Right", "look at the right side"},
    CloudActionInfo{top, "5", "Top", "look at the top"},
    CloudActionInfo{bottom, "6", "Bottom", "look at the bottom"},
    CloudActionInfo{flat_face, "7", "Flat face", "the largest flat face to the front"},
    CloudActionInfo{broad_side, "8", "Broad side", "the broad side to the front"},
    CloudActionInfo{as_scanned, "9", "As scanned", "as the scans were delivered"},
    CloudActionInfo{upright, "U", "Upright", "roll until the object stands upright"},
    CloudActionInfo{up_axis, "Y", "Up axis", "the next axis of the scan points up: y, z, x, -y, -z, -x"},
    CloudActionInfo{undo, "Ctrl Z", "Undo", "the orientation before"},
    CloudActionInfo{turn_left, "\xE2\x86\x90", "Turn left", "turn the object by 5 degrees; Shift: by 0.5"},
    CloudActionInfo{turn_right, "\xE2\x86\x92", "Turn right", "turn it the other way"},
    CloudActionInfo{tilt_up, "\xE2\x86\x91", "Tilt back", "tilt its top away by 5 degrees; Shift: by 0.5"},
    CloudActionInfo{tilt_down, "\xE2\x86\x93", "Tilt forwards", "tilt its top nearer"},
    CloudActionInfo{roll_left, ",", "Roll left", "roll by 5 degrees"},
    CloudActionInfo{roll_right, ".", "Roll right", "roll the other way"},
    CloudActionInfo{fine_left, "Shift \xE2\x86\x90", "Turn a little", "turn by half a degree"},
    CloudActionInfo{fine_right, "Shift \xE2\x86\x92", "Turn a little", "turn by half a degree"},
    CloudActionInfo{fine_up, "Shift \xE2\x86\x91", "Tilt a little", "tilt by half a degree"},
    CloudActionInfo{fine_down, "Shift \xE2\x86\x93", "Tilt a little", "tilt by half a degree"},
    CloudActionInfo{closer, "+", "Closer", "a larger picture"},
    CloudActionInfo{farther, "-", "Farther", "a smaller picture"},
    CloudActionInfo{fit, "0", "Whole", "the whole object in the picture"},
    CloudActionInfo{free_ball, "B", "Free ball", "dragging turns about any axis; off: a turntable"},
    CloudActionInfo{colour, "C", "Colour", "scan colour, intensity, height, stations"},
    CloudActionInfo{crop, "K", "Crop", "a box that keeps what belongs to the object"},
    CloudActionInfo{help, "F1", "Help", "keys"},
    CloudActionInfo{contrast, "X", "Contrast", "high contrast on or off"},
    CloudActionInfo{large_type, "G", "Large type", "large type on or off"},
    CloudActionInfo{quit, "Q", "Quit", "leave"},
};

struct Binding {
  int key;
  int modifiers;
  CloudAction action;
  bool repeats;
};

constexpr int kAny = -1;  // Shift is part of the character

constexpr std::array kBindings{
    Binding{key::kEnter, 0, scan, false},
    Binding{'S', kControl, save_scene, false},
    Binding{'S', kControl | kShift, save, false},
    Binding{key::kEscape, 0, back, false},
    Binding{'1', 0, front, false},
    Binding{'2', 0, rear, false},
    Binding{'3', 0, left, false},
    Binding{'4', 0, right, false},
    Binding{'5', 0, top, false},
    Binding{'6', 0, bottom, false},
    Binding{'7', 0, flat_face, false},
    Binding{'8', 0, broad_side, false},
    Binding{'9', 0, as_scanned, false},
    Binding{'U', 0, upright, false},
    Binding{'Y', 0, up_axis, false},
    Binding{'Z', kControl, undo, true},
    Binding{key::kLeft, 0, turn_left, true},
    Binding{key::kRight, 0, turn_right, true},
    Binding{key::kUp, 0, tilt_up, true},
    Binding{key::kDown, 0, tilt_down, true},
    Binding{',', kAny, roll_left, true},
    Binding{'.', kAny, roll_right, true},
    Binding{key::kLeft, kShift, fine_left, true},
    Binding{key::kRight, kShift, fine_right, true},
    Binding{key::kUp, kShift, fine_up, true},
    Binding{key::kDown, kShift, fine_down, true},
    Binding{'+', kAny, closer, true},
    Binding{'=', kAny, closer, true},
    Binding{'-', kAny, farther, true},
    Binding{'0', 0, fit, false},
    Binding{key::kHome, 0, fit, false},
    Binding{'B', 0, free_ball, false},
    Binding{'C', 0, colour, false},
    Binding{'K', 0, crop, false},
    Binding{key::kF1, 0, help, false},
    Binding{'H', 0, help, false},
    Binding{'X', 0, contrast, false},
    Binding{'G', 0, large_type, false},
    Binding{'Q', 0, quit, false},
    Binding{'Q', kControl, quit, false},
};

}  // namespace

std::span<const CloudActionInfo> all_cloud_actions() { return kActions; }

const CloudActionInfo& info_of(CloudAction action) {
  return *std::ranges::find_if(kActions, [&](const CloudActionInfo& info) { return info.action == action; });
}

std::optional<CloudAction> cloud_action_of(const KeyPress& press) {
  for (const Binding& binding : kBindings) {
    const bool modifiers =
        binding.modifiers == kAny ? (press.modifiers & kControl) == 0 : binding.modifiers == press.modifiers;
    if (binding.key != press.key || !modifiers) continue;
    if (press.repeated && !binding.repeats) return std::nullopt;
    return binding.action;
  }
  return std::nullopt;
}

bool is_cloud_key(int key) {
  return std::ranges::any_of(kBindings, [key](const Binding& binding) { return binding.key == key; });
}

}  // namespace sparsha::viewer
