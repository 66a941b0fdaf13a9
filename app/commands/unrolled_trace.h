// `trace --frame scan` on an unrolled object.
#pragma once

#include <vector>

#include "haptics/proxy/proxy.h"
#include "haptics/replay/trace.h"
#include "haptics/window/surface.h"
#include "scene/scene.h"

namespace sparsha::app {

/// Takes a path of the scan frame through the unrolled object, over the seam and as often around as it goes; places and
/// forces come back in the scan frame, forces as they act at the proxy. Throws Error{usage} for a path that goes around
/// too often, or beyond the overlap of a cone's picture.
[[nodiscard]] haptics::TraceResult trace_unrolled(const scene::Scene& scene, std::vector<haptics::HipSample> path,
                                                  const haptics::SurfaceOptions& surface,
                                                  const scene::HapticsConfig& haptics,
                                                  const haptics::SolverOptions& options);

}  // namespace sparsha::app
