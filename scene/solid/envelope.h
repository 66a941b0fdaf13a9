// The smoother surface behind the nodes of a whole object.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/solid/surface_nodes.h"

namespace sparsha::scene {

/// A bilateral mean (Tomasi & Manduchi 1998; of surfaces Fleishman et al. 2003) of nodes in a place's tangent frame.
/// Immutable; any thread.
class Envelope {
 public:
  /// With an infinite `sigma_range_m` it is a Gaussian mean.
  Envelope(double sigma_space_m, double sigma_range_m);

  /// Of nodes that count, for a mean of this kind.
  [[nodiscard]] static double reach_m(double sigma_space_m) { return kReach * sigma_space_m; }

  /// How far a place lies before the mean of the nodes about it, metres along its normal; 0 without any. Nodes that
  /// face away by more than 60 degrees do not count; others do by their area.
  [[nodiscard]] double operator()(const Eigen::Vector3d& place_m, const Eigen::Vector3d& normal,
                                  const std::vector<SurfaceNode>& about) const;

 private:
  static constexpr double kReach = 3.0;  // sigmas

  double reach_2_, space_, range_;
};

}  // namespace sparsha::scene
