// Planes in which an object is most like its own mirror image.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pipeline/orient/side_picture.h"

namespace sparsha::pipeline {

struct MirrorPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< unit
  double offset = 0.0;                                ///< normal . p, pixels
  double alike = 0.0;  ///< 0 to 1: how near the mirror image of the surface lies to the surface
};

/// The best ones, 25 degrees or more apart, best first. Those of a turned object are turned with it.
[[nodiscard]] std::vector<MirrorPlane> mirror_planes(const EvenPoints& object, std::size_t count);

/// Principal axes of the points as columns, the longest first, right-handed; the first two point to where the object
/// has its longer tail, so that they turn with it.
[[nodiscard]] Eigen::Matrix3d principal_frame(const EvenPoints& object);

}  // namespace sparsha::pipeline
