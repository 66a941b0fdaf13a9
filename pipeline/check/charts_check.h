// Charts of a whole object held against the raw points, and against each other.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/check/check.h"
#include "pipeline/check/sides_check.h"
#include "pipeline/scan/cloud.h"
#include "scene/charts.h"
#include "scene/config/config.h"

namespace sparsha::pipeline {

struct ChartCheck {
  std::uint64_t points = 0;   ///< of the cloud
  std::uint64_t sampled = 0;  ///< of them
  std::uint64_t far = 0;      ///< of those sampled: no node within kFarSpacings; not among the distances
  /// Each other one to the tangent plane of the nearest node; positive outside the object.
  DistanceStatistics cloud_to_surface;
  /// Of nodes, to the tangent plane of the nearest node of another side that faces the same way within 30 degrees.
  DistanceStatistics agreement;
  std::uint64_t nodes = 0;        ///< looked at for this
  std::uint64_t nodes_alone = 0;  ///< of them, those where no sheet of another side is
  SidesCheck sides;
  /// Of some of the sampled points that are not far.
  struct Place {
    Eigen::Vector3f place_m;  ///< grid frame, from the charts' origin
    Eigen::Vector3f normal;   ///< of the nearest node
    float distance_m;         ///< from its tangent plane
  };
  std::vector<Place> places;  ///< at most 200 000

  static constexpr double kFarSpacings = 3.0;  ///< of nodes
};

/// Of every point, or of as many as `config` says, chosen by a hash of their coordinates; of at most 200 000 nodes.
[[nodiscard]] ChartCheck check_charts(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid,
                                      const scene::Charts& charts, const scene::CheckConfig& config,
                                      const Context& context);

}  // namespace sparsha::pipeline
