#include "scene/frame/touched_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "scene/ground/fingertip.h"
#include "scene/scene.h"

namespace sparsha::scene {

BeyondOptions beyond_of(const SceneDescription& scene, const TouchedView& view) {
  const double spacing_m = scene.levels.at(static_cast<std::size_t>(view.level)).spacing_m;
  return {spacing_m, view.scale, scene.config.fill ? scene.config.fill->max_gap_m : 0.0, view.beyond};
}

int margin_of(const SceneDescription& scene, const TouchedView& view) {
  const double spacing_m = scene.levels.at(static_cast<std::size_t>(view.level)).spacing_m;
  const double nodes = std::ceil(view.tip_radius_m / (view.scale * spacing_m));
  const int ball = nodes > 0.0 ? static_cast<int>(std::min(nodes, 1e4)) : 0;
  return std::max(ball, hole_margin(beyond_of(scene, view)));
}

void known_heights(const Layers& layers, bool texture, std::vector<float>& height_m) {
  const bool envelope = !texture && !layers.envelope_m.empty();
  const std::vector<float>& layer = envelope ? layers.envelope_m : layers.grid.height_m;
  height_m.assign(layer.begin(), layer.end());
  for (std::size_t node = 0; node < height_m.size(); ++node)
    if (layers.grid.state[node] == NodeState::unknown) height_m[node] = kUnknownHeight;
}

TouchedHeights read_touched(const Scene& scene, const TouchedView& view) {
  TouchedHeights touched;
  touched.margin = margin_of(scene.description(), view);
  const int more = 2 * touched.margin;
  const Layers layers =
      scene.read(view.level, view.i0 - touched.margin, view.j0 - touched.margin, view.nx + more, view.ny + more);
  touched.lattice = layers.grid.lattice;
  known_heights(layers, view.texture, touched.height_m);
  continue_beyond(touched.height_m, touched.lattice.nx, touched.lattice.ny, beyond_of(scene.description(), view));
  touch_with_ball(touched.height_m, touched.lattice.nx, touched.lattice.ny, touched.lattice.spacing_m,
                  view.tip_radius_m / view.scale);
  return touched;
}

}  // namespace sparsha::scene
