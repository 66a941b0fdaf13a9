// The window that the servo has told of, read once more for the pointer's hand.
#include "viewer/surface/touch_ground.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>

#include "scene/scene.h"

namespace sparsha::viewer {

void TouchGround::follow(const scene::ScenePointer& scene, const haptics::State& state, bool wait) {
  if (loading_.valid() && (wait || loading_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)) {
    try {
      heights_ = loading_.get();
    } catch (const std::exception&) {  // the servo reads the same tiles and says so
    }
    held_ = wanted_;
  }
  constexpr std::int64_t kMostNodes = 1 << 14;
  const bool usable = state.tick != 0 && scene != nullptr && state.level < scene->description().levels.size() &&
                      state.scale > 0.0 && std::isfinite(state.scale) && state.tip_radius_m >= 0.0 &&
                      state.window[2] >= 2 && state.window[3] >= 2 && state.window[2] <= kMostNodes &&
                      state.window[3] <= kMostNodes;
  if (!usable) return;
  const auto node = [](std::int64_t value) {
    return static_cast<int>(std::clamp<std::int64_t>(value, -(1 << 29), 1 << 29));
  };
  const Window window{
      scene.get(),
      {static_cast<int>(state.level), node(state.window[0]), node(state.window[1]), node(state.window[2]),
       node(state.window[3]), state.scale, state.tip_radius_m, (state.flags & haptics::kFlagTexture) != 0,
       scene::beyond_of((state.flags & haptics::kFlagFalls) != 0, (state.flags & haptics::kFlagRim) != 0)}};
  asked_ = window;
  if (loading_.valid() || window == wanted_) return;
  if (window.scene != wanted_.scene) heights_.reset();
  wanted_ = window;
  loading_ = std::async(std::launch::async, [scene, window] { return scene::read_touched(*scene, window.view); });
  if (wait) follow(scene, state, true);
}

std::optional<double> TouchGround::height_at(double x_m, double y_m) const {
  if (!heights_ || (waits() && !held_.same_view(asked_))) return std::nullopt;
  const scene::Lattice& lattice = heights_->lattice;
  // Beyond the window the servo continues its border, and not what lies in the margin.
  const double first = heights_->margin;
  const double place_x = (x_m - lattice.origin_m.x()) / lattice.spacing_m;
  const double place_y = (y_m - lattice.origin_m.y()) / lattice.spacing_m;
  const double x = std::clamp(place_x, first, lattice.nx - 1.0 - first);
  const double y = std::clamp(place_y, first, lattice.ny - 1.0 - first);
  if (!std::isfinite(x) || !std::isfinite(y)) return std::nullopt;
  if (waits() && (x != place_x || y != place_y)) return std::nullopt;
  const int i = std::min(static_cast<int>(x), lattice.nx - 2), j = std::min(static_cast<int>(y), lattice.ny - 2);
  const double u = x - i, v = y - j;
  const auto at = [&](int a, int b) { return static_cast<double>(heights_->height_m[lattice.index(a, b)]); };
  return lattice.origin_m.z() + (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) +
         v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

}  // namespace sparsha::viewer
