// Nearest point of a cloud to each of some nodes, with trees over only those points that can be the answer.
#pragma once

#include <cstdint>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/check/check.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// Signed distance from each node (ascending indices) to its nearest point, positive when that point is nearer to the
/// viewer; infinite without points. Exact; `point_spacing_m` tunes the first try.
[[nodiscard]] std::vector<float> nearest_point_distances(const scene::DepthGrid& grid,
                                                         const std::vector<std::uint64_t>& nodes,
                                                         const CountedPoints& points, double point_spacing_m,
                                                         ThreadPool& pool);

}  // namespace sparsha::pipeline
