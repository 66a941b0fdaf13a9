#include "haptics/replay/replay_trace.h"

#include <chrono>
#include <utility>

#include "haptics/replay/recorded_run.h"
#include "haptics/state/vectors.h"

namespace sparsha::haptics {

TraceResult trace_recording(const RecordedScenes& scenes, const Recording& recording,
                            const scene::HapticsConfig& haptics, const SolverOptions& solver) {
  RendererOptions options;
  options.solver = haptics.solver;
  options.solver_options = solver;
  if (haptics.surface == scene::HapticsConfig::Surface::c1) options.solver_options.shape = CellShape::c1;

  RecordedRun run(scenes, recording, options);
  TraceRecorder recorder(recording.rows().size());
  while (!run.finished()) {
    if (run.needs_window()) run.change_window();
    const auto begin = std::chrono::steady_clock::now();
    run.step();
    const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - begin;

    const State& state = run.renderer().state();
    TraceRow row;
    row.t_s = state.time_s;
    row.hip_m = to_vector(state.hip_m);
    row.proxy_m = to_vector(state.proxy_m);
    row.force_n = to_vector(state.force_n);
    row.contact = state.contact != 0;
    row.level = static_cast<int>(state.level);
    row.tick_ns = elapsed.count();
    if (run.renderer().window().object != nullptr) {
      recorder.add(row, (state.flags & kFlagUnfinished) != 0);
      continue;
    }
    const MongeSurface& surface = *run.renderer().window().surface;
    ProxyUpdate found = run.renderer().found();
    found.unfinished = (state.flags & kFlagUnfinished) != 0;
    recorder.add(row, surface, found, row.hip_m - surface.lattice.origin_m, run.renderer().shape());
  }
  return std::move(recorder).finish();
}

}  // namespace sparsha::haptics
