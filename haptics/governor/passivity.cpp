// The governor's account of energy, and what it takes from a force that would deliver more than the hand has given.
#include <algorithm>
#include <cmath>

#include "haptics/governor/clamped.h"
#include "haptics/governor/governor.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;

constexpr double kPlay = 1.05;              // encoder steps that are flicker
constexpr double kCredit_n_s_per_m = 0.25;  // damping that every hand has
constexpr double kSmoothEnd_j = 0.5e-3;     // that a contact may deliver besides while its force ends

}  // namespace

/// As observe_energy(), of a loop that is later. Of damping only what goes along the force counts: a stroke along the
/// stone would earn far more than its rise and fall.
void Governor::observe_late_loop(const GovernorInput& input, const Vector3d& held_n, double stored_j) noexcept {
  const double held = held_n.norm();
  const double squared_m2 = displacement_m_.squaredNorm();
  const double along_m = held > 0.0 ? displacement_m_.dot(held_n) / held : 0.0;
  const double credit_j = squared_m2 > 0.0 ? damped_j_ * along_m * along_m / squared_m2 : 0.0;
  const double late = std::min(std::round(late_s() / pace_s_), static_cast<double>(LateLoop::kMostTicks));
  late_.observe(displacement_m_, credit_j + input.supplied_j, input.spring_energy_j, stored_j,
                delay() + static_cast<std::size_t>(late));
}

/// The energy that the hand put in over the last interval, with the force that the device held then. The damping that
/// every hand has is added, and moves within an encoder's step are left out: quantisation would make the observed
/// energy of a hand at rest fall. Energy counts only as far as the spring stores it: friction does not return what it
/// dissipates. What a guide has put into its springs counts as if the hand had, so that the hand may get it. Over a gap
/// it is unknown which force was held when: a move outwards counts with the largest, one inwards with the least.
void Governor::observe_energy(const GovernorInput& input) noexcept {
  displacement_m_.setZero();
  damped_j_ = 0.0;
  if (has_last_) {
    const bool gap = gap_s_ > 0.0;
    Vector3d held_n = commanded_n_[delay()];
    if (gap_n_.squaredNorm() > held_n.squaredNorm()) held_n = gap_n_;
    const double held = held_n.norm();
    displacement_m_ = input.position_m - observed_m_;
    if (held > 0.0) {
      const double along_m = displacement_m_.dot(held_n) / held;
      displacement_m_ -= held_n * (std::clamp(along_m, -kPlay * step_m_, kPlay * step_m_) / held);
    }
    observed_m_ += displacement_m_;
    // A damper takes no less over any way than over the even one from end to end.
    damped_j_ = std::min(kCredit_n_s_per_m, limits_.least_damping_n_s_per_m) * displacement_m_.squaredNorm() /
                std::max(gap_s_ + input.period_s, pace_s_);
    double given_j = held_n.dot(displacement_m_);
    if (gap && given_j < 0.0 && held > 0.0) given_j *= gap_least_n_ / held;
    const double work_j = damped_j_ - given_j;
    const double stored_j = std::max(0.0, input.spring_energy_j - last_spring_energy_j_);
    energy_j_ = std::min(energy_j_ + std::min(work_j + input.supplied_j, stored_j), input.spring_energy_j);
    if (late_s() > 0.0) observe_late_loop(input, held_n, stored_j);
  } else {
    observed_m_ = input.position_m;
  }
  has_last_ = true;
  gap_s_ = 0.0;
  gap_n_.setZero();
  last_position_m_ = input.position_m;
  last_spring_energy_j_ = input.spring_energy_j;
}

/// What a force may become in this tick without a kick, where the surface may give way: it falls and rises by a little
/// and by some times what the hand's move explains.
Governor::Range Governor::smooth_range(const GovernorInput& input) const noexcept {
  constexpr double kStep_n = 0.034;
  constexpr double kFall = 2.9;
  constexpr double kRise = 2.0;
  const double moved_n = input.stiffness_n_per_m * displacement_m_.norm();
  const double last_n = commanded_n_[0].norm();
  return {std::max(0.0, last_n - kStep_n - kFall * moved_n), last_n + kStep_n + kRise * moved_n};
}

/// No more than what can end with the energy that is left, if it falls twice as fast as its spring: passive() alone
/// would let the whole force go on until the energy is used up, and end it within a tick. Damping takes no more from it
/// than what is smooth.
Vector3d Governor::tapered(const GovernorInput& input, const Vector3d& force_n) const noexcept {
  const double wished = input.force_n.norm();
  if (!input.gives_way || !(input.stiffness_n_per_m > 0.0) || !(wished > 0.0)) return force_n;
  const Range range = smooth_range(input);
  const double stored_n = std::sqrt(4.0 * input.stiffness_n_per_m * std::max(0.0, balance_j()));
  const double effects_n = input.effects_n.norm();
  const double most_n = std::min(std::max(stored_n, range.least_n), range.most_n) + effects_n;
  const double least_n = std::min({range.least_n, wished - effects_n, most_n});
  const double size_n = force_n.norm();
  if (size_n >= least_n) return clamped(force_n, most_n);
  return size_n > 0.0 ? Vector3d(force_n * (least_n / size_n)) : Vector3d(input.force_n * (least_n / wished));
}

/// A hand that slips off an edge loses its force over some ticks, and not at once: what goes in one is bounded besides
/// what the hand's move explains. A fingertip leaves an edge as it leaves a rounded one.
Vector3d Governor::eased(const GovernorInput& input, const Vector3d& force_n) const noexcept {
  constexpr double kMostLost_n = 0.5;
  const Vector3d surface_n = force_n - input.effects_n;
  if (surface_n.squaredNorm() >= surface_n_.squaredNorm()) return force_n;
  const double most_n = kMostLost_n + input.stiffness_n_per_m * displacement_m_.norm();
  return force_n + (surface_n_ - surface_n) + clamped(surface_n - surface_n_, most_n);
}

/// The observed energy that is left when the forces on their way have arrived, if the hand goes on as it moved last.
double Governor::balance_j() const noexcept {
  double balance_j = energy_j_ + damped_j_ + kOverdraft_j;
  for (std::size_t k = 0; k < delay(); ++k)
    balance_j += damped_j_ - std::max(0.0, commanded_n_[k].dot(displacement_m_));
  return balance_j;
}

/// Takes from the force what would deliver more than that. Where the surface has given way a little more may go, so
/// that the force ends smoothly.
Vector3d Governor::passive(const GovernorInput& input, const Vector3d& force_n) const noexcept {
  const double outward_j = force_n.dot(displacement_m_);
  if (outward_j <= 0.0) return force_n;
  const double balance_j = this->balance_j();
  if (balance_j >= 0.0) return force_n;
  double share = std::max(0.0, 1.0 + balance_j / outward_j);
  const double size_n = force_n.norm();
  if (input.gives_way && balance_j > -kSmoothEnd_j)
    share = std::max(share, std::min(1.0, smooth_range(input).least_n / size_n));
  return force_n * share;
}

}  // namespace sparsha::haptics
