// Finds positions that are said to be new and are those of before.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace sparsha::haptics {

/// A hand that rests repeats its position, and so does a slow one within a step of its encoder. A device that looks at
/// the hand less often than it answers shows otherwise: moves of many steps at once, with no move just before them.
/// Metres. Allocates.
class RepeatWatch {
 public:
  /// `least_step_m`: DeviceLimits::encoder_step_m.
  explicit RepeatWatch(double least_step_m = 0.0) : least_step_m_(least_step_m) {}

  /// A position that is said to be new.
  void see(const Eigen::Vector3d& position_m) {
    if (known_) moves_m_.push_back((position_m - last_m_).norm());
    known_ = true;
    last_m_ = position_m;
  }
  [[nodiscard]] std::size_t seen() const noexcept { return moves_m_.size(); }
  /// Of those, the ones that are to the bit the position before them.
  [[nodiscard]] std::size_t repeated() const {
    return static_cast<std::size_t>(std::count(moves_m_.begin(), moves_m_.end(), 0.0));
  }
  /// There were moves enough to tell.
  [[nodiscard]] bool moves() const { return leaps().all >= kFew; }
  /// A share of the moves that no hand makes out of rest again and again.
  [[nodiscard]] bool repeats() const {
    const Leaps found = leaps();
    return found.all >= kFew && kShare * found.from_rest >= found.all;
  }

 private:
  static constexpr std::size_t kFew = 5, kShare = 4;
  static constexpr double kLeap_m = 20e-6;
  static constexpr double kLeapSteps = 5.0;  // one count on each of three axes is longer than a count on one

  struct Leaps {
    std::size_t all = 0, from_rest = 0;
  };
  [[nodiscard]] Leaps leaps() const {
    double step_m = std::numeric_limits<double>::infinity();
    for (const double move_m : moves_m_)
      if (move_m > 0.0) step_m = std::min(step_m, move_m);
    step_m = std::max(step_m, least_step_m_);
    Leaps found;
    for (std::size_t i = 1; i < moves_m_.size(); ++i) {
      if (moves_m_[i] < kLeap_m || moves_m_[i] < kLeapSteps * step_m) continue;
      ++found.all;
      if (moves_m_[i - 1] == 0.0) ++found.from_rest;
    }
    return found;
  }

  double least_step_m_;
  bool known_ = false;
  Eigen::Vector3d last_m_ = Eigen::Vector3d::Zero();
  std::vector<double> moves_m_;
};

}  // namespace sparsha::haptics
