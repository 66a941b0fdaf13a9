// Whether what the service lets through is what it was told.
#pragma once

#include <algorithm>

#include <Eigen/Core>

namespace sparsha::haptics::haply {

/// Servo thread; no allocation. Newtons and seconds.
class ForceMatch {
 public:
  static constexpr double kShare = 0.1, kLongest_s = 0.05;  ///< of the commanded force, and for so long
  static constexpr double kFelt_n = 0.1;
  /// The service damps and gates: it takes away. What is more than the commanded forces by so much is another's.
  static constexpr double kOthers_n = 0.3, kOthers_s = 0.01;

  /// `applied_n` may be that of either of the last two commands. `drag_n`: of the damping that the service was asked
  /// for, which may or may not be in it.
  void see(const Eigen::Vector3d& commanded_n, const Eigen::Vector3d& before_n, const Eigen::Vector3d& applied_n,
           const Eigen::Vector3d& drag_n, double period_s) noexcept {
    const double asked_n = commanded_n.norm();
    const double off_n = std::min({(applied_n - commanded_n).norm(), (applied_n - before_n).norm(),
                                   (applied_n - commanded_n - drag_n).norm(), (applied_n - before_n - drag_n).norm()});
    differs_s_ = asked_n > kFelt_n && off_n > kShare * asked_n ? differs_s_ + period_s : 0.0;
    const double more_n = applied_n.norm() - std::max(asked_n, before_n.norm()) - 1.5 * drag_n.norm();
    others_s_ = more_n > kOthers_n ? others_s_ + period_s : 0.0;
    // Along the command, without what the damping takes.
    const double along_n = asked_n > kFelt_n ? (applied_n - drag_n).dot(commanded_n) / asked_n : asked_n;
    share_ = asked_n > kFelt_n ? std::clamp(std::max(along_n, applied_n.dot(commanded_n) / asked_n) / asked_n, 0.0, 1.0)
                               : 1.0;
  }
  void clear() noexcept { *this = {}; }
  [[nodiscard]] bool differs() const noexcept { return differs_s_ > kLongest_s; }
  /// Another session, or a module of the service, sends forces as well.
  [[nodiscard]] bool others() const noexcept { return others_s_ > kOthers_s; }
  /// Of the commanded force that arrives.
  [[nodiscard]] double share() const noexcept { return share_; }

 private:
  double differs_s_ = 0.0, others_s_ = 0.0, share_ = 1.0;
};

}  // namespace sparsha::haptics::haply
