#include "haptics/replay/replay_trace.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "haptics/replay/around_trace.h"
#include "haptics/replay/recorded_run.h"
#include "haptics/state/vectors.h"

namespace sparsha::haptics {
namespace {

/// How far a place (grid frame) is beside the whole level that the window is of and beside the window, which may go on
/// beyond the level; 0 when it is no more than a cell.
double beside_level_m(const HapticWindow& window, const Eigen::Vector3d& place_m) {
  const scene::Lattice& lattice = window.surface->lattice;
  const Eigen::Vector3d local_m = place_m - lattice.origin_m;
  double distance_m = distance_beside_m(*window.surface, local_m);
  if (window.level_nx > 0) {
    const auto beyond = [&](double at_m, int first, int count) {
      const double at = at_m / lattice.spacing_m + first;
      return lattice.spacing_m * std::max({0.0, -at, at - (count - 1)});
    };
    distance_m = std::min(distance_m, std::hypot(beyond(local_m.x(), window.i0, window.level_nx),
                                                 beyond(local_m.y(), window.j0, window.level_ny)));
  }
  return distance_m > lattice.spacing_m ? distance_m : 0.0;
}

}  // namespace

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
    if (const ObjectSurface* object = run.renderer().window().object; object != nullptr) {
      recorder.add(row, (state.flags & kFlagUnfinished) != 0);
      if (const double away_m = distance_away_m(*object, row.hip_m - object->origin_m); away_m > 0.0)
        recorder.outside(away_m, true);
      continue;
    }
    const MongeSurface& surface = *run.renderer().window().surface;
    ProxyUpdate found = run.renderer().found();
    found.unfinished = (state.flags & kFlagUnfinished) != 0;
    recorder.add(row, surface, found, row.hip_m - surface.lattice.origin_m, run.renderer().shape());
    if (const double beside_m = beside_level_m(run.renderer().window(), row.hip_m); beside_m > 0.0)
      recorder.outside(beside_m);
  }
  return std::move(recorder).finish();
}

}  // namespace sparsha::haptics
