// Points scattered in space, as stray returns and mixed pixels leave them: they belong to no surface, but among enough
// of them some lie near each other by chance.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/bins.h"
#include "pipeline/projection/extent.h"
#include "pipeline/projection/points.h"

namespace sparsha::pipeline {

/// Space is cut into cubes; a point is scattered where the three by three by three about it hold no more points than
/// chance brings together.
struct ScatterRule {
  static constexpr double kCubeSpacings = 2.4;  ///< side of a cube, point spacings

  double cube_m = 0.0;
  /// Corner of a cube, metres of the oriented points. It moves with the object: their origin is the median of points
  /// that are chosen by a hash, and another origin by a tenth of a cube would count other points together.
  std::array<double, 3> corner_m{};
  std::uint32_t most = 0;  ///< points in 27 cubes, itself among them, that are still chance; 0: nothing is scattered

  /// Bins to each side whose points decide about a point.
  [[nodiscard]] int bins_needed(double node_spacing_m) const;
};

/// From the cubes of columns chosen by a hash of their place. Where points are evenly scattered, those with one other
/// point about them tell how many there are. Sparse parts of a surface are not scattered: most of what is scattered
/// lies before or behind denser points. Depends neither on threads nor on the points' order.
[[nodiscard]] ScatterRule find_scatter(const OrientedPieces& pieces, const PointTotals& totals, const Extent& extent,
                                       double spacing_m);

/// Sets the flag of each scattered point, `skip` (empty or one flag per point) is of those that stay out already.
/// Returns how many of the scattered ones lie in bins of nodes in rows [first_row, last_row), columns [first_column,
/// last_column).
std::uint64_t flag_scattered(const OrientedPoints& points, const ScatterRule& rule, const BinLattice& lattice,
                             const BinWindow& counted, std::vector<std::uint8_t>& skip);

}  // namespace sparsha::pipeline
