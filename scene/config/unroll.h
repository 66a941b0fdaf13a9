// The configuration's block `unroll`.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace sparsha::scene {

/// A column or vase that is unrolled from a cylinder or cone into one height field (scene/frame/unrolling.h). What is
/// absent is looked for in the points when the scene is built; a scene holds everything.
struct UnrollConfig {
  enum class Shape { automatic, cylinder, cone };
  Shape shape = Shape::automatic;
  std::optional<Eigen::Vector3d> axis;      ///< direction in the scan frame, any length but 0
  std::optional<Eigen::Vector3d> centre_m;  ///< a point on the axis, scan frame
  std::optional<double> radius_m;           ///< of the mantle at the centre
  std::optional<double> slope_rad;          ///< of a cone: mantle to axis; above 0 where it widens along the axis
};

}  // namespace sparsha::scene
