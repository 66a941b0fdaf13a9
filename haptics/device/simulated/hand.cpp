#include "haptics/device/simulated/hand.h"

#include <algorithm>
#include <cmath>

namespace sparsha::haptics {

SimulatedHand::SimulatedHand(const HandParameters& parameters, const Eigen::Vector3d& position_m) noexcept
    : parameters_(parameters), position_m_(position_m), target_m_(position_m) {}

void SimulatedHand::place(const Eigen::Vector3d& position_m) noexcept {
  position_m_ = position_m;
  target_m_ = position_m;
  velocity_.setZero();
}

Eigen::Vector3d SimulatedHand::measured_m() const noexcept {
  const double step = parameters_.encoder_step_m;
  if (step <= 0.0) return position_m_;
  return {step * std::round(position_m_.x() / step), step * std::round(position_m_.y() / step),
          step * std::round(position_m_.z() / step)};
}

Eigen::Vector3d SimulatedHand::saturated(const Eigen::Vector3d& force_n) const noexcept {
  const double length = force_n.norm();
  if (parameters_.max_force_n <= 0.0 || length <= parameters_.max_force_n) return force_n;
  return force_n * (parameters_.max_force_n / length);
}

// Taylor series of the exponential of [[0, 1, 0], [-k/m, -b/m, 1], [0, 0, 0]] * step: the rates times the step are far
// below one, so that a dozen terms reach the last bit.
void SimulatedHand::prepare(double step_s) noexcept {
  if (step_s == step_s_) return;
  step_s_ = step_s;
  const double a = -parameters_.stiffness_n_per_m / parameters_.mass_kg;
  const double b = -parameters_.damping_n_s_per_m / parameters_.mass_kg;
  double term[2][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};  // rows of (A * step)^n / n!
  double sum[2][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
  for (int n = 1; n <= 20; ++n) {
    const double h = step_s / n;
    for (int row = 0; row < 2; ++row) {
      const double x = term[row][0];
      const double v = term[row][1];
      term[row][0] = h * v * a;
      term[row][1] = h * (x + v * b);
      term[row][2] = h * v;
      for (int column = 0; column < 3; ++column) sum[row][column] += term[row][column];
    }
  }
  for (int row = 0; row < 2; ++row) {
    phi_[row][0] = sum[row][0];
    phi_[row][1] = sum[row][1];
    gamma_[row] = sum[row][2];
  }
}

void SimulatedHand::advance(const Eigen::Vector3d& target_m, const Eigen::Vector3d& force_n, double dt_s) noexcept {
  if (!(dt_s > 0.0)) return;
  const Eigen::Vector3d force = saturated(force_n);
  const Eigen::Vector3d start_m = position_m_;
  const Eigen::Vector3d acceleration = force / parameters_.mass_kg;
  const Eigen::Vector3d target_velocity = (target_m - target_m_) / dt_s;
  const double steps = std::max(1.0, std::ceil(dt_s / parameters_.substep_s - 1e-6));
  const double step_s = dt_s / steps;
  prepare(step_s);
  const double friction_speed = parameters_.coulomb_n / parameters_.mass_kg * step_s;
  const auto count = static_cast<std::int64_t>(steps);
  for (std::int64_t i = 0; i < count; ++i) {
    const Eigen::Vector3d e = position_m_ - target_m_;
    const Eigen::Vector3d e_dot = velocity_ - target_velocity;
    target_m_ += target_velocity * step_s;
    if (velocity_.isZero(0.0)) {
      const Eigen::Vector3d pull = force - parameters_.stiffness_n_per_m * e - parameters_.damping_n_s_per_m * e_dot;
      if (pull.norm() <= parameters_.coulomb_n) continue;
    }
    position_m_ = target_m_ + phi_[0][0] * e + phi_[0][1] * e_dot + gamma_[0] * acceleration;
    velocity_ = target_velocity + phi_[1][0] * e + phi_[1][1] * e_dot + gamma_[1] * acceleration;
    if (friction_speed > 0.0) {
      const double speed = velocity_.norm();
      velocity_ = speed <= friction_speed ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                          : Eigen::Vector3d(velocity_ * (1.0 - friction_speed / speed));
    }
  }
  target_m_ = target_m;
  work_j_ += force.dot(position_m_ - start_m);
}

}  // namespace sparsha::haptics
