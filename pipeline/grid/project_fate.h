// What became of each point: compared with the finished heights around it.
#pragma once

#include "pipeline/base/thread_pool.h"
#include "pipeline/grid/project.h"
#include "pipeline/grid/project_bins.h"
#include "pipeline/grid/project_points.h"

namespace sparsha::pipeline {

/// Fills fate and its counts. A point more than the gap below all measured nodes around it is occluded, more than the
/// gap above them an outlier, as is one with no measured node within two spacings; beyond the outer nodes' cells it is
/// outside.
void classify_points(const OrientedPoints& points, const BinLattice& lattice, ThreadPool& pool, Projection& projection);

}  // namespace sparsha::pipeline
