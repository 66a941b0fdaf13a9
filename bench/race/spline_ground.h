// A ground from heights that somebody scanned or carved: the uniform cubic B-spline over them is a surface in closed
// form, and that is what entrants are sampled from and judged by.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "protocol/course.h"

namespace sparsha::bench {

/// `heights` on `side` x `side` places of the unit square, row 0 at the bottom, metres in a frame in which the square
/// is 1 m wide. They are smoothed (Gaussian, as narrow as possible) until a hand `depth_m` deep has one foot only.
/// Requires side >= 8 and finite heights.
[[nodiscard]] protocol::Ground spline_ground(const std::string& name, std::vector<double> heights, int side,
                                             double depth_m);

/// The sample relief; two spheres, a closed object, from above; and, where SPARSHA_SCANS_DIR names a collection of
/// scans, the middle of two of its closed meshes, each scaled to 1 m.
[[nodiscard]] std::vector<protocol::Ground> object_grounds(double depth_m);

}  // namespace sparsha::bench
