// Between the renderer's force and the hand: stiffness limit, clamp, slew, passivity, arming.
// Servo thread only; no allocation, no exceptions. Device frame, newtons, metres, seconds.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace sparsha::haptics {

inline constexpr int kLongestDelayTicks = 4;

/// What a device can bear.
struct DeviceLimits {
  double max_force_n = 8.0;
  double least_damping_n_s_per_m = 2.0;  ///< least damping of hand and device
  double slew_n_per_s = 1500.0;          ///< growth of force
  int delay_ticks = 1;                   ///< a force reaches the hand this many ticks after it was written, 0 to 4
};

/// The same with every number in the range of things that hands hold: what is not a number, negative or absurd becomes
/// the safe end (no force, no damping, no growth). Whoever takes limits from outside goes through here.
[[nodiscard]] DeviceLimits usable(const DeviceLimits& limits) noexcept;

/// The last clamp before any device: at most `most_n` long, direction kept; zero when the force or the limit is not a
/// number.
[[nodiscard]] Eigen::Vector3d deliverable(const Eigen::Vector3d& force_n, double most_n) noexcept;

/// 0.8 * 2 b / (3 T): below where a wall with one tick of delay goes unstable (0.8 since at the edge itself decay takes
/// minutes).
[[nodiscard]] double stiffness_limit(const DeviceLimits& limits, double period_s) noexcept;

/// What the renderer may use of the stiffness that the user wishes, N/m.
[[nodiscard]] inline double governed_stiffness(double requested_n_per_m, const DeviceLimits& limits,
                                               double period_s) noexcept {
  return std::min(requested_n_per_m, stiffness_limit(limits, period_s));
}

struct GovernorInput {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();     ///< the renderer's, at the governed stiffness
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< measured hand position
  double spring_energy_j = 0.0;                          ///< 0.5 k |X_p - X_h|^2, device frame
  double period_s = 0.001;                               ///< since the last tick
  /// Of the servo's plan. A tick that was longer or shorter earns nothing: no growth of force, no free time, no credit.
  double nominal_period_s = 0.001;
  bool fresh = true;  ///< the position is new and finite
  bool contact = false;
};

struct GovernorOutput {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  bool saturated = false;  ///< clamp, slew or passivity changed the force
  bool armed = false;
  double energy_j = 0.0;  ///< observed: negative means energy was delivered to the hand
};

/// The steps of docs/touch.md, "Governor", in that order. The passivity observer (Hannaford & Ryu 2002) opens
/// new books for each contact after 50 ms in free space.
class Governor {
 public:
  explicit Governor(const DeviceLimits& limits) noexcept : limits_(usable(limits)) {}
  [[nodiscard]] GovernorOutput update(const GovernorInput& input) noexcept;
  /// After start, fault or homing: force comes back only after 50 ms in free space.
  void disarm() noexcept;
  /// Offline rendering needs no arming.
  void arm() noexcept { armed_ = true; }

 private:
  static constexpr std::size_t kLongestDelay = kLongestDelayTicks;

  void count_free_time(const GovernorInput& input) noexcept;
  void book(const GovernorInput& input) noexcept;
  [[nodiscard]] Eigen::Vector3d slewed(const Eigen::Vector3d& force_n, double period_s) const noexcept;
  [[nodiscard]] Eigen::Vector3d passive(const Eigen::Vector3d& force_n) const noexcept;
  [[nodiscard]] GovernorOutput command(const Eigen::Vector3d& force_n, bool saturated) noexcept;
  [[nodiscard]] std::size_t delay() const noexcept { return static_cast<std::size_t>(limits_.delay_ticks); }

  DeviceLimits limits_;
  bool armed_ = false;
  double free_s_ = 0.0;
  bool has_last_ = false;
  std::array<Eigen::Vector3d, kLongestDelay + 1> commanded_n_ = zeros();  ///< newest first
  Eigen::Vector3d last_position_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d displacement_m_ = Eigen::Vector3d::Zero();
  double damped_j_ = 0.0;
  double last_spring_energy_j_ = 0.0;
  double energy_j_ = 0.0;

  static std::array<Eigen::Vector3d, kLongestDelay + 1> zeros() {
    std::array<Eigen::Vector3d, kLongestDelay + 1> forces;
    forces.fill(Eigen::Vector3d::Zero());
    return forces;
  }
};

}  // namespace sparsha::haptics
