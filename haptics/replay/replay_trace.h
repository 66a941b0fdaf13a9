// A recorded run once more, offline: on the windows it was made on, through every zoom, pan, scroll and change
// of scene.
#pragma once

#include "haptics/replay/recorded_scenes.h"
#include "haptics/replay/recording.h"
#include "haptics/replay/trace.h"

namespace sparsha::haptics {

/// Renders a recording that has windows as the servo did, with its centres and stiffness; rows equal the run's to the
/// last bit, tick_ns is a whole tick's. Solver and surface are `haptics`'s. Throws Error{input} when the recording has
/// no windows or was made with other scenes.
[[nodiscard]] TraceResult trace_recording(const RecordedScenes& scenes, const Recording& recording,
                                          const scene::HapticsConfig& haptics, const SolverOptions& solver);

}  // namespace sparsha::haptics
