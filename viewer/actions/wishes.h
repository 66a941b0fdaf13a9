// What is asked of the session. Keys may come faster than the servo's answers: every one counts.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "haptics/state/requests.h"
#include "viewer/actions/actions.h"
#include "viewer/frame.h"

namespace sparsha::viewer {

class Wishes {
 public:
  explicit Wishes(haptics::RequestQueue* requests) : requests_(requests) {}

  /// True when the action is one of the session's.
  bool act(Action action, const haptics::State& state, const Window& window);
  /// The window's centre goes to a place of the grid frame.
  void move_to(const Eigen::Vector2d& centre_m, const Window& window);
  /// From now on the hand drags the stone, or no longer.
  void drag(bool on, const Window& window);
  /// A whole object turns about an axis of the device; the length is the angle, degrees, at most 360.
  void turn(const Eigen::Vector3d& axis_deg);
  void quit();
  /// The session starts anew for the next visitor.
  void welcome_next();
  /// Back to the window before the last move; false when there is none.
  bool undo();
  /// One step of time: goes on with an undo that takes several steps.
  void update(double time_s, const haptics::State& state, const Window& window);
  void forget_windows();

 private:
  /// Texture or friction: as the servo has it, or as it was wished last while the servo has not followed yet.
  struct Toggle {
    bool wished = false;
    double until_s = -1.0;
    bool flip(bool present, double time_s);
  };
  struct Place {
    Eigen::Vector2d centre_m;
    double width_m;
  };
  void post(haptics::Request::Kind kind, double x = 0.0, double y = 0.0, bool on = false, double z = 0.0);
  void remember(const Window& window);

  haptics::RequestQueue* requests_;
  Toggle texture_, friction_;
  double time_s_ = 0.0;
  std::vector<Place> before_;
  std::optional<Place> goal_;  // of an undo under way
  int tries_ = 0;
  std::uint64_t surface_ = 0;  // when it was asked last
  double asked_s_ = 0.0;
};

}  // namespace sparsha::viewer
