// How often a device really looks at the hand. A driver that answers faster than its device looks repeats the last
// position and calls it new: a loop that believes it takes a wall of 10 ms for one of 1 ms.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace sparsha::haptics {

/// Tells repeats from a hand that rests or is slow by what comes after them. A hand whose encoder has not moved for
/// some time goes on by a step of it; a device that repeats goes on by many at once, again and again. Servo thread
/// only; no allocation. Metres, seconds, any frame.
class LookMeter {
 public:
  /// `least_step_m`: DeviceLimits::encoder_step_m.
  explicit LookMeter(double least_step_m = 0.0) noexcept : least_step_m_(least_step_m) {}

  /// A finite position that the device calls new, `period_s` after the last one of those. True: it is a repeat, and
  /// says nothing about the hand.
  [[nodiscard]] bool repeats(const Eigen::Vector3d& position_m, double period_s) noexcept;

  /// The long ones of the times between two looks; 0 as long as nothing speaks for repeats.
  [[nodiscard]] double pace_s() const noexcept { return pace_s_; }

 private:
  /// A move of several encoder steps, and how long the position had been the same before.
  struct Jump {
    double interval_s = 0.0;  ///< since the jump or change before it
    bool held = false;        ///< a hand of this speed would have been seen to move before
  };
  static constexpr std::size_t kKept = 32;

  void learn_step(double moved_m, double period_s) noexcept;
  void judge(double moved_m, double period_s) noexcept;
  void add(const Jump& jump) noexcept;
  void find_pace() noexcept;
  [[nodiscard]] double step_m() const noexcept;

  double least_step_m_;
  bool known_ = false;
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
  double held_s_ = 0.0;        // from the first sample at this position to the last
  double since_news_s_ = 0.0;  // since a sample that was no repeat
  std::array<Jump, kKept> jumps_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  std::size_t held_ = 0;  // of the jumps
  double pace_s_ = 0.0;
  double look_s_ = 0.0;           // a device that repeats has looked again after so long
  double least_moves_m_[2] = {};  // of this second of samples and of the last one
  double learning_s_ = 0.0;
};

}  // namespace sparsha::haptics
