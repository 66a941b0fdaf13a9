// What of a mesh hangs together: filters that judge corners by their distances must not take large triangles for noise.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// stays[i] = 1 for corners of pieces, triangles joined by corners of equal place, that have at least `least_share` of
/// the area of all triangles, 0 to 1. Depends on no order of points or faces but for rounding.
[[nodiscard]] std::vector<std::uint8_t> corners_of_large_pieces(const Cloud& mesh, double least_share);

/// Share of the triangles' area, 0 to 1, of those with a corner whose keep is 0.
[[nodiscard]] double share_of_area_lost(const Cloud& mesh, const std::vector<std::uint8_t>& keep);

}  // namespace sparsha::pipeline
