// Whether a hand has gone past an edge, so that the face that its proxy lies on no longer holds it. Object frame,
// metres. For the servo thread.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "haptics/around/object_surface.h"
#include "haptics/proxy/proxy.h"

namespace sparsha::haptics {

inline constexpr double kEdgeGap = 1.5;  ///< cells: so far past an edge the proxy may have come

/// Is the hand in front of another face than that of the proxy's sheet, while the proxy is not, and does the path off
/// the proxy's face, in front of the other one and to the hand meet nothing? No hand that is enclosed is.
[[nodiscard]] bool is_hand_past_edge(const ObjectSurface& object, std::uint32_t own, const Eigen::Vector3d& proxy_m,
                                     const Eigen::Vector3d& hand_m, CellShape shape) noexcept;

/// Does a face, seen so from near the proxy, begin on the outer side of the proxy's, which has this normal, as the wall
/// of a hollow corner?
[[nodiscard]] bool is_wall_of_corner(const ObjectSurface& object, std::uint32_t face, const SheetView& view,
                                     const Eigen::Vector3d& proxy_m, const Eigen::Vector3d& normal) noexcept;

}  // namespace sparsha::haptics
