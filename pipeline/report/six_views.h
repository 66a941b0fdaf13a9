// A whole object from its six sides, as its charts hold it.
#pragma once

#include "pipeline/report/shading.h"
#include "scene/charts.h"

namespace sparsha::pipeline {

struct SixViews {
  Field light;         ///< 0 to 1; NaN where no sheet faces the viewer. Three views wide, two high
  double width_m = 0;  ///< of the field
};

/// Parallel views of one scale. Above: from the left, from the front, from the right; below: from above, from behind,
/// from below. The y axis of the grid is up, and away from the viewer in the views from above and below. What faces
/// away is not drawn: places that no scan saw stay empty and do not show the inside. Requires a measured node.
[[nodiscard]] SixViews six_views(const scene::Charts& charts);

}  // namespace sparsha::pipeline
