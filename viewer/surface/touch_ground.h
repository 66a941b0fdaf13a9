// Heights as the servo renders them: its window and level, continued and dilated by the fingertip as it does.
#pragma once

#include <array>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "haptics/state/state.h"
#include "scene/scene.h"

namespace sparsha::viewer {

class TouchGround {
 public:
  /// Reads the window that `state` tells of when it is another; on a worker unless `wait`. Until it has come the last
  /// one serves where it lies. Never throws: unreadable layers leave the last window.
  void follow(const pipeline::ScenePointer& scene, const haptics::State& state, bool wait);
  /// Height of the rendered surface, grid frame, clamped to the window; nothing where it is not known: before the first
  /// window, and while another is read, outside the last one or at another scale.
  [[nodiscard]] std::optional<double> height_at(double x_m, double y_m) const;
  /// The window that the servo has told of is still read.
  [[nodiscard]] bool waits() const { return held_ != asked_; }

 private:
  struct Window {
    const pipeline::Scene* scene = nullptr;
    std::uint64_t level = 0;
    std::array<std::int64_t, 4> nodes{};
    bool texture = true;
    double tip_m = 0.0;  ///< grid frame
    bool operator==(const Window&) const = default;
    [[nodiscard]] bool same_view(const Window& other) const {
      return scene == other.scene && level == other.level && texture == other.texture && tip_m == other.tip_m;
    }
  };
  struct Heights {
    pipeline::Lattice lattice;
    std::vector<float> height_m;
    int margin = 0;  ///< nodes on every side that are not the window's: the ball touches them from over its border
  };
  static Heights load(const pipeline::Scene& scene, const Window& window);

  Window asked_;   // of the last state
  Window wanted_;  // read last, or read now
  Window held_;    // of the heights
  std::optional<Heights> heights_;
  std::future<Heights> loading_;
};

}  // namespace sparsha::viewer
