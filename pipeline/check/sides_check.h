// Whether the sheets of a whole object face outwards, judged by the raw points alone: by what stands in the way of rays
// from either side, and by what the scans say of where they were made from.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/check/chart_nodes.h"
#include "pipeline/scan/cloud.h"
#include "scene/charts.h"

namespace sparsha::pipeline {

/// Nodes of sheets that face a side which the points enclose.
struct SidesCheck {
  /// Sheets that lie together.
  struct Place {
    std::uint64_t nodes = 0;
    Eigen::Vector3d min_m, max_m;  ///< their box, scan frame
  };
  std::uint64_t told = 0;     ///< nodes of sheets of which the points tell the side
  std::uint64_t inwards = 0;  ///< of them, those of sheets that face the enclosed side
  std::uint64_t untold = 0;   ///< nodes of sheets that are seen from both sides, or from none
  std::vector<Place> places;  ///< of those that face inwards, the largest first; at most kMostPlaces

  static constexpr std::size_t kMostPlaces = 10;
};

/// `nodes` are those of `charts`. A sheet faces inwards when rays get away from its back and not from its front, unless
/// the scans say that it was seen from its front: rooms are seen from within. Depends neither on threads nor on the
/// points' order.
[[nodiscard]] SidesCheck check_sides(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid,
                                     const scene::Charts& charts, const ChartNodes& nodes, const Context& context);

}  // namespace sparsha::pipeline
