// How many points lie about a node of a coarse grid, told from a sample before the points go to disk.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/outofcore/memory.h"
#include "pipeline/projection/projection.h"
#include "scene/config/grid.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// What a projection of a sample says of that of all points.
struct SampledGrid {
  scene::Lattice lattice;  ///< as of all points, but for the outermost of these
  ProjectionNeeds needs;
};
/// `sample_m` in the scan frame, metres. Nothing for grids without a size or spacing, which the points' distance
/// decides, and where the sample alone cannot be projected.
[[nodiscard]] std::optional<SampledGrid> sampled_grid(const std::vector<Eigen::Vector3d>& sample_m,
                                                      const Eigen::Matrix4d& scan_to_grid,
                                                      const scene::GridConfig& config, double resolution_m,
                                                      const Context& context);

/// Throws Error{failure}, with the memory that is enough, where the points about a single node of a closed object
/// surely do not fit: they must be in memory at once. `sample_m` is of so many `points`; nothing is decided where it
/// leaves the matter open.
void require_room_about_nodes(const MemoryLimit& limit, const std::vector<Eigen::Vector3d>& sample_m,
                              std::uint64_t points, const Eigen::Matrix4d& scan_to_grid, const SampledGrid& grid);

}  // namespace sparsha::pipeline
