// A hand that holds a haptic device: a mass on a spring and damper whose far end is where the person wants to be.
// Feels zero-order-held forces, has Coulomb friction, an encoder and an amplifier that saturates.
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace sparsha::haptics {

/// Of a real grasp, hand and device together. Stiffness and damping pull towards the intended position.
struct HandParameters {
  double mass_kg = 0.15;             ///< 0.05 to 0.5
  double stiffness_n_per_m = 300.0;  ///< 0 to 1000
  double damping_n_s_per_m = 2.0;    ///< 0 to 10
  double coulomb_n = 0.05;           ///< dry friction of the device's joints
  double encoder_step_m = 0.00002;   ///< 0 = continuous
  double max_force_n = 8.0;          ///< the amplifier scales longer force vectors down to this; 0 = never
  double substep_s = 0.00002;        ///< longest step of the integration
};

/// Device frame, metres, newtons, seconds. Between sub-steps the linear part is integrated exactly; dry friction is an
/// impulse a sub-step, and holds a resting hand still. Deterministic; no allocation, no exceptions.
class SimulatedHand {
 public:
  SimulatedHand(const HandParameters& parameters, const Eigen::Vector3d& position_m) noexcept;

  /// Lets `dt_s` pass while the device holds `force_n` and the intended position goes to `target_m` in a straight line.
  void advance(const Eigen::Vector3d& target_m, const Eigen::Vector3d& force_n, double dt_s) noexcept;
  /// Puts the hand at rest somewhere, intended position included.
  void place(const Eigen::Vector3d& position_m) noexcept;

  [[nodiscard]] const Eigen::Vector3d& position_m() const noexcept { return position_m_; }
  [[nodiscard]] const Eigen::Vector3d& velocity_m_per_s() const noexcept { return velocity_; }
  [[nodiscard]] const Eigen::Vector3d& target_m() const noexcept { return target_m_; }
  /// What the encoder reports.
  [[nodiscard]] Eigen::Vector3d measured_m() const noexcept;
  /// Work the device's force has done on the hand so far, joules, from the true motion.
  [[nodiscard]] double work_j() const noexcept { return work_j_; }
  /// The force the amplifier makes of a command.
  [[nodiscard]] Eigen::Vector3d saturated(const Eigen::Vector3d& force_n) const noexcept;

 private:
  void prepare(double step_s) noexcept;

  HandParameters parameters_;
  Eigen::Vector3d position_m_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d target_m_;
  double work_j_ = 0.0;
  // [e, e'] after a step = phi * [e, e'] + gamma * acceleration; e is measured from the moving target.
  double step_s_ = 0.0;
  double phi_[2][2] = {};
  double gamma_[2] = {};
};

}  // namespace sparsha::haptics
