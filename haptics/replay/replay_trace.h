// A recorded run once more, offline: on the windows it was made on, through every zoom, pan and scroll.
#pragma once

#include "haptics/replay/recording.h"
#include "haptics/replay/trace.h"
#include "scene/scene.h"

namespace sparsha::haptics {

/// Renders a recording that has windows as the servo did, with its centres and stiffness; rows equal the run's to the
/// last bit, tick_ns is a whole tick's. Solver and surface are `haptics`'s. Throws Error{input} when the recording has
/// no windows or was made with another scene.
[[nodiscard]] TraceResult trace_recording(const pipeline::Scene& scene, const Recording& recording,
                                          const pipeline::HapticsConfig& haptics, const SolverOptions& solver);

}  // namespace sparsha::haptics
