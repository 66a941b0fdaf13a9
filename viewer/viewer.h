// The picture: a lit relief with the proxy ball, an overview with the window's frame, the GUI. In a window (GLFW) or
// without any display (EGL).
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "haptics/state/requests.h"
#include "haptics/state/seqlock.h"
#include "haptics/state/state.h"
#include "scene/config/parts.h"
#include "scene/config/viewer.h"
#include "scene/scene_fwd.h"
#include "viewer/cloud/point_view.h"
#include "viewer/overlay/strip.h"

namespace sparsha::viewer {

enum class WindowEnd {
  closed,       ///< by the user, or the session ended
  display_lost  ///< under the window; it may be opened again when the display is back
};

struct ViewerOptions {
  bool kiosk = false;        ///< full screen, big buttons only; Control+Q leaves
  bool opens_again = false;  ///< after a lost display: without one run_window() says so and throws nothing
  double idle_s = 60.0;      ///< kiosk: without a touch for so long, the exhibit goes back to its beginning
  int width = 1280;
  int height = 720;
};

/// What the viewer reads and writes; all outlive it. While there is no scene, the raw cloud is shown; what is read and
/// written of the session is looked at when the first scene has come.
struct Connections {
  const haptics::Seqlock<haptics::State>* state = nullptr;
  haptics::RequestQueue* requests = nullptr;
  const haptics::AnnouncementBoard* announcements = nullptr;
  std::shared_ptr<haptics::Seqlock<haptics::PointerSample>> pointer;  ///< null unless the pointer device is used
  /// z of the first surface of a whole object before a place of the workspace, device frame; NaN: one view.
  std::function<double(const Eigen::Vector2d& device_m)> object_before_m;
  std::function<void()> poll;                  ///< called once a frame (the session's)
  std::function<bool()> finished;              ///< the session's
  std::function<scene::ScenePointer()> scene;  ///< the session's present scene; null before the first depth scan
  std::function<void(const Eigen::Matrix4d& scan_to_grid)> rescan;  ///< empty without scans
  std::function<void(const std::string& text)> speak;               ///< says what the keyboard is on; empty: silent
  std::function<void(int step)> next_scene;  ///< of an exhibition, 1 or -1; empty: there is but one
  std::function<void(const std::vector<std::filesystem::path>& files)> drop;  ///< files dropped into the window
  std::function<void(const std::string& why)>
      refuse;  ///< the new scene cannot be read whole: the one before comes back
  /// The scene's parts were edited: they are to be felt, spoken and kept. False when they stay as they were, which was
  /// said. Empty: parts cannot be edited.
  std::function<bool(const std::vector<scene::PartConfig>& parts)> save_parts;
  std::function<void()> save_scene;  ///< keeps the depth scan under the hand as a scene folder, and says where
  std::function<bool()> to_scans;    ///< true once when other scans have been opened and are to be shown
  Orienting orienting;               ///< the raw cloud behind the scene; without functions there is none
};

/// True when a window could be opened.
[[nodiscard]] bool display_available();

/// Opens a window and runs until the user or the session ends. `connections` may be filled in by its `poll`. Throws
/// Error{failure} when no window can be opened.
WindowEnd run_window(const Connections& connections, const ViewerOptions& options);

/// Draws one 1280x720 picture of scene and state without a display and writes it as PNG, atomically. `strip` is what
/// was felt until then.
/// Throws Error{failure} when no off-screen context can be made.
void write_screenshot(const scene::ScenePointer& scene, const haptics::State& state, const scene::ViewerConfig& config,
                      const std::filesystem::path& file, const Strip& strip = {});

/// Draws the scene from six sides without a display, two rows of three squares of `side` pixels: front, right, back;
/// left, from above, from below. Writes it as PNG, atomically. Of a relief without charts the front alone is shown.
/// Throws Error{failure} when no off-screen context can be made.
void write_six_views(const scene::ScenePointer& scene, int side, const std::filesystem::path& file);

}  // namespace sparsha::viewer
