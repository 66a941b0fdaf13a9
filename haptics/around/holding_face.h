// The face under which a hand lies that no sheet holds: what the nearest faces say of a place, each where its foot on
// it lies. Object frame, metres. For the servo thread.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "haptics/around/flight.h"
#include "haptics/around/object_surface.h"
#include "haptics/proxy/proxy.h"

namespace sparsha::haptics {

/// What is known of a proxy that was about to let its hand go.
struct LastHold {
  std::uint32_t sheet = 0;
  Eigen::Vector3d place_m;  ///< before this tick
  SheetView view;           ///< of the sheet from there
  bool ended = false;       ///< the surface has ended under it, as at a hole of the scan
};

/// Where a hand is held that is about to be let go, if it lies within the object: on the nearest face that it is
/// behind, of those that push it towards the proxy and are not the other side of a wall. Deep under an edge or a
/// corner, where it is behind no part of any face, the proxy stays where it was. The crossing's share is 1. Nothing for
/// a hand less than half a cell deep, in front of the nearest face, or where the surface has ended and no hollow corner
/// is near. Whether a hand is within, all nodes together tell, and where the surface has ended, the faces about it.
[[nodiscard]] std::optional<Crossing> holding_face(const ObjectSurface& object, const Eigen::Vector3d& hand_m,
                                                   const LastHold& last, CellShape shape) noexcept;

/// The nearest face that a hand within the object is behind, of those that push it towards a place outside.
[[nodiscard]] std::optional<Crossing> face_towards(const ObjectSurface& object, const Eigen::Vector3d& hand_m,
                                                   const Eigen::Vector3d& outside_m) noexcept;

}  // namespace sparsha::haptics
