#include "haptics/replay/recorded_run.h"

#include <utility>

#include "base/error.h"
#include "haptics/replay/path_device.h"

namespace sparsha::haptics {
namespace {

RendererOptions recorded_options(const Recording& recording, RendererOptions options) {
  options.rate_hz = 1.0 / recording.period_s();
  options.stiffness_n_per_m = recording.rows().front().tick.stiffness_n_per_m;
  return options;
}

HapticWindow first_window(const pipeline::Scene& scene, const Recording& recording) {
  if (recording.windows().empty())
    throw Error(ErrorKind::input, {}, "the path does not say on which windows it was made",
                "a run.csv as `explore --record` writes it");
  recording.require_scene(scene.description());
  return load_recorded(scene, recording.windows().front());
}

}  // namespace

RecordedRun::RecordedRun(const pipeline::Scene& scene, const Recording& recording, RendererOptions options)
    : scene_(scene),
      recording_(recording),
      renderer_(recording.info(), recorded_options(recording, options), first_window(scene, recording)) {}

bool RecordedRun::needs_window() const noexcept {
  const auto& windows = recording_.windows();
  return next_window_ < windows.size() && windows[next_window_].row == next_row_;
}

void RecordedRun::change_window() {
  Command swap;
  swap.kind = Command::Kind::swap;
  swap.window = load_recorded(scene_, recording_.windows()[next_window_++]);
  swap.move = true;
  swap.centre_m = recording_.rows()[next_row_].tick.centre_m.head<2>();
  static_cast<void>(renderer_.apply(swap));
}

void RecordedRun::step() noexcept {
  const RecordedRow& row = recording_.rows()[next_row_++];
  renderer_.replay(sample_of(row), row.tick);
}

}  // namespace sparsha::haptics
