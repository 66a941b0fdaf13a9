// The spectrum that the measured heights of a scene follow.
#pragma once

#include "scene/material/height_spectrum.h"
#include "scene/scene_fwd.h"

namespace sparsha::scene {

/// Of the measured heights of level 0: the same for every window of the scene. Rows and columns of patches spread over
/// the level; a patch without a measured profile gives nothing. Throws Error{input} when tiles cannot be read.
[[nodiscard]] HeightSpectrum measure_spectrum(const Scene& scene);

}  // namespace sparsha::scene
