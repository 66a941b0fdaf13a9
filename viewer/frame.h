// Everything one picture shows, as plain values.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "haptics/state/requests.h"
#include "haptics/state/state.h"
#include "scene/config/viewer.h"
#include "viewer/actions/actions.h"
#include "viewer/camera/camera.h"
#include "viewer/marks/marks.h"
#include "viewer/overlay/strip.h"
#include "viewer/surface/look.h"
#include "viewer/surface/paint.h"

namespace sparsha::viewer {

using StereoMode = scene::ViewerConfig::Stereo;

/// Two eyes. The disparity of a point at distance d along the line of sight is f e (1 / c - 1 / d) pixels to the right
/// in the right eye's picture: f the focal length in pixels, e the eyes' separation, c the distance of zero parallax.
struct Stereo {
  StereoMode mode = StereoMode::off;
  bool swapped = false;
  double separation = 0.07;  ///< of the camera's distance
  double convergence = 1.0;  ///< distance of zero parallax, of the camera's distance

  [[nodiscard]] bool on() const { return mode != StereoMode::off; }
};

/// What the visitor has chosen.
struct ViewSettings {
  ColourMode colour = ColourMode::relief;
  Look look = Look::stone;
  double contour_m = 0.0;  ///< step of contour lines; 0: none
  bool parts = false;      ///< the parts' boxes are drawn
  Stereo stereo;
  bool mark_filled = false;
  bool outline = false;  ///< a faint line around what was measured
  bool high_contrast = false;
  bool large_type = false;
  bool help = false;
  bool figures = false;  ///< what pictures and ticks cost
  bool kiosk = false;
  bool overview_left = false;  ///< the panel with the overview lies left of the detail view
  KeyLight light;
};
/// As a scene's configuration asks for.
[[nodiscard]] ViewSettings settings_of(const scene::ViewerConfig& config);

/// The square of the scene that the hand can reach, grid frame.
struct Window {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double width_m = 1.0;
  bool meant = false;  ///< false: no servo has chosen one, it is the whole scene
};
/// `state.tick` 0 means that there is no state yet.
[[nodiscard]] Window window_of(const haptics::State& state, const scene::SceneDescription& description);

/// With the object turned as the hand has it.
[[nodiscard]] Stage stage_of(const scene::SceneDescription& description, const haptics::State& state);

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
  std::string why_not_orient;                               ///< empty, or why the raw scans cannot be shown
  bool has_texture = true;                                  ///< the scene has one that can be switched off
  bool has_friction = true;                                 ///< the scene has a law of friction
  bool other_scenes = false;                                ///< there is another one to go to
  bool has_pointer = false;                                 ///< the mouse is the hand
  bool looks = false;                                       ///< the left button turns the picture, and is not the hand
  Eigen::Vector2d mouse = Eigen::Vector2d::Constant(-1.0);  ///< pixels
  bool finished = true;  ///< draw at full quality whatever it costs (pictures for files)
  double time_s = 0.0;
  int hovered = -1;  ///< box that the mouse is over, or none
  int help_page = 0;
  Strip strip;
  Marks marks;
  /// What pictures cost, of the last second; shown with ViewSettings::figures.
  double pictures_per_s = 0.0, picture_ms = 0.0;
};

/// What the interface has drawn that can be clicked, pixels.
struct Clickable {
  enum class Does { action, yes, no, nothing };
  Rect rect;
  Does does = Does::nothing;
  Action action = Action::escape;  ///< of Does::action
};

/// A number that is another one when the picture of the frame would look different, by more than a fraction of a pixel
/// or of a figure's last digit.
[[nodiscard]] std::uint64_t look_of(const Frame& frame);

/// Where things are in the window, pixels from the top left.
struct Layout {
  Rect detail;
  Rect bar;            ///< of the buttons: below the detail view
  Rect panel;          ///< zero width in kiosk mode
  Rect overview;       ///< the overview's picture, inside the panel or over the detail view
  Rect strip;          ///< force, depth and speed over time; empty where there is no room
  Rect footer;         ///< the panel's last line
  double scale = 1.0;  ///< of type and lines
};
[[nodiscard]] Layout layout_of(int width, int height, const ViewSettings& settings);

/// The step of contour lines after `step_m` for heights that span `range_m`: 1, 2 or 5 times a power of ten. 0 is no
/// lines, before the coarsest step.
[[nodiscard]] double next_contour_m(double step_m, double range_m, bool finer);

/// "stem-20260131-235959.csv": a new name in the working folder for what a visitor saves.
[[nodiscard]] std::string dated_name(const std::string& stem, const std::string& extension);

/// Parallel camera straight at the whole scene, as it fits a square of the overview. `stage`: of the scene.
[[nodiscard]] Camera overview_camera(const scene::SceneDescription& description, const Stage& stage, const Rect& rect);

}  // namespace sparsha::viewer
