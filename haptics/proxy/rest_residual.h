// How far a proxy is from rest, recomputed from positions in metres alone (docs/touch.md, "Proxy").
#pragma once

#include <Eigen/Core>

#include "haptics/proxy/proxy.h"
#include "haptics/surface/monge_surface.h"

namespace sparsha::haptics {

/// Lengths in cells.
struct RestResidual {
  double excess_cells = 0.0;  ///< largest |T_c| - mu max(0, -w.n_c) over the touching cells, at least 0
  double below_cells = 0.0;   ///< depth of the proxy under the surface, beyond rounding; 0 when it is not below
};

/// Of an update that found contact, for a hand at `hip`, local frame. mu is mu_static while sticking.
[[nodiscard]] RestResidual rest_residual(const MongeSurface& surface, const ProxyUpdate& update,
                                         const Eigen::Vector3d& hip, CellShape shape = CellShape::bilinear) noexcept;

}  // namespace sparsha::haptics
