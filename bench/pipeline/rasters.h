// The rasters of every GIS: one height per cell from the points in it, whatever layers these lie on.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "scene/depth_grid.h"

namespace sparsha::bench {

enum class RasterRule {
  max,              ///< the highest point of the cell: a z-buffer of points
  mean,             ///< of the cell's heights
  median,           ///< of the cell's heights; of an even number the upper one of the middle
  inverse_distance  ///< mean of the points within 1.5 cells, weighted by 1 / d^2 (Shepard 1968)
};
[[nodiscard]] const char* name_of(RasterRule rule);

/// Points in metres, in the frame of the lattice; a cell is the square of one spacing about its node. Nodes without a
/// point are unknown. One thread.
[[nodiscard]] scene::DepthGrid raster(std::span<const std::array<double, 3>> points, const scene::Lattice& lattice,
                                      RasterRule rule);

}  // namespace sparsha::bench
