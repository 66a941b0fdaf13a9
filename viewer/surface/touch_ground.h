// Heights as the servo renders them: its window and level, continued and dilated by the fingertip as it does.
#pragma once

#include <array>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "haptics/state/state.h"
#include "scene/frame/touched_view.h"

namespace sparsha::viewer {

class TouchGround {
 public:
  /// Reads the window that `state` tells of when it is another; on a worker unless `wait`. Until it has come the last
  /// one serves where it lies. Never throws: unreadable layers leave the last window.
  void follow(const scene::ScenePointer& scene, const haptics::State& state, bool wait);
  /// Height of the rendered surface, grid frame, clamped to the window; nothing where it is not known: before the first
  /// window, and while another is read, outside the last one or at another scale.
  [[nodiscard]] std::optional<double> height_at(double x_m, double y_m) const;
  /// The window that the servo has told of is still read.
  [[nodiscard]] bool waits() const { return held_ != asked_; }

 private:
  struct Window {
    const scene::Scene* scene = nullptr;
    scene::TouchedView view;
    bool operator==(const Window&) const = default;
    /// But for which nodes.
    [[nodiscard]] bool same_view(const Window& other) const {
      scene::TouchedView there = other.view;
      there.i0 = view.i0, there.j0 = view.j0, there.nx = view.nx, there.ny = view.ny;
      return scene == other.scene && view == there;
    }
  };

  Window asked_;   // of the last state
  Window wanted_;  // read last, or read now
  Window held_;    // of the heights
  std::optional<scene::TouchedHeights> heights_;
  std::future<scene::TouchedHeights> loading_;
};

}  // namespace sparsha::viewer
