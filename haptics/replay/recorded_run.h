// A recorded run once more, tick by tick: on the windows that it was made on, through every zoom, pan, scroll and
// change of scene.
#pragma once

#include <cstddef>

#include "haptics/replay/recorded_scenes.h"
#include "haptics/replay/recording.h"
#include "haptics/servo/haptic_renderer.h"

namespace sparsha::haptics {

/// Drives the renderer as the servo did; every tick gives the recorded one's bits. One thread.
class RecordedRun {
 public:
  /// `recording`, which has windows, outlives it; rate and stiffness of `options` are the recording's.
  /// Loads the first window. Throws Error{input} when the recording was made with other scenes or tiles cannot be
  /// read.
  RecordedRun(RecordedScenes scenes, const Recording& recording, RendererOptions options);

  [[nodiscard]] bool finished() const noexcept { return next_row_ >= recording_.rows().size(); }
  /// The next row is the first on another window.
  [[nodiscard]] bool needs_window() const noexcept;
  /// Loads that window and puts it in place. Throws Error{input} when tiles cannot be read.
  void change_window();
  /// Renders the next row; needs_window() is false.
  void step() noexcept;

  [[nodiscard]] HapticRenderer& renderer() noexcept { return renderer_; }
  [[nodiscard]] const HapticRenderer& renderer() const noexcept { return renderer_; }

 private:
  RecordedScenes scenes_;
  const Recording& recording_;
  HapticRenderer renderer_;
  std::size_t next_row_ = 0;
  std::size_t next_window_ = 1;
};

}  // namespace sparsha::haptics
