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

/// How an object would stand with that direction up.
struct Stand {
  double foot = 0.0;     ///< as foot_of()
  double tip_deg = 0.0;  ///< by which it may lean before it falls over; 0: it falls at once
  double filled = 0.0;  ///< share of the foot's hull with points near the ground: a disc 1, a rim or four hooves little
  double resting = 0.0;  ///< share of all directions from the middle of its surface that hit the foot, at most 0.5: how
                         ///< often it comes to rest on it when it is thrown (Goldberg et al. 1999)
};
[[nodiscard]] Stand stand_of(const EvenPoints& object, const Eigen::Vector3d& up);

inline constexpr double kLeastTip_deg = 4.0;  ///< what falls over sooner does not stand

/// With that direction up it would stand on a closed ring about nothing, and is round about it: a bowl on its rim, a
/// bell, and what is round and has no scan from below.
[[nodiscard]] bool is_round_on_a_rim(const EvenPoints& object, const Eigen::Vector3d& up);

/// Separate pieces of the object between 8 and 20 % of its height, small ones aside: legs.
[[nodiscard]] std::size_t legs_of(const EvenPoints& object, const Eigen::Vector3d& up);

/// The normal of the plane through what is lowest, a few times: a base that is a little tilted becomes level.
[[nodiscard]] Eigen::Vector3d levelled(const EvenPoints& object, Eigen::Vector3d up);

}  // namespace sparsha::pipeline
