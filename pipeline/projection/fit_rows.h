// Heights of some rows of nodes from the bins about them.
#pragma once

#include "base/threads/context.h"
#include "pipeline/projection/bins.h"
#include "pipeline/projection/node_fitter.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// Measures the nodes of `rows`, whose row 0 is row `first_row` of the bins' lattice and which has all of its columns.
/// The first and last of the rows are decided as at the lattice's border, and so must not be used elsewhere.
void fit_rows(const Bins& bins, const NodeFitParameters& rule, double gap_m, int first_row, const Context& context,
              scene::DepthGrid& rows);

/// How many bins to each side of a node its fit may look at.
[[nodiscard]] int widest_look(const NodeFitParameters& rule);

}  // namespace sparsha::pipeline
