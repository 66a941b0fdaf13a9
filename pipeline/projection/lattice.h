// The lattice of a projection from what the configuration asks for and where the points are.
#pragma once

#include <Eigen/Core>

#include "pipeline/projection/extent.h"
#include "scene/config/grid.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// Nodes of a grid whose size nobody gave, at most.
inline constexpr double kMostUnasked = 64.0 * 1024.0 * 1024.0;

/// `extent` is relative to `origin_m`; bounds given in the configuration win over it. Unless a size is given,
/// automatic bounds have nodes up to a quarter spacing beyond them, so that regular data keep their outer rows.
/// Automatic spacing is max(point_spacing_m, resolution_m), and more where the grid would exceed 64 M nodes or 16 nodes
/// per point or corner of a triangle. Throws Error{input} when the points carry no cell; throws Error{usage} when the
/// grid would exceed 2^31 nodes or the machine's memory.
[[nodiscard]] scene::Lattice choose_lattice(const scene::GridConfig& config, const Extent& extent,
                                            const Eigen::Vector3d& origin_m, double point_spacing_m,
                                            double resolution_m);

}  // namespace sparsha::pipeline
