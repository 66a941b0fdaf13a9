#include "haptics/contact/governor.h"

#include <cmath>

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;

constexpr double kArmingTime = 0.050;  // s in free space

// Nothing that a hand holds is stronger, stiffer or more damped.
constexpr double kMostForceN = 100.0;
constexpr double kMostSlewNPerS = 1e6;
constexpr double kMostDampingNSPerM = 100.0;

/// NaN becomes zero.
double between_zero_and(double most, double value) noexcept { return value > 0.0 ? std::min(value, most) : 0.0; }

Vector3d clamped(const Vector3d& force_n, double most_n) noexcept {
  const double magnitude = force_n.norm();
  return magnitude > most_n ? Vector3d(force_n * (most_n / magnitude)) : force_n;
}

}  // namespace

DeviceLimits usable(const DeviceLimits& limits) noexcept {
  DeviceLimits result;
  result.max_force_n = between_zero_and(kMostForceN, limits.max_force_n);
  result.slew_n_per_s = between_zero_and(kMostSlewNPerS, limits.slew_n_per_s);
  result.least_damping_n_s_per_m = between_zero_and(kMostDampingNSPerM, limits.least_damping_n_s_per_m);
  result.delay_ticks = std::clamp(limits.delay_ticks, 0, kLongestDelayTicks);
  return result;
}

Vector3d deliverable(const Vector3d& force_n, double most_n) noexcept {
  const double magnitude = force_n.norm();
  if (!(magnitude > 0.0) || !std::isfinite(magnitude) || !(most_n > 0.0)) return Vector3d::Zero();
  return clamped(force_n, most_n);
}

double stiffness_limit(const DeviceLimits& limits, double period_s) noexcept {
  return 0.8 * 2.0 * limits.least_damping_n_s_per_m / (3.0 * period_s);
}

void Governor::disarm() noexcept {
  armed_ = false;
  free_s_ = 0.0;
}

void Governor::count_free_time(const GovernorInput& input) noexcept {
  free_s_ = input.contact ? 0.0 : free_s_ + std::min(input.period_s, input.nominal_period_s);
  if (free_s_ < kArmingTime) return;
  armed_ = true;
  energy_j_ = 0.0;
}

/// What the hand put in over the last interval, with the force that the device held then. The least damping of hand and
/// device is booked too: it eats what delay and encoder steps make below the stiffness limit, and without it their
/// flicker would drain the books of a hand at rest. Gains count only as far as the spring stores them: what friction
/// ate cannot come back.
void Governor::book(const GovernorInput& input) noexcept {
  displacement_m_.setZero();
  damped_j_ = 0.0;
  if (has_last_) {
    displacement_m_ = input.position_m - last_position_m_;
    damped_j_ = limits_.least_damping_n_s_per_m * displacement_m_.squaredNorm() /
                std::max(input.period_s, input.nominal_period_s);
    const double work_j = damped_j_ - commanded_n_[delay()].dot(displacement_m_);
    const double stored_j = std::max(0.0, input.spring_energy_j - last_spring_energy_j_);
    energy_j_ = std::min(energy_j_ + std::min(work_j, stored_j), input.spring_energy_j);
  }
  has_last_ = true;
  last_position_m_ = input.position_m;
  last_spring_energy_j_ = input.spring_energy_j;
}

/// Growth beyond the slew limit is cut. Whatever lies between zero and the last force is a decrease and free.
Vector3d Governor::slewed(const Vector3d& force_n, double period_s) const noexcept {
  const Vector3d& last = commanded_n_[0];
  const double squared = last.squaredNorm();
  const double share = squared > 0.0 ? std::clamp(force_n.dot(last) / squared, 0.0, 1.0) : 0.0;
  const Vector3d from = share * last;
  return from + clamped(force_n - from, limits_.slew_n_per_s * period_s);
}

/// Takes from the force what would deliver more than is in the books, the forces already on their way included, if the
/// hand goes on as it moved last.
Vector3d Governor::passive(const Vector3d& force_n) const noexcept {
  const double outward_j = force_n.dot(displacement_m_);
  if (outward_j <= 0.0) return force_n;
  double balance_j = energy_j_ + damped_j_;
  for (std::size_t k = 0; k < delay(); ++k)
    balance_j += damped_j_ - std::max(0.0, commanded_n_[k].dot(displacement_m_));
  if (balance_j >= 0.0) return force_n;
  return force_n * std::max(0.0, 1.0 + balance_j / outward_j);
}

GovernorOutput Governor::command(const Vector3d& force_n, bool saturated) noexcept {
  for (std::size_t k = kLongestDelay; k > 0; --k) commanded_n_[k] = commanded_n_[k - 1];
  commanded_n_[0] = force_n;
  return {force_n, saturated, armed_, energy_j_};
}

GovernorOutput Governor::update(const GovernorInput& input) noexcept {
  const bool finite = input.position_m.allFinite() && input.force_n.allFinite() && std::isfinite(input.spring_energy_j);
  if (!input.fresh || !finite || !(input.period_s > 0.0) || !(input.nominal_period_s > 0.0)) {
    if (!finite) disarm();
    has_last_ = false;
    energy_j_ = std::min(energy_j_, 0.0);
    return command(Vector3d::Zero(), false);
  }
  count_free_time(input);
  book(input);
  if (!armed_) return command(Vector3d::Zero(), false);
  const Vector3d most = clamped(input.force_n, limits_.max_force_n);
  const Vector3d grown = slewed(most, std::min(input.period_s, input.nominal_period_s));
  const Vector3d safe = deliverable(passive(grown), limits_.max_force_n);
  return command(safe, safe != input.force_n);
}

}  // namespace sparsha::haptics
