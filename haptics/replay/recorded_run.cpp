#include "haptics/replay/recorded_run.h"

#include <utility>

#include "haptics/replay/path_device.h"

namespace sparsha::haptics {
namespace {

RendererOptions recorded_options(const Recording& recording, RendererOptions options) {
  options.rate_hz = 1.0 / recording.period_s();
  options.stiffness_n_per_m = recording.rows().front().tick.stiffness_n_per_m;
  return options;
}

HapticWindow first_window(const RecordedScenes& scenes, const Recording& recording) {
  scenes.require(recording);
  const RecordedWindow& window = recording.windows().front();
  return load_recorded(*scenes.of(window), window);
}

}  // namespace

RecordedRun::RecordedRun(RecordedScenes scenes, const Recording& recording, RendererOptions options)
    : scenes_(std::move(scenes)),
      recording_(recording),
      renderer_(recording.info(), recorded_options(recording, options), first_window(scenes_, recording)) {}

bool RecordedRun::needs_window() const noexcept {
  const auto& windows = recording_.windows();
  return next_window_ < windows.size() && windows[next_window_].row == next_row_;
}

void RecordedRun::change_window() {
  Command swap;
  swap.kind = Command::Kind::swap;
  const RecordedWindow& window = recording_.windows()[next_window_++];
  swap.window = load_recorded(*scenes_.of(window), window);
  swap.move = true;
  swap.centre_z_m = recording_.rows()[next_row_].tick.centre_m.z();
  swap.centre_m = recording_.rows()[next_row_].tick.centre_m.head<2>();
  static_cast<void>(renderer_.apply(swap));
}

void RecordedRun::step() noexcept {
  const RecordedRow& row = recording_.rows()[next_row_++];
  renderer_.replay(sample_of(row), row.tick);
}

}  // namespace sparsha::haptics
