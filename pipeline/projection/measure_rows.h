// Heights of rows of nodes from the points about them, by the method that the plan chose.
#pragma once

#include <cstdint>
#include <vector>

#include "base/threads/context.h"
#include "pipeline/projection/plan.h"
#include "pipeline/projection/points.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// Measures the nodes of `rows`, whose row 0 is row `first_row` of the plan's lattice and which has all of its columns.
/// `window` names the bins of the lattice whose points are among `points`; a node needs those within bins_beyond() of
/// it. The first and last of the rows are decided as at the lattice's border, and so must not be used elsewhere.
/// `skip` names points that stay out. Returns what discs found at each node (DiscNodeKernel::Verdict); empty where the
/// plan has none.
[[nodiscard]] std::vector<std::uint8_t> measure_rows(const OrientedPoints& points,
                                                     const std::vector<std::uint8_t>& skip, const ProjectionPlan& plan,
                                                     const BinWindow& window, int first_row, const Context& context,
                                                     scene::DepthGrid& rows, MemoryStore* store = nullptr);

/// How many bins to each side of a node hold points that decide about it.
[[nodiscard]] int bins_beyond(const ProjectionPlan& plan);

/// Counts the verdicts of all nodes.
void add_verdicts(const std::vector<std::uint8_t>& verdicts, Projection& projection);

}  // namespace sparsha::pipeline
