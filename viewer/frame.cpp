// Layout and the small geometry that several parts of the picture share.
#include "viewer/frame.h"

#include <algorithm>
#include <cmath>

#include "scene/workspace.h"

namespace sparsha::viewer {

Window window_of(const haptics::State& state, const pipeline::SceneDescription& description) {
  Window window;
  const pipeline::Lattice& whole = description.levels.front();
  const Stage stage = stage_of(description);
  const Eigen::Vector3d centre(state.centre_m[0], state.centre_m[1], state.centre_m[2]);
  if (state.tick == 0 || !centre.allFinite()) {
    window.centre_m = stage.anchor_m;
    window.width_m = (std::max(whole.nx, whole.ny) - 1) * whole.spacing_m;
    window.width_m = std::max(window.width_m, whole.spacing_m);
    return window;
  }
  const std::size_t level = std::min<std::size_t>(state.level, description.levels.size() - 1);
  window.centre_m = centre;
  const pipeline::Lattice& lattice = description.levels[level];
  window.width_m =
      pipeline::window_width_m(static_cast<int>(state.window[2]), static_cast<int>(state.window[3]), lattice.spacing_m);
  window.meant = true;
  return window;
}

Layout layout_of(int width, int height, const ViewSettings& settings) {
  Layout layout;
  width = std::max(width, 64);
  height = std::max(height, 64);
  layout.scale = std::clamp(std::min(width / 1280.0, height / 720.0), 0.6, 4.0) * (settings.large_type ? 1.3 : 1.0);
  const auto px = [&](double value) { return static_cast<int>(std::lround(value * layout.scale)); };
  if (settings.kiosk) {
    layout.detail = {0, 0, width, height};
    const int side = std::min(px(240), width / 4);
    layout.overview = {width - side - px(24), px(24), side, side};
    return layout;
  }
  const int panel = std::min(px(settings.large_type ? 340 : 372), width / 2);
  layout.detail = {0, 0, width - panel, height};
  layout.panel = {width - panel, 0, panel, height};
  const int margin = px(18);
  layout.overview = {width - panel + margin, px(62), panel - 2 * margin, std::max(height - px(62 + 254), 48)};
  return layout;
}

Camera overview_camera(const pipeline::SceneDescription& description, const Rect& rect) {
  const pipeline::Lattice& whole = description.levels.front();
  const double longer = std::max({whole.nx - 1, whole.ny - 1, 1});
  const double half_x = 0.5 * (whole.nx - 1) / longer, half_y = 0.5 * (whole.ny - 1) / longer;
  const double aspect = static_cast<double>(std::max(rect.width, 1)) / std::max(rect.height, 1);
  Camera camera;
  camera.field_rad = 0.0;
  camera.distance = 3.0;
  camera.half_height = 1.03 * std::max({half_y, half_x / aspect, 1e-3});
  return camera;
}

}  // namespace sparsha::viewer
