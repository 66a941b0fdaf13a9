// The axis of a column, vase or tower, and the cylinder or cone that its surface is unrolled from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/config/unroll.h"

namespace sparsha::pipeline {

struct FoundMantle {
  scene::UnrollConfig unroll;  ///< everything is there, and shape is cylinder or cone
  std::string reason;          ///< for the user: what was found
};

/// Fills what `wanted` leaves open from points of the surface (scan frame, metres; 20 000 evenly chosen ones are
/// enough). The axis is the one about which the distances of points at the same height are most alike; the mantle has
/// the median distance of all heights, or follows it as a cone where that is clearly nearer. `up` tells which end of an
/// axis that was looked for is up. Depends on the set of points alone, not on their order. Throws Error{input} where no
/// axis can be told (a sphere, a cube, a plane, less than a quarter of the way around it), Error{usage} where the
/// points are not the cone that was asked for.
[[nodiscard]] FoundMantle find_mantle(std::vector<Eigen::Vector3d> sample_m, const scene::UnrollConfig& wanted,
                                      const Eigen::Vector3d& up);

/// The same where the points are as round as a column or a vase, all around and long enough to be worth it; nothing
/// where they are not. Nothing is thrown.
[[nodiscard]] std::optional<FoundMantle> mantle_of_round(const std::vector<Eigen::Vector3d>& sample_m,
                                                         const Eigen::Vector3d& up);

}  // namespace sparsha::pipeline
