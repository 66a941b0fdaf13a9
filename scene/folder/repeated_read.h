// Reading over the seam of an unrolled cylinder, whose picture repeats.
#pragma once

#include "scene/depth_grid.h"
#include "scene/scene_fwd.h"

namespace sparsha::scene {

/// After how many nodes a level repeats; 0 where it does not.
[[nodiscard]] int nodes_around(const SceneDescription& scene, int level);

/// Scene::read(), and columns beyond an unrolled cylinder's picture are those of its other side, as often as it takes.
[[nodiscard]] Layers read_repeated(const Scene& scene, int level, int i0, int j0, int nx, int ny);

}  // namespace sparsha::scene
