// Between the renderer's force and the hand: stiffness limit, clamp, slew, passivity, arming.
// Servo thread only; no allocation, no exceptions. Device frame, newtons, metres, seconds.
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace sparsha::haptics {

/// What a device can bear.
struct DeviceLimits {
  double max_force_n = 8.0;
  double least_damping_n_s_per_m = 2.0;  ///< least damping of hand and device
  double slew_n_per_s = 1500.0;          ///< growth of force
};

/// 0.8 * 2 b / (3 T): below where a wall with one tick of delay goes unstable.
[[nodiscard]] double stiffness_limit(const DeviceLimits& limits, double period_s) noexcept;

struct GovernorInput {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();     ///< the renderer's, at the governed stiffness
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< measured hand position
  double spring_energy_j = 0.0;                          ///< 0.5 k |X_p - X_h|^2, device frame
  double period_s = 0.001;                               ///< since the last tick
  bool fresh = true;                                     ///< the position is new and finite
  bool contact = false;
};

struct GovernorOutput {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  bool saturated = false;
  bool armed = false;
  double energy_j = 0.0;  ///< observed: negative means energy was delivered to the hand
};

class Governor {
 public:
  explicit Governor(const DeviceLimits& limits) : limits_(limits) {}
  [[nodiscard]] GovernorOutput update(const GovernorInput& input) noexcept;
  /// After start, fault or homing: force comes back only after 50 ms in free space.
  void disarm() noexcept;
  /// Offline rendering needs no arming.
  void arm() noexcept { armed_ = true; }

 private:
  DeviceLimits limits_;
  bool armed_ = false;
  double free_s_ = 0.0;
  bool has_last_ = false;
  Eigen::Vector3d held_force_n_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d last_position_m_ = Eigen::Vector3d::Zero();
  double energy_j_ = 0.0;
};

}  // namespace sparsha::haptics
