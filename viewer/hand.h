// The hand of the pointer device: where the mouse points, over the stone without running into it, and down on demand.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "haptics/state/state.h"
#include "scene/scene_fwd.h"
#include "viewer/camera/camera.h"

namespace sparsha::viewer {

/// Height of the surface that the hand touches at x, y (grid frame, metres); no number where it is not known yet.
using HeightAt = std::function<double(double x_m, double y_m)>;

/// First place where the ray (grid frame) meets the surface raised by `above_m`; nothing when it never does.
/// `low_m`, `high_m`: heights between which the surface lies. `step_m`: distances in x and y within which it is smooth.
[[nodiscard]] std::optional<Eigen::Vector3d> meet_surface(const Eigen::Vector3d& origin_m,
                                                          const Eigen::Vector3d& direction, const HeightAt& height_at,
                                                          double above_m, double low_m, double high_m, double step_m);

class PointerHand {
 public:
  /// The mouse points along this ray, world coordinates.
  void aim(const View::Ray& ray) {
    aim_ = ray;
    fresh_s_ = 0.0;
    moves();
  }
  /// The picture is about to move: the hand stays where it is in its workspace.
  void forget_aim() { aim_.reset(); }
  /// z of what is before a place of the workspace, device frame; NaN: what `height_at` says.
  using BeforeAt = std::function<double(const Eigen::Vector2d& device_m)>;
  /// A whole object is touched where it is before the hand, however it is turned.
  void touch_object(BeforeAt before_m) { before_m_ = std::move(before_m); }
  /// Keys; device frame, metres.
  void step(double x_m, double y_m);
  void raise(double steps);
  /// One notch of the wheel: higher, or less deep while pressing.
  void wheel(double steps);
  void press(bool down);
  [[nodiscard]] bool presses() const { return pressed_; }

  /// One step of time. `reach_m`: of the hand to each side, device frame.
  [[nodiscard]] haptics::PointerSample update(double seconds, const haptics::State& state,
                                              const scene::SceneDescription& scene, const Stage& stage, double reach_m,
                                              const HeightAt& height_at);

 private:
  [[nodiscard]] double press_depth_m(const haptics::State& state) const;
  [[nodiscard]] double most_force_n(const haptics::State& state) const;
  void moves() {
    if (pressed_ || hover_m_ < 0.0) moved_s_ = 0.0;
  }
  void follow_aim(const haptics::State& state, const scene::SceneDescription& scene, const Stage& stage,
                  const HeightAt& height_at);
  void approach(double seconds, double reach_m, double depth_m, double against_m,
                const std::function<double(const Eigen::Vector2d&)>& surface_m);
  void follow_device(double seconds);

  std::optional<View::Ray> aim_;
  double fresh_s_ = 0.0;                                // since the last aim
  double moved_s_ = kLong_s;                            // since the pressing hand was moved
  Eigen::Vector2d wanted_m_ = Eigen::Vector2d::Zero();  // device frame
  double hover_m_ = kHover_m;                           // above the surface, device frame
  std::optional<double> deeper_m_;                      // depth of a press that the wheel has asked for
  BeforeAt before_m_;
  bool pressed_ = false;
  bool known_ = false;
  Eigen::Vector3d sent_m_ = Eigen::Vector3d::Zero();
  // The pointer device follows what is sent through a filter: this is where it is by now.
  Eigen::Vector3d device_m_ = Eigen::Vector3d::Zero(), velocity_ = Eigen::Vector3d::Zero();
  std::uint64_t sequence_ = 0;

  static constexpr double kHover_m = 0.008;
  static constexpr double kLong_s = 1e9;
};

}  // namespace sparsha::viewer
