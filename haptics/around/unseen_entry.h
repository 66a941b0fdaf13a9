// A free hand that has come into the object past an edge where no face was met. Object frame, metres. For the servo
// thread.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "haptics/around/flight.h"
#include "haptics/around/object_surface.h"

namespace sparsha::haptics {

/// What is known of where a free hand has been; kept from tick to tick, of no meaning while it is held.
struct FreeHand {
  Eigen::Vector3d asked_m = Eigen::Vector3d::Zero();    ///< where it was looked at last
  Eigen::Vector3d outside_m = Eigen::Vector3d::Zero();  ///< where it was outside last
  bool asked = false;
  bool outside = false;  ///< and it has not been inside since
};

/// The face that holds a free hand which was outside and is enclosed now, where it lies no deeper than a face that is
/// entered at an edge does; nothing for a hand that was let go within. Looks only once for half a cell of the hand's
/// way, and asks for what encloses it only behind a face.
[[nodiscard]] std::optional<Crossing> entered_unseen(const ObjectSurface& object, const Eigen::Vector3d& hand_m,
                                                     FreeHand& free) noexcept;

}  // namespace sparsha::haptics
