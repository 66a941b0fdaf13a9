// Which question an answer belongs to. The device answers one after the other and numbers nothing: an answer is that to
// the oldest question that is open.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace sparsha::haptics::falcon {

/// An answer that is lost leaves its question open, and every later answer then looks late by one more; a link that is
/// late looks the same. To tell them apart no question is asked for a while: what was only late comes then. Times in
/// seconds, of one clock. Servo thread; no allocation.
class OpenQuestions {
 public:
  /// An answer that has not come by then never will.
  static constexpr double kForgotten_s = 0.05;
  /// Questions that stay open for so long are looked at. Twice as long after each look at a link that was only late.
  static constexpr double kFirstLook_s = 0.02, kLastLook_s = 1.0;
  /// After a look that found answers lost: it cost a tick without an answer. Where many are lost, delays seem longer
  /// meanwhile, and the stone becomes softer.
  static constexpr double kNextLook_s = 0.1;

  void clear() noexcept { *this = {}; }
  /// More than kMost are not kept: the oldest goes.
  void ask(double time_s) noexcept {
    if (count_ == kMost) drop();
    asked_s_[(first_ + count_++) % kMost] = time_s;
  }
  /// Seconds from the question to its answer, which comes now; 0 when no question is open.
  double answer(double time_s) noexcept {
    while (count_ > 0 && time_s - asked_s_[first_] > kForgotten_s) drop();
    double took_s = 0.0;
    if (count_ > 0) {
      took_s = time_s - asked_s_[first_];
      drop();
    }
    if (count_ > 0) return took_s;
    if (holds_) look_s_ = std::min(2.0 * look_s_, kLastLook_s);
    holds_ = false;
    none_open_s_ = time_s;
    return took_s;
  }
  /// An answer is still to be expected.
  [[nodiscard]] bool any() const noexcept { return count_ > 0; }
  /// True while no question may be asked.
  [[nodiscard]] bool holds(double time_s) noexcept {
    holds_ = holds_ || (count_ > 0 && time_s - none_open_s_ > look_s_ && time_s - lost_s_ > kNextLook_s);
    return holds_;
  }
  /// Nothing came for longer than answers are apart: what is open meanwhile was lost.
  void stays_silent(double time_s) noexcept {
    if (!holds_) return;
    clear();
    none_open_s_ = lost_s_ = time_s;
  }

 private:
  static constexpr std::size_t kMost = 64;
  void drop() noexcept {
    first_ = (first_ + 1) % kMost;
    --count_;
  }

  std::array<double, kMost> asked_s_{};
  std::size_t first_ = 0, count_ = 0;
  double none_open_s_ = 0.0;      ///< when that was so last
  double lost_s_ = -kNextLook_s;  ///< when a look found answers lost last
  double look_s_ = kFirstLook_s;
  bool holds_ = false;
};

}  // namespace sparsha::haptics::falcon
