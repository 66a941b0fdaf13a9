// A small statue of our own making, known by the distance to its surface: a figure on a plinth with one hand on its hip
// and a ring in the other, so that scans have undercuts, a back and two holes to see through.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "pipeline/simulate/surface.h"

namespace sparsha::pipeline {

/// Of the figure as it is drawn, metres: it fills its size in x and y about, and +- depth in z.
inline constexpr double kStatueWidth_m = 0.18, kStatueHeight_m = 0.37, kStatueDepth_m = 0.08;

/// About the distance from a place in the surface's frame to the statue, negative inside; never more than 1.4 times the
/// true one, and 0 exactly on the surface. The figure is scaled to `height_m` and stands in the middle of the width.
[[nodiscard]] double statue_distance_m(double width_m, double height_m, const Eigen::Vector3d& place_m);

/// Half of the figure's extent in z.
[[nodiscard]] double statue_depth_m(double height_m);

/// Where the beam origin + t * direction first meets the statue, t >= 0, to 1e-9 of its size; `direction` is a unit
/// vector. Nothing when it passes.
[[nodiscard]] std::optional<double> meet_statue(double width_m, double height_m, const Eigen::Vector3d& origin_m,
                                                const Eigen::Vector3d& direction);

}  // namespace sparsha::pipeline
