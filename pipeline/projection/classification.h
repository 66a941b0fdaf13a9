// What became of each point: compared with the finished heights around it.
#pragma once

#include <array>
#include <cstdint>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/bins.h"
#include "pipeline/projection/facing.h"
#include "pipeline/projection/points.h"
#include "pipeline/projection/projection.h"

namespace sparsha::pipeline {

/// Writes the point_class of each of the points, and returns how many have each. A point more than the gap below all
/// measured nodes around it is occluded, more than the gap above them an outlier, as is one with no measured node
/// within two spacings; beyond the outer nodes' cells it is outside. A room's wall that is looked through, by `facing`
/// (may be null), is occluded by the others.
[[nodiscard]] std::array<std::uint64_t, 4> classify_points(const OrientedPoints& points, const BinLattice& lattice,
                                                           const scene::DepthGrid& grid, double gap_m,
                                                           const FacingField* facing, ThreadPool& pool,
                                                           PointClass* point_class);

/// Adds such counts to the projection's.
void add_classes(const std::array<std::uint64_t, 4>& counts, Projection& projection);

}  // namespace sparsha::pipeline
