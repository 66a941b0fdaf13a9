// Points moved onto the polynomial that fits their neighbours (Alexa et al. 2003, moving least squares).
#pragma once

#include <cstdint>
#include <functional>

#include "base/threads/context.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/filters.h"

namespace sparsha::pipeline {

struct Smoothing {
  double rms_m = 0.0;         ///< how far points were moved
  double most_m = 0.0;        ///< the farthest
  std::uint64_t unmoved = 0;  ///< points with fewer than three neighbours, themselves included, or without a fit
};

/// Moves every point by pcl::MLSResult: a plane or a polynomial of height over it, weighted by exp(-d^2 / radius^2), to
/// the neighbours closer than the radius. With Method::pcl by pcl::MovingLeastSquares, which searches in a kd-tree, on
/// one thread. A point without a fit, or whose fit lies farther away than the radius, stays where it is. Positions as
/// measured go to cloud.measured, unless a filter before has put them there. Depends neither on threads nor on the
/// order of the points.
/// Throws Error{usage} when neighbourhoods have thousands of points. `at` is told which share of the points is done, by
/// one thread at a time.
Smoothing smooth_points(Cloud& cloud, const scene::SmoothConfig& config, const Context& context,
                        const std::function<void(double)>& at = {});

}  // namespace sparsha::pipeline
