// The lines of a whole object that a hand is led along, on all of its sides.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "haptics/outline/line_joins.h"
#include "scene/charts.h"

namespace sparsha::haptics {

/// What is found in the shape of the surface, longest first:
/// * edges, where surfaces meet that differ by more than 45 degrees; corners lie where their planes meet.
/// * rims: where the surface ends that the scans saw.
/// * steps, ridges and grooves within one side, as find_creases() finds them.
/// Lines of several sides that go on in each other are one. Every `stride`-th node is looked at for the last kind.
/// `noise_m`: standard deviation of the heights. Any thread; some 1.2 us per node.
[[nodiscard]] std::vector<ObjectLine> find_object_outlines(const scene::Charts& charts, double noise_m, int stride);

/// Where an area ends on the surface, longest first. `inside_m(place_m)`: how far inside a place of the grid frame is,
/// negative outside.
[[nodiscard]] std::vector<ObjectLine> find_object_borders(
    const scene::Charts& charts, const std::function<double(const Eigen::Vector3d& place_m)>& inside_m);

/// The line that a visitor drew, on the surface: its places that lie within `reach_m` of a node, moved onto the
/// surface; the longest run of them. Empty where there is none.
[[nodiscard]] ObjectLine on_surface(const scene::Charts& charts, const std::vector<Eigen::Vector3d>& drawn_m,
                                    double reach_m);

}  // namespace sparsha::haptics
