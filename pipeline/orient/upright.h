// Which way an object stands that is like its own mirror image: its upright axis lies in the plane of symmetry.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pipeline/orient/mirror.h"
#include "pipeline/orient/side_picture.h"

namespace sparsha::pipeline {

/// A direction that custom calls up, and what it is worth beside what form tells.
struct CustomaryUp {
  Eigen::Vector3d up;
  double worth = 0.0;
};

struct UprightBySymmetry {
  Eigen::Vector3d up;                   ///< unit
  std::optional<Eigen::Vector3d> face;  ///< unit, at right angles to it: where a human face looks to
  double foot = 0.0;                    ///< share of the outline that it would stand on
  double worth = 0.0;
  double rival = 0.0;  ///< worth of the best direction that differs by 45 degrees or more
};

/// Of the directions in the one plane of symmetry the best by the sum of three: a human face upright in it; a foot that
/// it stands on without falling over; what is customary, where that lies in the plane. The object may be turned as it
/// likes, what is found is turned with it, custom aside. Empty where there is no plane of symmetry, or nothing in it
/// tells.
[[nodiscard]] std::optional<UprightBySymmetry> upright_by_symmetry(const EvenPoints& object,
                                                                   const std::array<CustomaryUp, 2>& customs);

}  // namespace sparsha::pipeline
