// Lines on the surface of a whole object, and how pieces that several sides see become one line.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace sparsha::haptics {

struct LinePlace {
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();  ///< grid frame
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< outward, unit; where surfaces meet in an edge, between theirs
};

/// Places on the surface, a node spacing apart or less, grid frame; closed where the last is the first once more.
using ObjectLine = std::vector<LinePlace>;

[[nodiscard]] double length_m(const ObjectLine& line);

/// Lines whose ends lie within 3 spacings of each other, or go on straight within 10, become one; without short ways
/// back, smooth, none of less than 6 spacings, longest first.
[[nodiscard]] std::vector<ObjectLine> finished(std::vector<ObjectLine> lines, double spacing_m);

}  // namespace sparsha::haptics
