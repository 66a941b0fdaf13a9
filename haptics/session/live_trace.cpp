#include "haptics/session/live_trace.h"

#include <chrono>
#include <utility>

#include "haptics/servo/tick_engine.h"
#include "haptics/session/window_loader.h"
#include "pipeline/base/error.h"

namespace sparsha::haptics {
namespace {

DeviceSample sample_of(const RecordedRow& row) {
  DeviceSample sample;
  sample.position_m = row.position_m;
  sample.buttons = row.buttons;
  sample.time_s = row.time_s;
  sample.fresh = (row.replay.flags & kFlagStale) == 0;
  sample.homed = (row.replay.flags & kFlagHomed) != 0;
  sample.replay = &row.replay;
  return sample;
}

Eigen::Vector3d to_vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

}  // namespace

TraceResult trace_recording(const pipeline::Scene& scene, const Recording& recording,
                            const pipeline::HapticsConfig& haptics, const SolverOptions& solver) {
  const std::vector<RecordedWindow>& windows = recording.windows();
  if (windows.empty())
    throw Error(ErrorKind::input, {}, "the path does not say on which windows it was made",
                "a run.csv as `explore --record` writes it");
  EngineOptions options;
  options.rate_hz = 1.0 / recording.period_s();
  options.stiffness_n_per_m = recording.rows().front().replay.stiffness_n_per_m;
  options.solver = haptics.solver;
  options.solver_options = solver;
  options.solver_options.c1_surface = solver.c1_surface || haptics.surface == pipeline::HapticsConfig::Surface::c1;
  const bool c1 = options.solver_options.c1_surface && haptics.solver == pipeline::HapticsConfig::Solver::exact;

  TickEngine engine(recording.info(), options, load_recorded(scene, windows.front()));
  std::size_t next_window = 1;
  TraceRecorder recorder(recording.rows().size());
  for (std::size_t k = 0; k < recording.rows().size(); ++k) {
    const RecordedRow& recorded = recording.rows()[k];
    if (next_window < windows.size() && windows[next_window].row == k) {
      Command swap;
      swap.kind = Command::Kind::swap;
      swap.window = load_recorded(scene, windows[next_window++]);
      swap.move = true;
      swap.centre_m = recorded.replay.centre_m.head<2>();
      static_cast<void>(engine.obey(swap));
    }
    const auto begin = std::chrono::steady_clock::now();
    engine.update(sample_of(recorded), recording.period_s());
    const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - begin;

    const State& state = engine.state();
    TraceRow row;
    row.t_s = state.time_s;
    row.hip_m = to_vector(state.hip_m);
    row.proxy_m = to_vector(state.proxy_m);
    row.force_n = to_vector(state.force_n);
    row.contact = state.contact != 0;
    row.level = static_cast<int>(state.level);
    row.tick_ns = elapsed.count();
    const MongeSurface& surface = *engine.window().surface;
    ProxyUpdate found = engine.found();
    found.unfinished = (state.flags & kFlagUnfinished) != 0;
    recorder.add(row, surface, found, row.hip_m - surface.lattice.origin_m, c1);
  }
  return std::move(recorder).finish();
}

}  // namespace sparsha::haptics
