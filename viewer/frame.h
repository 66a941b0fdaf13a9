// Everything one picture shows, as plain values.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "haptics/state/requests.h"
#include "haptics/state/state.h"
#include "viewer/camera.h"
#include "viewer/surface/paint.h"

namespace sparsha::viewer {

/// What the visitor has chosen.
struct ViewSettings {
  ColourMode colour = ColourMode::relief;
  bool anaglyph = false;
  bool anaglyph_grey = true;  ///< colours make the eyes fight
  bool mark_filled = false;
  bool high_contrast = false;
  bool large_type = false;
  bool help = false;
  bool kiosk = false;
  KeyLight light;
};

/// The square of the scene that the hand can reach, grid frame.
struct Window {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double width_m = 1.0;
  bool meant = false;  ///< false: no servo has chosen one, it is the whole scene
};
/// `state.tick` 0 means that there is no state yet.
[[nodiscard]] Window window_of(const haptics::State& state, const pipeline::SceneDescription& description);

/// Words on the picture and how much of their time is left, 0 to 1.
struct Toast {
  haptics::Announcement announcement;
  double left = 1.0;
};

struct Frame {
  haptics::State state;  ///< tick 0: nothing is known of the hand
  Camera camera;         ///< of the detail view
  ViewSettings settings;
  std::vector<Toast> toasts;  ///< oldest first
  std::string title;          ///< of the scene
  std::string part;           ///< the named part under the hand, or empty
  int focused = -1;           ///< button that the keyboard is on, or none
  bool asks_rescan = false;   ///< the question whether to scan again from this side is open
  bool can_rescan = false;
  std::string why_not_orient;  ///< empty, or why the raw scans cannot be shown
  bool has_pointer = false;    ///< the mouse is the hand
  bool other_scenes = false;   ///< there is another one to go to
  bool finished = true;        ///< draw at full quality whatever it costs (pictures for files)
  double time_s = 0.0;
};

/// Where things are in the window, pixels from the top left.
struct Layout {
  Rect detail;
  Rect panel;          ///< zero width in kiosk mode
  Rect overview;       ///< the overview's picture, inside the panel or over the detail view
  double scale = 1.0;  ///< of type and lines
};
[[nodiscard]] Layout layout_of(int width, int height, const ViewSettings& settings);

/// Parallel camera straight at the whole scene, as it fits a square of the overview.
[[nodiscard]] Camera overview_camera(const pipeline::SceneDescription& description, const Rect& rect);

}  // namespace sparsha::viewer
