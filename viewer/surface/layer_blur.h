// Means and second differences of heights that stay on a node's own surface.
#pragma once

#include <vector>

#include "viewer/surface/relief_data.h"

namespace sparsha::viewer {

/// Heights of known nodes, metres, as means over 2 * radius + 1 nodes, twice along rows and then twice along columns,
/// as blur() does; other nodes keep theirs. No mean goes beyond a depth step, an unknown node or the lattice's border:
/// it narrows towards them, to both sides alike, so that a slope keeps its heights.
[[nodiscard]] std::vector<float> blur_on_layers(const ReliefData& relief, int radius);

/// Sum of the second differences of blur_on_layers() along both axes, metres per squared spacing. Beside a step it is
/// that of the nearest node of the row (column) whose means are whole. NaN at unknown nodes and where a row (column)
/// has less than three nodes of the surface.
[[nodiscard]] std::vector<double> laplacian_on_layers(const ReliefData& relief, int radius);

}  // namespace sparsha::viewer
