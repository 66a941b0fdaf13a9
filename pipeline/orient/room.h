// A room that was scanned from inside, and which way it stands.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "pipeline/orient/side_picture.h"

namespace sparsha::pipeline {

/// What two parallel layers at both ends of a direction, as floor and ceiling are, tell about a room between them.
struct Room {
  Eigen::Vector3d up;      ///< unit, scan frame
  double floor = 0.0;      ///< share of the plan that the floor covers, 0 to 1
  double ceiling = 0.0;    ///< the same of the ceiling
  double share = 0.0;      ///< of the whole surface, floor and ceiling
  double worth = 0.0;      ///< the share, and how far things lie nearer to one of the two
  bool by_things = false;  ///< what stands in it tells which of the two is the floor; else custom does
  /// Unit, scan frame: the side that shows what is in it, as a niche, a shrine or a stage has; the mean of 26
  /// directions, each as long as the share of things that it shows.
  std::optional<Eigen::Vector3d> open_side{};
};

/// The direction between floor and ceiling, where both cover a good part of the plan, walls stand around it, and things
/// between them, away from the walls, which no side from outside shows: a block, which looks the same otherwise, has
/// nothing inside, and of any other solid half is seen from some side. Of directions along
/// the axes of the scan and of `tilted` ones (unit, scan frame). Things lie nearer to the floor; where that tells
/// nothing, up is towards the positive axis. Of several directions, the one whose floor and ceiling have most of the
/// surface, and to whose floor things lie nearest: a shrine is higher than wide, but stands on its floor. Where they
/// are alike, z, since the frames of what scans rooms have z up by custom. Empty when it is no room. Depends on the set
/// of points alone.
[[nodiscard]] std::optional<Room> room_of(const EvenPoints& object, const std::vector<Eigen::Vector3d>& tilted);

}  // namespace sparsha::pipeline
