// How far a place is within the stone of a whole object, by all its measured nodes together. Object frame, metres.
#pragma once

#include <Eigen/Core>

#include "scene/charts.h"
#include "scene/solid/winding.h"

namespace sparsha::haptics {

/// Immutable; made off the servo thread, read by it.
class Enclosure {
 public:
  explicit Enclosure(const scene::Charts& charts);

  /// The winding number of the nodes: 0 in the air, 1 within, a half on the surface. Some microseconds: for places
  /// where the faces about them do not tell.
  [[nodiscard]] double at(const Eigen::Vector3d& place_m) const noexcept;
  /// More than a half: right beyond a spacing from the surface, edges and corners included, but in wedges as thin; so
  /// is what lies behind a hole of the scan.
  [[nodiscard]] bool holds(const Eigen::Vector3d& place_m) const noexcept;
  /// Is it a room as seen from within, whose surface winds about its air?
  [[nodiscard]] bool is_room() const noexcept { return of_air_ < 0.0; }

 private:
  scene::WindingNumber winding_;
  double spacing_m_;
  double of_air_;  ///< the winding number before the surface: 0, and -1 of a room
};

}  // namespace sparsha::haptics
