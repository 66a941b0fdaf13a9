// Colour and intensity of the front surface at the nodes.
#pragma once

#include "pipeline/base/thread_pool.h"
#include "pipeline/grid/project.h"
#include "pipeline/grid/project_bins.h"
#include "pipeline/grid/project_points.h"
#include "pipeline/grid/project_triangles.h"

namespace sparsha::pipeline {

/// Fills projection.colour_rgba and intensity where asked for and present: inside a triangle by barycentric weights,
/// else the mean of used points, weighted towards the node. Integer sums, so that the points' order does not matter.
/// Nodes without a used point near get transparent black and NaN.
void project_attributes(const Cloud& cloud, const OrientedPoints& points, const BinLattice& lattice,
                        const TriangleHeights& mesh, const GridConfig& config, ThreadPool& pool,
                        Projection& projection);

}  // namespace sparsha::pipeline
