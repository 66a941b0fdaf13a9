#include "haptics/governor/look_meter.h"

#include <algorithm>
#include <functional>

#include "haptics/governor/adaptive_velocity.h"

namespace sparsha::haptics {
namespace {

// Three axes that go on by a step each, or two by two steps, are no jump.
constexpr double kJumpSteps = 3.0;
constexpr double kPlaySteps = 2.0;  // of a jump, that the hand need not have gone
constexpr double kSeenSteps = 2.0;  // that a hand would have gone before: then it would have been seen
// 100 Hz, jitter and a lost look: a hand that was the same for longer had rested.
constexpr double kLongestLook_s = 0.03;
constexpr std::size_t kEnough = 3;  // jumps after repeats
constexpr std::size_t kLong = 2;    // of the last jumps are longer than the pace: some are after a rest
constexpr double kLate = 1.5;       // of the median: a look that comes later is one that was lost, or the hand rests
constexpr double kRest = 3.0;       // of the median: no look takes so long
constexpr double kWindow_s = 1.0;

}  // namespace

double LookMeter::step_m() const noexcept {
  const double now_m = least_moves_m_[0];
  const double before_m = least_moves_m_[1];
  const double least_m = now_m > 0.0 && before_m > 0.0 ? std::min(now_m, before_m) : std::max(now_m, before_m);
  return std::max(least_step_m_, least_m > 0.0 ? least_m : kLikelyEncoderStep_m);
}

/// The smallest move of the last one to two seconds is taken for the encoder's step.
void LookMeter::learn_step(double moved_m, double period_s) noexcept {
  constexpr double kLeast_m = 0.5e-6;
  constexpr double kMost_m = 100e-6;
  learning_s_ += std::min(period_s, 0.01);
  if (learning_s_ >= kWindow_s && least_moves_m_[0] > 0.0) {
    learning_s_ = 0.0;
    least_moves_m_[1] = least_moves_m_[0];
    least_moves_m_[0] = 0.0;
  }
  if (moved_m > kLeast_m && moved_m < kMost_m && (least_moves_m_[0] == 0.0 || moved_m < least_moves_m_[0]))
    least_moves_m_[0] = moved_m;
}

void LookMeter::find_pace() noexcept {
  std::array<double, kKept> times{};
  for (std::size_t k = 0; k < count_; ++k) times[k] = jumps_[k].interval_s;
  const auto end = times.begin() + static_cast<std::ptrdiff_t>(count_);
  std::sort(times.begin(), end, std::greater<>());
  const double median_s = times[count_ / 2];
  // A hand that sticks and slips rests before each slip.
  const auto rests = std::count_if(times.begin(), end, [&](double time_s) { return time_s > kRest * median_s; });
  pace_s_ = times[std::min(static_cast<std::size_t>(rests) + kLong, count_ - 1)];
  look_s_ = std::min(pace_s_, kLate * median_s);
}

void LookMeter::add(const Jump& jump) noexcept {
  if (count_ == kKept && jumps_[next_].held) --held_;
  count_ = std::min(count_ + 1, kKept);
  if (jump.held) ++held_;
  jumps_[next_] = jump;
  next_ = (next_ + 1) % kKept;
  const bool repeats = pace_s_ > 0.0 ? 4 * held_ >= count_ : held_ >= kEnough && 2 * held_ >= count_;
  if (repeats)
    find_pace();
  else
    pace_s_ = 0.0;
}

void LookMeter::judge(double moved_m, double period_s) noexcept {
  const double step_m = this->step_m();
  const double interval_s = held_s_ + period_s;
  if (moved_m < kJumpSteps * step_m || interval_s > kLongestLook_s) return;
  const double unseen_m = (moved_m - kPlaySteps * step_m) * held_s_ / period_s;
  if (held_s_ == 0.0 || unseen_m >= kSeenSteps * step_m) add({interval_s, held_s_ > 0.0});
}

bool LookMeter::repeats(const Eigen::Vector3d& position_m, double period_s) noexcept {
  if (!(period_s > 0.0)) return false;
  const bool same = known_ && position_m == position_m_;
  since_news_s_ += period_s;
  if (same) {
    held_s_ += period_s;
    // A hand that rests is seen as often as one that moves.
    if (pace_s_ > 0.0 && since_news_s_ + 0.5 * period_s < look_s_) return true;
  } else {
    if (known_) {
      const double moved_m = (position_m - position_m_).norm();
      learn_step(moved_m, held_s_ + period_s);
      judge(moved_m, period_s);
    }
    known_ = true;
    position_m_ = position_m;
    held_s_ = 0.0;
  }
  since_news_s_ = 0.0;
  return false;
}

}  // namespace sparsha::haptics
