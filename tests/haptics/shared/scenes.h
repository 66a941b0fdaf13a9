// Scenes of known surfaces in memory, for tests of touch.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "pipeline/scene/scene.h"

namespace sparsha::testing {

/// Height in metres over (x, y); NaN = never measured.
using HeightFunction = std::function<double(double x, double y)>;

/// `nodes` x `nodes` over a square of `width_m` with its lower left corner at (x0, y0), as many levels as get it down
/// to `window` nodes, each sampled from the function itself.
inline pipeline::ScenePointer scene_of(const HeightFunction& height_m, int nodes, double width_m, int window = 200,
                                       Eigen::Vector3d origin_m = Eigen::Vector3d::Zero(),
                                       const std::function<void(pipeline::SceneDescription&)>& adjust = {}) {
  pipeline::SceneDescription description;
  description.config.levels.window = window;
  std::vector<pipeline::Layers> levels;
  double spacing_m = width_m / (nodes - 1);
  description.height_min_m = std::numeric_limits<double>::infinity();
  description.height_max_m = -description.height_min_m;
  for (int n = nodes;; n = (n + 1) / 2) {
    pipeline::Lattice lattice;
    lattice.nx = lattice.ny = n;
    lattice.spacing_m = spacing_m;
    lattice.origin_m = origin_m;
    pipeline::Layers layers;
    layers.grid = pipeline::DepthGrid(lattice);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double z = height_m(lattice.x_m(i), lattice.y_m(j)) - origin_m.z();
        if (std::isnan(z)) continue;
        layers.grid.height_m[lattice.index(i, j)] = static_cast<float>(z);
        layers.grid.state[lattice.index(i, j)] = pipeline::NodeState::measured;
        description.height_min_m = std::min(description.height_min_m, z + origin_m.z());
        description.height_max_m = std::max(description.height_max_m, z + origin_m.z());
      }
    description.levels.push_back(lattice);
    levels.push_back(std::move(layers));
    spacing_m *= 2.0;
    if (n <= window) break;
  }
  if (adjust) adjust(description);
  return pipeline::make_scene(std::move(description), std::move(levels));
}

inline pipeline::ScenePointer flat_scene(double z_m = 0.0, int nodes = 101, double width_m = 0.1) {
  return scene_of([z_m](double, double) { return z_m; }, nodes, width_m);
}

/// Gentle hills, 4 mm high on 100 mm.
inline double hills_m(double x, double y) { return 0.004 * std::sin(80.0 * x + 0.3) * std::cos(65.0 * y - 0.2); }

}  // namespace sparsha::testing
