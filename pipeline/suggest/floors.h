// The floor that an object stands on, the wall behind it: large planes around what was scanned.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "scene/config/filters.h"

namespace sparsha::pipeline {

struct FloorsAndWalls {
  struct Plane {
    scene::RemovePlaneConfig filter;  ///< with the normal towards the object
    double share = 0.0;               ///< of the points, those that it takes away
    std::string reason;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< as the filter finds it: what stays has
    double offset_m = 0.0;                              ///< normal . p > offset
  };
  std::vector<Plane> planes;  ///< in the order in which filters take them away; empty when there are none
  /// Of what they leave, the largest piece, where others lie apart from it; it is in the box.
  struct Piece {
    scene::KeepConfig filter;
    scene::CropConfig box;
    double share = 0.0;  ///< of what the planes leave
  };
  std::optional<Piece> piece;

  [[nodiscard]] bool keeps(const Eigen::Vector3d& point_m) const;
};

/// Planes with everything else on one side of them, that reach clearly beyond what they leave over, where that stands
/// out by a good part of its own size. Neither a relief on its wall nor the flat base of a statue nor a room has any.
/// Metres, scan frame. Each is found as the filter of a build finds it, one after the other. The order of the points
/// does not matter.
[[nodiscard]] FloorsAndWalls find_floors_and_walls(const std::vector<Eigen::Vector3d>& points_m,
                                                   const Context& context);

/// As filters of a configuration, a line each, with the reasons; `begin` stands before each, as "  - " does.
[[nodiscard]] std::string to_text(const FloorsAndWalls& around, const std::string& begin);

}  // namespace sparsha::pipeline
