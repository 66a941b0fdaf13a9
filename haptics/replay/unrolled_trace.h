// Offline rendering of a path over an unrolled object, in the frame of its scans (`sparsha trace --frame scan`).
#pragma once

#include <vector>

#include "haptics/proxy/proxy.h"
#include "haptics/replay/trace.h"
#include "haptics/window/surface.h"
#include "scene/scene.h"

namespace sparsha::haptics {

/// Takes a path of the scan frame through the unrolled object, over the seam and as often around as it goes; places and
/// forces come back in the scan frame, forces as they act at the proxy. Throws Error{usage} for a path that goes around
/// too often, or beyond the overlap of a cone's picture. `progress` as in trace().
[[nodiscard]] TraceResult trace_unrolled(const scene::Scene& scene, const std::vector<HipSample>& path,
                                         const SurfaceOptions& surface, const scene::HapticsConfig& haptics,
                                         const SolverOptions& options, Progress* progress = nullptr);

}  // namespace sparsha::haptics
