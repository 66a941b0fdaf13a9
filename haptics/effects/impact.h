// The ring of a strike: a decaying sinusoid at first contact (Okamura et al. 2001; Kuchenbecker et al. 2006). Invented,
// not measured: the spring of the surface alone is a cushion.
#pragma once

#include <Eigen/Core>

#include "scene/material/materials.h"

namespace sparsha::haptics {

/// Servo thread only; device frame; no allocation, no exceptions. The force that it adds goes through the governor.
class Impact {
 public:
  struct Input {
    double period_s = 0.001;  ///< since the last tick
    double pace_s = 0.001;    ///< of the loop: a gap is one tick
    Eigen::Vector3d hand_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< of the touched surface, unit; zero when free
    bool contact = false;
    bool touch = false;                              ///< the contact begins with this tick
    double approach_m_per_s = 0.0;                   ///< then: of the hand towards the surface
    double pressed_n = 0.0;                          ///< of the surface's spring along the normal: the ring never pulls
    const scene::MaterialTouch* material = nullptr;  ///< at the place touched
  };

  /// Newtons along the normal, to be added to the surface's force. Zero but for the time after a first contact.
  [[nodiscard]] double update(const Input& input) noexcept;
  /// Ends the ring; the next one needs a hand that came from free space. After swaps, faults and homing.
  void reset() noexcept;

 private:
  void watch_departure(const Input& input) noexcept;
  void begin(const Input& input) noexcept;
  void spend(const Input& input) noexcept;

  // Of the hand's way into free space since the last contact.
  double free_s_ = 0.0;
  bool touched_ = false;
  double away_m_ = 0.0;
  Eigen::Vector3d left_m_ = Eigen::Vector3d::Zero();  // where the last contact was, and its normal
  Eigen::Vector3d left_normal_ = Eigen::Vector3d::Zero();
  double period_s_ = 0.0;  // of the real ticks, smoothed; 0 before the first
  // Of the ring.
  double time_s_ = 0.0;
  double amplitude_n_ = 0.0;  // 0: none
  double radians_per_s_ = 0.0;
  double decay_per_s_ = 0.0;
  double budget_j_ = 0.0;  // that it may give to the hand
  double left_j_ = 0.0;    // of that; the ring fades with it
  double mean_n_ = 0.0;    // of its size, over a cycle
  Eigen::Vector3d last_m_ = Eigen::Vector3d::Zero();
};

}  // namespace sparsha::haptics
