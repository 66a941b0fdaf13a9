// Offline rendering of a path over a whole object (`sparsha trace --frame scan`).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "haptics/around/object_surface.h"
#include "haptics/replay/trace.h"

namespace sparsha::haptics {

/// From the box of the object's nodes to a place (object frame), where that is farther than the box is long: no device
/// that holds the object reaches there. Else 0. Grid metres.
[[nodiscard]] double distance_away_m(const ObjectSurface& object, const Eigen::Vector3d& place_m);

/// Renders `path`, which is given in the scan frame like the rows that come back, forces too. At the first sample the
/// proxy is the hand, wherever that is. `scan_from_grid` turns and scales alike in all directions where a force is to
/// point from the hand to the proxy. `progress` as in trace().
[[nodiscard]] TraceResult trace_around(const ObjectSurface& object, const std::vector<HipSample>& path,
                                       const Eigen::Matrix4d& scan_from_grid, const scene::HapticsConfig& haptics,
                                       const SolverOptions& options, Progress* progress = nullptr);

}  // namespace sparsha::haptics
