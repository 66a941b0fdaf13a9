// What an object would stand on.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pipeline/orient/side_picture.h"

namespace sparsha::pipeline {

/// Indices of the points within `share` of the object's height over its lowest place. `up` is of length 1.
[[nodiscard]] std::vector<std::size_t> lowest_of(const EvenPoints& object, const Eigen::Vector3d& up, double share);

/// Share of the outline from above that the object would stand on, 0 to 1: of the convex hulls, that of the lowest 3 %
/// of its height.
[[nodiscard]] double foot_of(const EvenPoints& object, const Eigen::Vector3d& up);

}  // namespace sparsha::pipeline
