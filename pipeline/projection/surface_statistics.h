// Noise and spacing of a cloud as a surface in space: neither depends on the direction of view.
#pragma once

#include <cstddef>
#include <limits>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/extent.h"
#include "pipeline/projection/points.h"

namespace sparsha::pipeline {

struct SurfaceStatistics {
  double noise_m = 0.0;    ///< standard deviation of the points across the surface
  double spacing_m = 0.0;  ///< median side of the square that a point occupies on the surface; 0: no surface was found
  double front_spacing_m = 0.0;    ///< the same of the places that nothing hides from the viewer
  double sparse_share = 0.0;       ///< of places: those whose points are more than twice that far apart
  double sparse_flat_share = 0.0;  ///< of places: those whose points are farther apart than asked, and lie in a plane
  bool flat = false;               ///< most neighbourhoods have a plane
  /// How many spacings wide a neighbourhood has to be drawn so that it is flat in spite of the noise: 1, or 2, 4, 8
  /// where the noise exceeds about half a spacing.
  std::size_t scale = 1;
};

/// From neighbourhoods in space (k nearest points) of points chosen by a hash, about `spacing_m` apart. Depends neither
/// on threads nor on the points' order. `sparse_m` is asked for sparse_flat_share.
[[nodiscard]] SurfaceStatistics surface_statistics(const OrientedPieces& pieces, const Extent& extent, double spacing_m,
                                                   bool on_lines, ThreadPool& pool,
                                                   double sparse_m = std::numeric_limits<double>::infinity());

}  // namespace sparsha::pipeline
