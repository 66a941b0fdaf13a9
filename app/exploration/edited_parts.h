// Parts that were drawn or moved on the stone become a scene that is touched, and its file.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/config/parts.h"
#include "scene/scene_fwd.h"

namespace sparsha::app {

/// The same layers with these parts, written into the scene's folder where it has one. Throws Error{failure} when that
/// cannot be written; it is then as it was.
[[nodiscard]] scene::ScenePointer with_parts(const scene::ScenePointer& scene,
                                             const std::vector<scene::PartConfig>& parts);

/// From the scans to the grid that a scene's parts are written in; where it was turned, that of the scene before.
[[nodiscard]] const Eigen::Matrix4d& parts_frame(const scene::SceneDescription& scene);

}  // namespace sparsha::app
