// Objects that lie far apart in one scan: a grid over all of them would show none.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "scene/config/filters.h"

namespace sparsha::pipeline {

struct PointGroup {
  scene::CropConfig crop;  ///< its box and a little more, whole millimetres
  double share = 0.0;      ///< of the points
};

/// The group with the most points, when it has a third of them or nearly, is less than a twentieth as long as all
/// points are, and a thousandth of them or more lie in others; groups are farther from each other than a 64th of that
/// length. Depends on the points alone, not on their order.
[[nodiscard]] std::optional<PointGroup> main_group(const std::vector<Eigen::Vector3d>& points_m);

/// The largest of the pieces that lie farther than about `apart_m` from each other; its share of the points.
[[nodiscard]] PointGroup largest_piece(const std::vector<Eigen::Vector3d>& points_m, double apart_m);

}  // namespace sparsha::pipeline
