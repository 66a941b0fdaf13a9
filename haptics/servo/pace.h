// How far the servo believes a device that paces it, and the hand that it reports. Servo thread only; no allocation, no
// exceptions.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "haptics/device/device.h"

namespace sparsha::haptics {

/// When ticks may begin whose device paces them. Answers that come together after a late one are taken as they come;
/// a wait() that returns at once again and again (its service has died, it does not wait at all) is held to
/// kMostTicksPerPeriod and is a fault.
class Pace {
 public:
  /// Ticks that a device may ask for within a planned period, in the long run.
  static constexpr std::int64_t kMostTicksPerPeriod = 4;

  /// `period_ns`: the servo's planned one.
  explicit Pace(std::int64_t period_ns) noexcept;

  /// wait() returned at `woke_ns`, the servo's clock. When the tick may begin: then, or later.
  [[nodiscard]] std::int64_t admit(std::int64_t woke_ns) noexcept;
  /// wait() has returned too soon too often: no force.
  [[nodiscard]] bool runs_away() const noexcept { return runs_away_; }

 private:
  std::int64_t least_ns_;  ///< between two ticks in the long run
  std::int64_t burst_ns_;  ///< by which the ticks may be ahead of that
  std::int64_t due_ns_ = 0;
  bool runs_away_ = false;
};

/// Finds positions that the hand of a device cannot have come to.
class HandSpeed {
 public:
  /// `fastest_m_per_s`: DeviceInfo's; 0 = every position is believed.
  explicit HandSpeed(double fastest_m_per_s) noexcept : fastest_m_per_s_(fastest_m_per_s) {}

  /// True when this fresh sample is farther from the one before than a hand moves in that time, and while samples go to
  /// and fro as no hand can turn: the energy of such a tremble is none that the governor can account for. The next is
  /// judged from here on. `period_s`: the planned one. `look_s`: between two looks of a device that repeats positions
  /// (LookMeter), 0 for others: a hand may have gone on for so long before a repeated position changes.
  [[nodiscard]] bool jumps(const DeviceSample& sample, double period_s, double look_s = 0.0) noexcept;

 private:
  void watch_turns(const Eigen::Vector3d& moved_m, double passed_s) noexcept;

  double fastest_m_per_s_;
  bool known_ = false;
  int turns_ = 0;  // that no hand can make: of the last samples, less one for each that was none
  Eigen::Vector3d moved_m_ = Eigen::Vector3d::Zero();
  double time_s_ = 0.0;
  double changed_s_ = 0.0;  // when the position changed last
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
};

/// Replaces values that cannot be true. Times that are not finite, or later than `time_s` at which the sample was read
/// (not with a clock of the device's own), become `time_s`; delays below 0 or NaN become 0, long ones 0.1 s; shares lie
/// in [0, 1], NaN becomes 0; an applied force that is not finite is not told.
void keep_to_what_can_be(DeviceSample& sample, double time_s, bool own_clock) noexcept;

}  // namespace sparsha::haptics
