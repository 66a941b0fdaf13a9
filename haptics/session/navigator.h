// Where the window is and where it goes: zoom, pan, scrolling at the workspace's rim, fresh tiles near the border.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "haptics/servo/command.h"
#include "haptics/session/announcer.h"
#include "haptics/session/window_loader.h"
#include "haptics/state/requests.h"
#include "haptics/state/state.h"
#include "scene/area/regions.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// Where a window's centre can be: there its edges are those of the scene. Grid frame, metres.
struct CentreRange {
  Eigen::Vector3d low_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d high_m = Eigen::Vector3d::Zero();
};
/// Of a window `width_m` wide on a level.
[[nodiscard]] CentreRange centre_range(const scene::SceneDescription& scene, const scene::Lattice& level,
                                       double width_m);

/// A window on a whole object along the axes of the device: places from the middle of the object's box.
struct AroundView {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();    ///< of the window
  Eigen::Vector3d box_half_m = Eigen::Vector3d::Zero();  ///< of the turned object
  CentreRange range;                                     ///< of the centre
};
/// Of a window `width_m` wide on an object in `box_m` (grid frame).
[[nodiscard]] AroundView around_view(const Eigen::AlignedBox3d& box_m, const State& state, double width_m);

/// Session's thread only. Turns wishes and the hand's place into windows to load and commands to post.
class Navigator {
 public:
  Navigator(scene::ScenePointer scene, double workspace_width_m, const Effects& effects, Announcer& announcer);

  /// The overview.
  [[nodiscard]] WindowPlan first_plan() const;
  /// Takes over a plan as the present one.
  void settle(const WindowPlan& plan) { plan_ = plan; }
  [[nodiscard]] const WindowPlan& plan() const { return plan_; }
  /// Where the hand will be when the servo has taken over all that was asked for, grid frame.
  [[nodiscard]] Eigen::Vector3d hand_m(const State& state) const;
  /// Width of the present window, grid frame.
  [[nodiscard]] double width_m() const { return workspace_width_m_ / plan_.scale; }

  /// What a plan shows; `between`: what to call a view that is neither the whole scene nor the closest.
  [[nodiscard]] View view_of(const WindowPlan& plan, View::Kind between = View::Kind::present) const;

  /// A wish that changes the window; empty when it changes nothing (and says why).
  [[nodiscard]] std::optional<WindowLoader::Job> wish(const Request& request, const State& state);
  /// The servo has taken over all that was asked for.
  void arrived() { goal_m_.reset(); }
  /// The part that was gone to last, index into the scene's list.
  [[nodiscard]] std::optional<std::size_t> part() const {
    return part_ > 0 ? std::optional<std::size_t>(part_ - 1) : std::nullopt;
  }
  /// A wish to turn a whole object; empty when it changes nothing (and says why).
  [[nodiscard]] std::optional<Command> turn(const Request& request);
  /// That was asked for last, from the grid frame's axes to the device frame's.
  [[nodiscard]] const Eigen::Quaterniond& turn() const { return turn_; }
  /// The front again, without a word; empty where it is there.
  [[nodiscard]] std::optional<Command> face_front();
  /// Does the hand go all around the scene?
  [[nodiscard]] bool goes_around() const { return box_m_.has_value(); }
  /// Of a whole object, grid frame.
  [[nodiscard]] const std::optional<Eigen::AlignedBox3d>& box_m() const { return box_m_; }
  /// The next part to go to is the first one again.
  void forget_part() { part_ = 0; }
  /// The overview of the same scene.
  [[nodiscard]] WindowLoader::Job whole_scene();
  /// A change of scene.
  [[nodiscard]] WindowLoader::Job change_scene(scene::ScenePointer scene);
  /// Fresh tiles when the proxy is near the border of those loaded; empty when it is not or there are none beyond.
  [[nodiscard]] std::optional<WindowLoader::Job> follow(const State& state) const;
  /// Scrolling speed that the hand's place at the workspace's rim asks for; a command when it has changed.
  [[nodiscard]] std::optional<Command> scroll(const State& state);

 private:
  enum class Zoom { in, out };
  [[nodiscard]] const scene::Lattice& level(int index) const;
  [[nodiscard]] WindowLoader::Job job(const WindowPlan& plan) const;
  [[nodiscard]] std::optional<WindowLoader::Job> zoom(Zoom direction, const State& state);
  [[nodiscard]] WindowLoader::Job move(Eigen::Vector2d centre_m);
  [[nodiscard]] WindowLoader::Job move(const WindowPlan& plan, const Eigen::Vector2d& centre_m);
  [[nodiscard]] WindowLoader::Job move_object(const Eigen::Vector3d& centre_m);
  [[nodiscard]] WindowLoader::Job move_object(const WindowPlan& plan, const Eigen::Vector3d& centre_m);
  [[nodiscard]] std::optional<WindowLoader::Job> wish_for_object(const Request& request, const State& state);
  [[nodiscard]] Eigen::Vector3d scroll_wanted(const State& state) const;
  [[nodiscard]] Eigen::Vector3d scroll_around(const State& state) const;
  [[nodiscard]] Eigen::Vector3d rim_speed(const State& state) const;
  [[nodiscard]] WindowLoader::Job show(const WindowPlan& plan, const scene::PartPlace::Solid& solid,
                                       const Eigen::Vector2d& way_m);
  void know_object();
  [[nodiscard]] std::optional<WindowLoader::Job> part(int step, const State& state);
  void say_direction(const Eigen::Vector3d& velocity, double time_s);
  [[nodiscard]] WindowPlan plan_at(const ZoomStep& step, const Eigen::Vector2d& centre_m) const;

  scene::ScenePointer scene_;
  double workspace_width_m_;
  Effects effects_;
  Announcer& announcer_;
  WindowPlan plan_;
  std::optional<Eigen::AlignedBox3d> box_m_;                  // of a whole object, grid frame
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();  // that was asked for last
  std::optional<Eigen::Vector3d> goal_m_;                     // where the centre goes, until the servo has it there
  std::size_t part_ = 0;                                      // one beyond the part that was gone to; 0: none yet
  Eigen::Vector3d scroll_ = Eigen::Vector3d::Zero();          // last one commanded, grid frame, m/s
  Eigen::Vector2d asked_ = Eigen::Vector2d::Zero();           // by whoever steers, workspace widths per second
  Phrase direction_ = "moving_left";                          // said last
  double scrolled_s_ = -1e9;                                  // when the window scrolled last
};

}  // namespace sparsha::haptics
