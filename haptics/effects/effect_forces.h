// What the effects of a surface add to its force in a tick: the ring of a strike and the grain under a sliding hand;
// and the stiffness that is wished where the hand is.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "haptics/effects/cues.h"
#include "haptics/effects/grain.h"
#include "haptics/effects/impact.h"
#include "haptics/effects/surface_effects.h"

namespace sparsha::haptics {

/// Servo thread only; no allocation, no exceptions.
class EffectForces {
 public:
  struct Input {
    double period_s = 0.001;
    double pace_s = 0.001;                              ///< of the loop: a gap is one tick
    Eigen::Vector3d hand_m = Eigen::Vector3d::Zero();   ///< device frame
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();  ///< touched, frame of the scene's parts
    Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();  ///< of the proxy since the last tick, device frame
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();   ///< unit; zero when free
    Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  ///< of the surface
    std::size_t delay_ticks = 0;                        ///< declared, as for the governor
    double time_s = 0.0;
    double scale = 1.0;  ///< device metres per grid metre
    /// Of a whole object that is turned: from the axes of the grid frame to the device's; null of one view.
    const Eigen::Matrix3d* device_from_grid = nullptr;
    bool outside = false;  ///< of the scene, in the last tick
    bool unknown = false;  ///< where nothing was measured, likewise
    bool contact = false;
    bool touch = false;             ///< the contact has begun with this tick
    double approach_m_per_s = 0.0;  ///< then: of the hand towards the surface
  };
  struct Output {
    Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  ///< to be added
    double stored_j = 0.0;                              ///< what the hand has put into the grain and may get back
  };
  /// `effects` may be null: then nothing is added, and nothing is kept.
  [[nodiscard]] Output update(const Input& input, const SurfaceEffects* effects) noexcept;

  /// The wish where the hand was last, in steps too large for an encoder's flicker; the governor makes them smooth.
  /// `share`: of the configured stiffness that the user wishes now.
  [[nodiscard]] double stiffness(double base_n_per_m, double share, const Eigen::Vector3d& place_m,
                                 const SurfaceEffects& effects) noexcept;

  /// The surface has been exchanged: a strike needs a hand that comes from free space.
  void swap() noexcept { impact_.reset(); }
  /// After faults and homing.
  void reset() noexcept;
  [[nodiscard]] const Cues& cues() const noexcept { return cues_; }

 private:
  [[nodiscard]] double stored(const Input& input, double most_j) noexcept;

  [[nodiscard]] double bearable(const Input& input, double most_j) noexcept;

  static constexpr std::size_t kLongestDelay = 40;  // ticks: 4 ms at 10 kHz
  Impact impact_;
  Cues cues_;
  Grain grain_;
  std::array<Eigen::Vector3d, kLongestDelay + 1> grain_n_ = zeros();  // newest first
  Eigen::Vector3d last_m_ = Eigen::Vector3d::Zero();
  double stored_j_ = 0.0;
  std::array<double, kLongestDelay + 1> given_j_{};  // by the grain, if it reaches the hand so many ticks late
  bool was_contact_ = false;
  double stiffness_n_per_m_ = 0.0;  // told the governor last
  double last_wished_n_per_m_ = -1.0;

  static std::array<Eigen::Vector3d, kLongestDelay + 1> zeros() {
    std::array<Eigen::Vector3d, kLongestDelay + 1> forces;
    forces.fill(Eigen::Vector3d::Zero());
    return forces;
  }
};

}  // namespace sparsha::haptics
