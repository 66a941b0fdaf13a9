// Whole objects for haptic windows.
#pragma once

#include "haptics/around/sheet_surface.h"
#include "haptics/servo/command.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// Coefficients of a whole object: where the curvature is not known, the law says mu_0. Zero without friction.
[[nodiscard]] AroundFriction around_friction(const scene::SceneDescription& scene, bool friction);

/// Gives the window, whose surface and effects are set, the scene's whole object; it lives as long as the surface. What
/// another window of the same charts holds is not made again. Throws Error{failure} for a scene without charts.
void attach_object(HapticWindow& window, const scene::SceneDescription& scene);

}  // namespace sparsha::haptics
