// An independent judge of where a proxy may rest, from node heights and positions alone: it works with 3-D vectors in
// metres and shares nothing with the solvers.
#pragma once

#include <Eigen/Core>

#include "haptics/surface/monge_surface.h"

namespace sparsha::haptics::test {

struct Judgement {
  double excess_cells = 0.0;     ///< largest |T_c| - mu max(0, -w.n_c) over the touching cells
  double tangent_cells = 0.0;    ///< largest |T_c|
  double pull_cells = 0.0;       ///< w.n of the cell that w points into: positive means the surface pulls
  double below_cells = 0.0;      ///< depth of the proxy under the surface
  double allowance_cells = 0.0;  ///< rest tolerance 1e-9 + 4 eps |w| and 4 ulp of the coordinates on these slopes
};

/// `mu` is the coefficient that holds at the proxy. Local frame, metres.
[[nodiscard]] Judgement judge(const MongeSurface& surface, const Eigen::Vector3d& proxy, const Eigen::Vector3d& hip,
                              double mu);

/// Bilinear coefficient at the proxy, the border's outside the window (where judge() uses none).
[[nodiscard]] double coefficient_at(const MongeSurface& surface, const std::vector<float>& nodes,
                                    const Eigen::Vector3d& proxy);

}  // namespace sparsha::haptics::test
