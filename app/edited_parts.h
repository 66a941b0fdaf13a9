// Parts that were drawn or moved on the stone become a scene that is touched, and its file.
#pragma once

#include <vector>

#include "scene/config.h"
#include "scene/scene.h"

namespace sparsha::app {

/// The same layers with these parts, written into the scene's folder where it has one. Throws Error{failure} when that
/// cannot be written; it is then as it was.
[[nodiscard]] pipeline::ScenePointer with_parts(const pipeline::ScenePointer& scene,
                                                const std::vector<pipeline::PartConfig>& parts);

/// From the scans to the grid that a scene's parts are written in; where it was turned, that of the scene before.
[[nodiscard]] const Eigen::Matrix4d& parts_frame(const pipeline::SceneDescription& scene);

}  // namespace sparsha::app
