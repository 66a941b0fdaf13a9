// What the simulated person intends: rounds of free space, approach, press, stroke and lift, drawn from a seed.
// Guided by the force felt, as a person is, so that it finds and follows any surface.
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace sparsha::haptics {

/// Device frame. Deterministic for a seed and a history of felt forces; no allocation, no exceptions.
class ExplorationRound {
 public:
  explicit ExplorationRound(std::uint64_t seed, double workspace_width_m) noexcept;

  enum class Phase { hover, approach, press, stroke, lift };

  /// The intended position after `dt_s`, given what the hand feels now and where it is.
  [[nodiscard]] const Eigen::Vector3d& advance(const Eigen::Vector3d& felt_force_n, const Eigen::Vector3d& hand_m,
                                               double dt_s) noexcept;
  [[nodiscard]] const Eigen::Vector3d& target_m() const noexcept { return target_m_; }
  [[nodiscard]] Phase phase() const noexcept { return phase_; }

 private:
  void enter(Phase phase) noexcept;
  [[nodiscard]] double uniform(double low, double high) noexcept;
  void regulate(const Eigen::Vector3d& felt_force_n, double dt_s) noexcept;

  std::uint64_t random_;
  double radius_m_;  // of the area that is stroked
  Phase phase_ = Phase::hover;
  Eigen::Vector3d target_m_;
  double phase_s_ = 0.0;
  double phase_length_s_ = 0.0;
  Eigen::Vector3d goal_m_;
  double wanted_force_n_ = 1.0;
  double speed_ = 0.05;
  double heading_rad_ = 0.0;
  double turn_rad_per_s_ = 0.0;
};

}  // namespace sparsha::haptics
