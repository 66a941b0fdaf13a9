// What the surface of a window carries besides its shape: impact, grain, and the parts' own stiffness and material.
#pragma once

#include <memory>

#include "haptics/effects/surface_effects.h"
#include "haptics/window/window.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// Null when the plan has neither impact nor grain nor cues and no part a stiffness: then touch is what it is without
/// all that. `heights`: of the plan's window, and around it. With grain the spectrum of level 0 is fitted. Throws
/// Error{input} when tiles cannot be read.
[[nodiscard]] std::shared_ptr<const SurfaceEffects> make_effects(const scene::Scene& scene, const WindowPlan& plan,
                                                                 const scene::DepthGrid& heights);

}  // namespace sparsha::haptics
