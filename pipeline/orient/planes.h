// The largest plane among points, by PCL's sample consensus.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace sparsha::pipeline {

struct FacePlane {
  Eigen::Vector3d normal;            ///< unit
  Eigen::Vector3d centre;            ///< of its points
  std::vector<std::size_t> inliers;  ///< ascending
};

/// Of points whose extent is about 1: within `distance` of the plane, and with normals along it. Points with fewer than
/// three neighbours apart from themselves belong to none. Seeded; the result depends on the order of the points, so
/// sort them. Empty when no three points span a plane.
[[nodiscard]] std::optional<FacePlane> largest_plane(const std::vector<Eigen::Vector3f>& points, double distance);

}  // namespace sparsha::pipeline
