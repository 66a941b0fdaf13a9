// A view of the scanned points that shows what each filter took away.
#pragma once

#include "pipeline/report/images.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// True when a filter took points away that can be shown.
[[nodiscard]] bool has_filter_picture(const Report& report);

/// The points that were left in grey, those taken away in one colour a filter, seen from above to the right of the
/// grid's viewer; edges are darkened by depth (Boucheny 2009, eye-dome lighting).
[[nodiscard]] Picture filter_picture(const scene::SceneDescription& scene, const Report& report);

}  // namespace sparsha::pipeline
