// What the surface of a window carries besides its shape: impact, grain, and the parts' own stiffness and material.
#pragma once

#include <memory>

#include "haptics/effects/surface_effects.h"
#include "haptics/window/scene_window.h"
#include "scene/scene.h"

namespace sparsha::haptics {

/// Null when the plan has neither impact nor grain and no part a stiffness: then touch is what it is without all that.
/// With grain the spectrum of level 0 is fitted. Throws Error{input} when tiles cannot be read.
[[nodiscard]] std::shared_ptr<const SurfaceEffects> make_effects(const pipeline::Scene& scene, const WindowPlan& plan);

/// Of the measured heights of level 0: the same for every window of the scene. Rows and columns of patches spread over
/// the level; a patch without a measured profile gives nothing.
[[nodiscard]] HeightSpectrum measure_spectrum(const pipeline::Scene& scene);

}  // namespace sparsha::haptics
