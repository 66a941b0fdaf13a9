// Whole objects for haptic windows.
#pragma once

#include <memory>

#include "haptics/around/object_surface.h"
#include "haptics/servo/command.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// The scene's whole object. Friction is the law of the scene by the curvature of the texture, where the charts know
/// it, and the parts' own; without texture it is the envelope, where the charts have one. Throws Error{failure} for a
/// scene without charts.
[[nodiscard]] std::shared_ptr<const ObjectSurface> whole_object(const scene::SceneDescription& scene,
                                                                const Effects& effects);

/// Gives the window, whose surface and effects are set, the scene's whole object; it lives as long as the surface. What
/// another window of the same charts holds is not made again. Throws Error{failure} for a scene without charts.
void attach_object(HapticWindow& window, const scene::SceneDescription& scene);

}  // namespace sparsha::haptics
