// Slabs and panels with four straight edges stand on one of them, however they lay in the scanner's frame.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace sparsha::pipeline {

/// The direction nearest to `up`, within 45 degrees, along two edges of a rectangle that the points fill as they are
/// seen from `look_from`: the smallest of those that hold nearly all of them. Unit vector, scan frame. Nothing when
/// they fill no rectangle (a disc, a figure), or when `up` is along its edges as it is.
[[nodiscard]] std::optional<Eigen::Vector3d> up_along_edges(const std::vector<Eigen::Vector3d>& points_m,
                                                            const Eigen::Vector3d& look_from,
                                                            const Eigen::Vector3d& up);

}  // namespace sparsha::pipeline
