// Noise and spacing of the front points, from small blocks chosen by a hash.
#pragma once

#include <optional>

#include "pipeline/projection/extent.h"
#include "pipeline/projection/points.h"

namespace sparsha::pipeline {

/// What neighbourhoods in space tell of the surface.
struct SpaceStatistics {
  /// Share of neighbourhoods in space that are steep, of those that are flat: about a half on a closed object, hardly
  /// any on a relief. And the side of the square that a point occupies on them, median; 0 where there are none.
  double steep_share = 0.0;
  double steep_area = 0.0;  ///< the same by area: steep parts may be sparse
  double surface_spacing_m = 0.0;
  /// Share of places that have another flat layer below the highest, as a plate or a coin has, and the median distance
  /// across the two. `tilt`: mean slope of such an object against the view.
  double layered_share = 0.0;
  double layers_apart_m = 0.0;
  double tilt = 0.0;
};

struct CloudStatistics {
  double noise_m = 0.0;          ///< standard deviation of heights about local quadrics
  double point_spacing_m = 0.0;  ///< median of 1/sqrt(front points per square metre), each front point counting once
  SpaceStatistics in_space;
  /// Where many points lie on one line with their nearest neighbours, as on the lines of a scanner that are farther
  /// apart than the points on them: the same from neighbourhoods that hold several lines.
  std::optional<SpaceStatistics> on_lines;
};

/// Depends neither on threads nor on the points' order.
[[nodiscard]] CloudStatistics sample_cloud(const OrientedPieces& pieces, const Extent& extent, ThreadPool& pool);

/// The same of space, from neighbourhoods `scale` times as wide of points `spacing_m` apart: where points scatter as
/// far as they are apart, narrow ones stand upright on a relief, too.
[[nodiscard]] SpaceStatistics space_statistics(const OrientedPieces& pieces, const Extent& extent, double spacing_m,
                                               std::size_t scale, ThreadPool& pool);

}  // namespace sparsha::pipeline
