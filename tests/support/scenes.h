// Scenes of known surfaces in memory.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace sparsha::test {

/// Height in metres over (x, y); NaN = never measured.
using HeightFunction = std::function<double(double x, double y)>;
using EditDescription = std::function<void(scene::SceneDescription&)>;
using EditLayers = std::function<void(scene::Layers&)>;

struct SceneOptions {
  int nx = 256;
  int ny = 256;
  double spacing_m = 0.001;
  int levels = 1;  ///< level L takes every 2^L-th node
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
};

/// `height_m` above the origin at x, y in metres from node (0, 0). A window has 100 nodes per side.
inline scene::ScenePointer scene_of(const HeightFunction& height_m, const SceneOptions& options,
                                    const EditDescription& edit = {}, const EditLayers& edit_layers = {}) {
  scene::SceneDescription description;
  description.config.levels.window = 100;
  description.height_min_m = std::numeric_limits<double>::infinity();
  description.height_max_m = -description.height_min_m;
  std::vector<scene::Layers> levels;
  for (int level = 0; level < options.levels; ++level) {
    const int step = 1 << level;
    const scene::Lattice lattice{(options.nx - 1) / step + 1, (options.ny - 1) / step + 1, options.spacing_m * step,
                                 options.origin_m};
    scene::Layers layers;
    layers.grid = scene::DepthGrid(lattice);
    for (int j = 0; j < lattice.ny; ++j)
      for (int i = 0; i < lattice.nx; ++i) {
        const double z_m = height_m(i * lattice.spacing_m, j * lattice.spacing_m);
        if (!std::isfinite(z_m)) continue;
        layers.grid.height_m[lattice.index(i, j)] = static_cast<float>(z_m);
        layers.grid.state[lattice.index(i, j)] = scene::NodeState::measured;
        description.height_min_m = std::min(description.height_min_m, options.origin_m.z() + z_m);
        description.height_max_m = std::max(description.height_max_m, options.origin_m.z() + z_m);
      }
    if (edit_layers) edit_layers(layers);
    description.levels.push_back(lattice);
    levels.push_back(std::move(layers));
  }
  if (edit) edit(description);
  return scene::make_scene(std::move(description), std::move(levels));
}

/// `nodes` x `nodes` over a square of `width_m` with its lower left corner at the origin, as many levels as get it down
/// to `window` nodes. `height_m` in the grid frame.
inline scene::ScenePointer scene_of(const HeightFunction& height_m, int nodes, double width_m, int window = 200,
                                    const Eigen::Vector3d& origin_m = Eigen::Vector3d::Zero(),
                                    const EditDescription& adjust = {}) {
  SceneOptions options{nodes, nodes, width_m / (nodes - 1), 1, origin_m};
  for (int n = nodes; n > window; n = (n + 1) / 2) ++options.levels;
  const auto above_origin = [&](double x, double y) {
    return height_m(origin_m.x() + x, origin_m.y() + y) - origin_m.z();
  };
  return scene_of(above_origin, options, [&](scene::SceneDescription& description) {
    description.config.levels.window = window;
    if (adjust) adjust(description);
  });
}

inline scene::ScenePointer flat_scene(double z_m = 0.0, int nodes = 101, double width_m = 0.1) {
  return scene_of([z_m](double, double) { return z_m; }, nodes, width_m);
}

/// Gentle hills, 4 mm high on 100 mm.
inline double hills_m(double x, double y) { return 0.004 * std::sin(80.0 * x + 0.3) * std::cos(65.0 * y - 0.2); }

}  // namespace sparsha::test
