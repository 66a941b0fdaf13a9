// A hand of one mass on a spring and a damper, moved by where it wants to be and by what the device does. Shares no
// code with the governor, the simulated device or the tests' hand.
#pragma once

#include <deque>
#include <utility>

#include <Eigen/Core>

namespace sparsha::bench {

/// Device frame, SI.
struct FreeHand {
  double mass_kg = 0.15;           ///< of hand and device
  double damping_n_s_per_m = 2.0;  ///< towards the wanted place's own speed
  double grip_n_per_m = 300.0;
  double delay_s = 0.001;  ///< from the writing of a force to the hand
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();
  double work_j = 0.0;  ///< of the device's force on the hand

  void write(const Eigen::Vector3d& force_n, double time_s) { on_the_way_.emplace_back(time_s + delay_s, force_n); }
  /// From `time_s` on for a millisecond, in parts of 1/40 ms (semi-implicit Euler), while the wanted place goes
  /// straight from `from_m` to `to_m`.
  void go_on(double time_s, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m) {
    constexpr int kParts = 40;
    constexpr double kPart_s = 0.001 / kParts;
    const Eigen::Vector3d wanted_m_per_s = (to_m - from_m) / 0.001;
    for (int part = 0; part < kParts; ++part) {
      while (!on_the_way_.empty() && on_the_way_.front().first <= time_s + part * kPart_s) {
        held_n_ = on_the_way_.front().second;
        on_the_way_.pop_front();
      }
      const Eigen::Vector3d wanted_m = from_m + (part * kPart_s) * wanted_m_per_s;
      const Eigen::Vector3d total_n =
          held_n_ + grip_n_per_m * (wanted_m - position_m) + damping_n_s_per_m * (wanted_m_per_s - velocity_m_per_s);
      velocity_m_per_s += kPart_s / mass_kg * total_n;
      position_m += kPart_s * velocity_m_per_s;
      work_j += kPart_s * held_n_.dot(velocity_m_per_s);
    }
  }

 private:
  std::deque<std::pair<double, Eigen::Vector3d>> on_the_way_;
  Eigen::Vector3d held_n_ = Eigen::Vector3d::Zero();
};

}  // namespace sparsha::bench
