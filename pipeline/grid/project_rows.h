// Heights of some rows of nodes from the bins about them.
#pragma once

#include "pipeline/base/progress.h"
#include "pipeline/base/thread_pool.h"
#include "pipeline/grid/project_bins.h"
#include "pipeline/grid/project_node.h"
#include "pipeline/scene/depth_grid.h"

namespace sparsha::pipeline {

/// Measures the nodes of `rows`, whose row 0 is row `first_row` of the bins' lattice and which has all of its columns.
/// The first and last of the rows are decided as at the lattice's border, and so must not be used elsewhere.
void fit_rows(const Bins& bins, const NodeRule& rule, double gap_m, int first_row, ThreadPool& pool, Progress& progress,
              DepthGrid& rows);

/// How many bins to each side of a node its fit may look at.
[[nodiscard]] int widest_look(const NodeRule& rule);

}  // namespace sparsha::pipeline
