// Alignment of one surface with another by PCL's registration classes.
#pragma once

#include <Eigen/Geometry>

#include "pipeline/register/surface.h"
#include "scene/config/registration.h"

namespace sparsha::pipeline {

/// The pose of `source` in the frame of `target`, from `guess` on, after at most `iterations` of PCL's
/// GeneralizedIterativeClosestPoint, or IterativeClosestPoint with point-to-plane or point-to-point distances.
/// Correspondences reach `distance_m`. Elements of the source that meet the border of the target, or nothing, are left
/// out: PCL would let them pull. One thread; the same result every time. The guess when nothing can be aligned.
[[nodiscard]] Eigen::Isometry3d align_pair(const StationSurface& source, const StationSurface& target,
                                           const Eigen::Isometry3d& guess, scene::RegisterConfig::Method method,
                                           double distance_m, int iterations, bool any_sign);

}  // namespace sparsha::pipeline
