// What noise is left at the nodes of sheets is averaged over as many neighbours as the surface lets.
#pragma once

#include <vector>

#include "base/threads/context.h"
#include "scene/charts.h"

namespace sparsha::pipeline {

/// Heights and slopes of measured nodes become those of a quadratic surface through the nodes of a square window about
/// each (Savitzky & Golay 1964), as wide as the surface goes on like that within the noise (Lepski 1990), at most 13
/// nodes. A node whose window is cut by the sheet's border, or whose neighbours differ from every such surface by more
/// than noise, as at edges, stays as it is. `noise_m` is that of the points, across the surface; 0 changes nothing.
void smooth_sheets(std::vector<scene::Sheet>& sheets, double spacing_m, double noise_m, const Context& context);

}  // namespace sparsha::pipeline
