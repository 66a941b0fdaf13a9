// Sheets of a whole object from its raw points: the surface that tangent discs define, looked at along six axes, every
// layer that faces one of them and not only the highest (docs/use/whole-objects.md).
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/scan/cloud.h"
#include "scene/charts.h"
#include "scene/config/grid.h"

namespace sparsha::pipeline {

/// What charts are made by.
struct ChartRule {
  double least_facing = 0.4;    ///< cosine of a node's normal and the chart's direction, at least
  std::size_t least_nodes = 9;  ///< of a sheet; smaller ones are left out and counted
};

/// Charts of a cloud, and what was found on the way.
struct ChartResult {
  scene::Charts charts;
  double point_spacing_m = 0.0;       ///< median, on the surface
  double noise_m = 0.0;               ///< standard deviation across the surface
  std::uint64_t discs = 0;            ///< points with a tangent plane
  std::uint64_t discs_undecided = 0;  ///< of them, those of which nothing tells the outer side; they are left out
  std::uint64_t discs_thin = 0;  ///< of them, those of walls thinner than SidedDiscs::kThinSpacings; they are left out
  std::uint64_t discs_thin_agreed = 0;  ///< of these, those with at least three discs opposite; fewer may be noise
  double mixed_share = 0.0;  ///< of the surface, 0 to 1: two faces of thin walls that are taken for one (MixedFaces)
  std::uint64_t discs_outside = 0;  ///< of them, those outside the object's box, which supported points span
  std::uint64_t layers = 0;         ///< nodes of all sheets and of those that were left out
  std::uint64_t small_sheets = 0;   ///< left out
  std::uint64_t small_sheet_nodes = 0;
};

/// `config` chooses the spacing of nodes as for a depth grid, except that bounds do not count. `scan_to_grid` is the
/// orientation. Depends neither on threads nor on the points' order. Throws Error{input} when the points form no
/// surface or nothing tells which side of it is outside; UnevenPoints, an Error{input}; Error{usage} when the charts
/// would exceed memory.
[[nodiscard]] ChartResult make_charts(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid,
                                      const scene::GridConfig& config, double resolution_m, const Context& context,
                                      const ChartRule& rule = {});

}  // namespace sparsha::pipeline
