// A simulated hand at a servo: it feels each force one tick late, as a person at motors does.
#pragma once

#include <algorithm>
#include <atomic>

#include <Eigen/Core>

#include "haptics/device/device.h"
#include "haptics/device/simulated/hand.h"

namespace sparsha::haptics {

/// What devices in software have in common; see Device for the threads.
class FeelingHand {
 public:
  FeelingHand(const HandParameters& parameters, const Eigen::Vector3d& position_m) noexcept
      : parameters_(parameters), hand_(parameters, position_m) {}

  /// Name and limits of a device that has this hand.
  [[nodiscard]] DeviceInfo info(const char* name) const {
    DeviceInfo info;
    info.name = name;
    info.planned_time = true;
    info.limits.max_force_n = parameters_.max_force_n;
    info.limits.least_damping_n_s_per_m = parameters_.damping_n_s_per_m;
    info.limits.undeclared_s = 0.0;
    return info;
  }

  /// Goes on to `time_s`. `intend(felt_n, hand_m, dt_s)` gives the intended position then.
  template <class Intend>
  [[nodiscard]] DeviceSample read(double time_s, const Intend& intend) noexcept {
    constexpr double kLongestStep_s = 0.1;  // a longer silence of the servo is simulated as this much
    if (started_ && time_s > time_s_) {
      if (zeroed_.exchange(false, std::memory_order_acquire)) {
        held_n_.setZero();
        next_n_.setZero();
      }
      const double dt_s = std::min(time_s - time_s_, kLongestStep_s);
      hand_.advance(intend(held_n_, hand_.position_m(), dt_s), held_n_, dt_s);
      held_n_ = next_n_;
    }
    started_ = true;
    time_s_ = time_s;
    DeviceSample sample;
    sample.position_m = hand_.measured_m();
    sample.time_s = time_s;
    sample.fresh = true;
    return sample;
  }

  void write(const Eigen::Vector3d& force_n) noexcept { next_n_ = deliverable(force_n, parameters_.max_force_n); }
  void zero() noexcept { zeroed_.store(true, std::memory_order_release); }

 private:
  HandParameters parameters_;
  SimulatedHand hand_;
  bool started_ = false;
  double time_s_ = 0.0;
  Eigen::Vector3d held_n_ = Eigen::Vector3d::Zero();  // what the motors hold
  Eigen::Vector3d next_n_ = Eigen::Vector3d::Zero();  // what they will hold from the next tick on
  std::atomic<bool> zeroed_{false};
};

}  // namespace sparsha::haptics
