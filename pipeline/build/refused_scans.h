// The errors that tell why scans are not built, or not within a memory limit.
#pragma once

#include <cstdint>
#include <vector>

#include "base/error.h"
#include "base/threads/progress.h"
#include "pipeline/filter/streamed.h"
#include "pipeline/outofcore/memory.h"
#include "pipeline/scan/set.h"
#include "scene/config/filters.h"
#include "scene/depth_grid.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

[[nodiscard]] Error no_points(const scene::Config& config);

/// Before memory is taken for what cannot be there: a system that grants more than it has kills the program later.
/// Throws Error{usage}. `bytes`: what the nodes need.
void require_room(const scene::Lattice& lattice, std::uint64_t bytes);

/// Faces, and filters that look farther than a point, are not for points on disk: throws Error{failure}. `bytes`: what
/// memory and grid need; 0 where that is not known.
void require_points_only(const ScanAmount& amount, const std::vector<scene::FilterConfig>& filters,
                         std::uint64_t bytes);

/// Of a whole object, `around`, or an unrolled one, whose points are built in memory only and need so many `bytes`,
/// with or without those of the grid.
[[nodiscard]] Error refusal_in_memory(bool around, std::uint64_t points, std::uint64_t bytes, bool with_grid);

/// Of a voxel filter that leaves too many points: goes through the scans once more to tell how many. `streamed`: the
/// filters before it.
[[nodiscard]] Error refusal_of_voxels(const ScanSet& scans, StreamedFilters& streamed,
                                      const scene::FilterConfig& filter, Progress& progress);

}  // namespace sparsha::pipeline
