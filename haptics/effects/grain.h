// The force of the grain that a hand feels as it slides.
#pragma once

#include <Eigen/Core>

#include "scene/material/grain_field.h"

namespace sparsha::haptics {

/// The force of the grain under a hand that slides: press times slope, along the surface. As the potential
/// press * height has just this slope, what it gives to the hand it has taken before.
class Grain {
 public:
  struct Input {
    double period_s = 0.001;                            ///< since the last tick
    double pace_s = 0.001;                              ///< of the loop: a gap is one tick
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();  ///< on the stone, frame of its parts and sounds
    /// Of the three planes of that frame (GrainField::shares()); of one view that of x and y alone.
    Eigen::Vector3d shares = Eigen::Vector3d::UnitZ();
    Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();  ///< of the proxy in contact since the last tick, device frame
    double scale = 1.0;                                 ///< device metres per metre of the stone
    bool contact = false;                               ///< in this tick and the last
  };
  struct Output {
    Eigen::Vector3d slope = Eigen::Vector3d::Zero();  ///< of the stone's grain where it is touched, faded by speed
    double deviation_m = 0.0;                         ///< standard deviation of its heights, metres of the stone
  };
  /// Servo thread only; no allocation.
  [[nodiscard]] Output update(const Input& input, const scene::GrainField& field) noexcept;
  void reset() noexcept { *this = Grain(); }

 private:
  Eigen::Vector3d slow_m_per_s_ = Eigen::Vector3d::Zero();  // of the proxy, low-passed
  Eigen::Vector3d fast_m_per_s_ = Eigen::Vector3d::Zero();
  double period_s_ = 0.0;
};

}  // namespace sparsha::haptics
