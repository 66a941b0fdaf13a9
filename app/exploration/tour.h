// What the simulated hand shows of a scene.
#pragma once

#include <vector>

#include "haptics/device/simulated/exploration_script.h"
#include "scene/scene_fwd.h"

namespace sparsha::app {

/// Strikes the scene's first clip and up to three of its notes, then strokes its largest part, with one zoom on the
/// way. Empty for a scene without parts and sounds. Device frame of a window on the whole scene.
[[nodiscard]] std::vector<haptics::TourStop> tour_of(const scene::SceneDescription& scene);

}  // namespace sparsha::app
