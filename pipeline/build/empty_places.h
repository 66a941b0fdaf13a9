// Parts, sounds and lines of a configuration that lie where the scene has nothing.
#pragma once

#include "base/threads/progress.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// A warning for each that was drawn for another grid, in another unit or on another label image. Throws Error{input}
/// when the label image cannot be read.
void warn_of_empty_places(const scene::SceneDescription& scene, Progress& progress);

}  // namespace sparsha::pipeline
