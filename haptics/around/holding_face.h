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

/// Where a hand is held that its proxy in a hollow corner was about to let go, if it lies within the object: on the
/// nearest face that it is behind, of those that push it towards the proxy and are not the other side of a wall. Deep
/// under an edge or a corner, where it is behind no part of any face, the proxy stays where it was. `proxy`: the view
/// of its sheet `own` from its place. The crossing's share is 1. Nothing for a hand less than half a cell deep, in
/// front of the nearest face, or where the surface ends and no other face is near.
[[nodiscard]] std::optional<Crossing> holding_face(const ObjectSurface& object, const Eigen::Vector3d& hand_m,
                                                   std::uint32_t own, const SheetView& proxy, CellShape shape) noexcept;

}  // namespace sparsha::haptics
