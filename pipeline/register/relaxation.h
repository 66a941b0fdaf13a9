// All poses at once: what pairs of scans say of each other, weighed together.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "base/threads/context.h"
#include "pipeline/register/surface.h"

namespace sparsha::pipeline {

/// A surface and its pose in the common frame.
struct PosedSurface {
  const StationSurface* surface = nullptr;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};
struct Edge {
  std::size_t a = 0;
  std::size_t b = 0;
  bool any_sign = false;  ///< of normals (MatchLimits)
  bool operator==(const Edge&) const = default;
};

/// Moves all poses but the first so that the surfaces of each edge meet: Gauss-Newton on the distances of matches along
/// their mean normals (Rusinkiewicz 2019, "A symmetric objective function for ICP"), Tukey's weights, matches found
/// anew in each iteration, within distances that shrink from `from_m` to `to_m`. Every pose must be linked to the
/// first. Does not depend on the number of threads. Throws Cancelled.
void relax_jointly(std::vector<PosedSurface>& scans, const std::vector<Edge>& edges, double from_m, double to_m,
                   const Context& context);

/// Moves poses on, all but the first's, from where relax_jointly() left them, with matches of all elements: what is
/// left of the noise adds up from station to station (a hall of 40 stations: 3.1 mm at a noise of 3 with samples, 1.6
/// with all).
void settle_jointly(std::vector<PosedSurface>& scans, const std::vector<Edge>& edges, double within_m,
                    const Context& context);

}  // namespace sparsha::pipeline
