// What the motors may be asked for over minutes: a force that is held gets smaller before the windings get hot. No
// figure of the Falcon's motors is published: the budget is assumed, not measured.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "haptics/device/falcon/packet.h"

namespace sparsha::haptics::falcon {

/// Heat goes with the square of a motor's current and leaves with a time constant. Servo thread; no allocation.
class MotorEffort {
 public:
  static constexpr double kCooling_s = 30.0;
  /// Share of the heat of full current, for ever: half the current.
  static constexpr double kBudget = 0.25;
  /// Where forces begin to shrink.
  static constexpr double kSoftFrom = 0.20;

  /// `command` was held for `seconds`.
  void add(const MotorCommand& command, double seconds) noexcept {
    const double share = 1.0 - std::exp(-std::clamp(seconds, 0.0, 0.1) / kCooling_s);
    for (std::size_t i = 0; i < heat_.size(); ++i) {
      const double current = static_cast<double>(command[i]) / kMostCommand;
      heat_[i] += share * (current * current - heat_[i]);
    }
  }
  /// What forces are to be multiplied with, 0 to 1: falls so slowly that it is no step (3 N per second at most).
  [[nodiscard]] double share() const noexcept {
    return std::clamp((kBudget + 0.05 - heat()) / (kBudget + 0.05 - kSoftFrom), 0.0, 1.0);
  }
  /// True from a tenth less force on until it is whole again.
  [[nodiscard]] bool reduces() noexcept {
    reduces_ = share() < (reduces_ ? 1.0 : 0.9);
    return reduces_;
  }
  /// Of the warmest motor, 0 to 1.
  [[nodiscard]] double heat() const noexcept { return *std::max_element(heat_.begin(), heat_.end()); }

 private:
  std::array<double, 3> heat_{};
  bool reduces_ = false;
};

}  // namespace sparsha::haptics::falcon
