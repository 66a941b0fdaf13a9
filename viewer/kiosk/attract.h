// An exhibit that nobody has touched for a while goes back to its beginning and shows itself.
#pragma once

#include <array>

#include "viewer/frame.h"

namespace sparsha::viewer {

class Attract {
 public:
  explicit Attract(double idle_s = 60.0) : idle_s_(idle_s) {}

  /// A key, a button, a movement of the mouse.
  void touched() { touched_ = true; }
  enum class Change { none, begins, ends };
  /// Once a frame. A hand that moves counts as a touch.
  Change update(double time_s, const haptics::State& state);
  /// Nobody has touched it for ten seconds, or yet.
  [[nodiscard]] bool alone(double time_s) const { return !visited_ || time_s - last_s_ > kAlone_s; }
  [[nodiscard]] bool shows() const { return shows_; }
  /// While it shows itself: a low light that goes round once in three minutes, in steps of two degrees.
  [[nodiscard]] KeyLight light(double time_s) const;

 private:
  static constexpr double kAlone_s = 10.0;
  double idle_s_;
  bool touched_ = false, shows_ = false, begun_ = false, visited_ = false;
  double last_s_ = 0.0, shows_since_s_ = 0.0;
  std::array<double, 3> hand_m_{};
};

}  // namespace sparsha::viewer
