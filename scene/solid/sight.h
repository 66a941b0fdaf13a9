// What somebody meets first who looks at a whole object along a line.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "scene/charts.h"
#include "scene/solid/surface_nodes.h"

namespace sparsha::scene {

/// The nodes of all sheets as discs in their tangent planes, as wide as the distance to their neighbours. Immutable;
/// any thread.
class Sight {
 public:
  explicit Sight(const Charts& charts);

  /// A place of the surface and its outward normal, grid frame.
  struct Place {
    Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  };
  /// The first place on a line from `from_m` along `direction` (not zero), grid frame, of a face that looks towards
  /// `from_m`. Empty where there is none.
  [[nodiscard]] std::optional<Place> along(const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction) const;
  /// The node's plane that is nearest to a place within some spacings; empty without one.
  [[nodiscard]] std::optional<Place> nearest(const Eigen::Vector3d& at_m) const;

 private:
  static constexpr double kReach = 3.0;  // spacings

  Eigen::Vector3d origin_m_;
  double spacing_m_;
  Eigen::AlignedBox3d box_m_;  // of the nodes, relative to the origin
  SurfaceNodes nodes_;
};

}  // namespace sparsha::scene
