// Points on disk as a cross-check asks for them.
#pragma once

#include <Eigen/Core>

#include "base/threads/progress.h"
#include "pipeline/check/check.h"
#include "pipeline/outofcore/tiled_projection.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// The counted ones of `points`, relative to the lattice's origin; refers to `points` and `progress`. Throws Cancelled.
[[nodiscard]] CountedPoints counted_points(const BucketedPoints& points, const Eigen::Matrix4d& scan_to_grid,
                                           const scene::Lattice& lattice, const Progress& progress);

}  // namespace sparsha::pipeline
