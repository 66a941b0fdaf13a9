// What a hand would have got from a loop that is later than it says: a delay that nobody declared gives energy to each
// stroke over rising and falling stone, without any swing that would show it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace sparsha::haptics {

/// A passivity observer for the force of some ticks ago. Servo thread only; no allocation. Joules, newtons, metres.
class LateLoop {
 public:
  /// Ticks beyond the declared delay that are looked back at most.
  static constexpr std::size_t kMostTicks = 16;

  /// A force that was commanded.
  void command(const Eigen::Vector3d& force_n) noexcept {
    next_ = (next_ + 1) % kKept;
    forces_n_[next_] = force_n;
  }
  /// The hand's move since the last tick, what it got back otherwise (damping, a guide); what the spring holds now and
  /// how much more that is than a tick ago. `ticks`: of the declared delay and the assumed one.
  void observe(const Eigen::Vector3d& moved_m, double credit_j, double spring_j, double stored_j,
               std::size_t ticks) noexcept {
    const Eigen::Vector3d& held_n = forces_n_[(next_ + kKept - std::min(ticks, kKept - 1)) % kKept];
    balance_j_ = std::min(balance_j_ + std::min(credit_j - held_n.dot(moved_m), stored_j), spring_j);
  }
  void reset() noexcept { balance_j_ = 0.0; }
  /// What the hand would have got beyond what it gave, zero or more.
  [[nodiscard]] double debt_j() const noexcept { return std::max(0.0, -balance_j_); }
  /// So much of the debt is forgotten.
  void forgive(double joules) noexcept {
    if (balance_j_ < 0.0) balance_j_ = std::min(0.0, balance_j_ + joules);
  }

 private:
  static constexpr std::size_t kKept = kMostTicks + 5;
  std::array<Eigen::Vector3d, kKept> forces_n_ = zeros();  // the newest at next_
  std::size_t next_ = 0;
  double balance_j_ = 0.0;

  static std::array<Eigen::Vector3d, kKept> zeros() {
    std::array<Eigen::Vector3d, kKept> forces;
    forces.fill(Eigen::Vector3d::Zero());
    return forces;
  }
};

}  // namespace sparsha::haptics
