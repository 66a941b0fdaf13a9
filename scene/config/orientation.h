// The configuration's block `orientation`.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace sparsha::scene {

/// How the object is looked at; `scan_to_grid` is what counts, an invertible affine about the scan frame's origin.
struct OrientationConfig {
  enum class Face { automatic, plane, principal };
  /// Looked for in the points when the scene is built; then scan_to_grid holds what was found, and this is absent.
  std::optional<Face> face;
  std::optional<Eigen::Vector3d> face_up;  ///< scan frame; absent = the format's own
  double face_scale = 1.0;
  Eigen::Matrix4d scan_to_grid = Eigen::Matrix4d::Identity();
  /// Where parts and sounds are written in the grid frame of another orientation: `regions_matrix`.
  std::optional<Eigen::Matrix4d> regions_scan_to_grid;
};

/// Rotation whose +z looks at the viewer who stands in direction `look_from`, +y up. Throws Error{usage} when parallel.
[[nodiscard]] Eigen::Matrix4d look_from(const Eigen::Vector3d& direction, const Eigen::Vector3d& up, double scale);

}  // namespace sparsha::scene
