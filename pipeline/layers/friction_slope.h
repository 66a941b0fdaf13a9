// Which nodes tell how rough an object is.
#pragma once

#include <vector>

#include "pipeline/layers/surface_links.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// The 95th percentile of `k` over measured nodes where it is not NaN, but for those on steep flanks, where the view
/// stretches the texture's height: all neighbours on the same layer lie within `steep_m`. Nodes within `radius` of the
/// lattice's border count only where there are no others.
[[nodiscard]] double curvature_percentile(const scene::DepthGrid& grid, const std::vector<float>& k,
                                          const SurfaceLinks& links, int radius, double steep_m);

}  // namespace sparsha::pipeline
