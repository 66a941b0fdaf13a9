// Methods that take turns in one run, and their times beside each other: the harness for comparisons of times.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

namespace sparsha::bench {

/// A method's part in a comparison.
struct Turn {
  std::function<double()> run;  ///< does the work once and returns its time, in any unit that all methods share
  bool slow = false;            ///< takes part in few rounds
};

struct TurnTimes {
  std::vector<double> times;  ///< of the rounds in which it took part
  double ratio = 1.0;         ///< median over these rounds of its time over that of the first method in the same round
  double ratio_low = 1.0, ratio_high = 1.0;  ///< least and greatest of these

  [[nodiscard]] double best() const;     ///< least time; not a number without a round, as those below
  [[nodiscard]] double median() const;   ///< of the times
  [[nodiscard]] double longest() const;  ///< greatest time
};

/// Every round runs each method once, each round another one first; slow ones in the first `slow_rounds` only. Ratios
/// refer to the first method, which must not be slow.
[[nodiscard]] std::vector<TurnTimes> take_turns(const std::vector<Turn>& methods, int rounds, int slow_rounds = 0);

/// Probability that the true median of a ratio lies between the least and the greatest of `rounds` independent ones.
[[nodiscard]] double range_confidence(int rounds);

/// Wall time of `work()`.
template <typename Work>
[[nodiscard]] double seconds_of(const Work& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

/// Of two readings of the clock without anything between, nanoseconds, median.
[[nodiscard]] double timer_overhead_ns();
/// Does nothing with a result, out of the compiler's sight, so that its computation cannot be left out.
void use_result(double result);

/// Times of the ticks of a path that is gone several times. The same path gives the same work at every tick, so that
/// the best of several rounds is the tick without its disturbances.
class TickTimes {
 public:
  /// The first `lead` ticks are run and not counted; the others are timed in groups, whose mean stands for a tick: for
  /// ticks that are shorter than the clock can tell. `ticks` is a multiple of `group`.
  TickTimes(std::size_t lead, std::size_t ticks, std::size_t group = 1);

  /// Runs `work(tick)` for every tick, which returns a number of its result; mean time of a counted tick in this round,
  /// nanoseconds, less the timer.
  template <typename Work>
  double time_round(const Work& work) {
    double sum_ns = 0.0, result = 0.0;
    for (std::size_t tick = 0; tick < lead_; ++tick) result += work(tick);
    std::size_t tick = lead_;
    for (double& best : best_ns_) {
      const auto began = std::chrono::steady_clock::now();
      for (std::size_t k = 0; k < group_; ++k) result += work(tick++);
      const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - began;
      const double ns = std::max(0.0, took.count() - overhead_ns_) / static_cast<double>(group_);
      sum_ns += ns;
      best = std::min(best, ns);
    }
    use_result(result);
    return sum_ns / static_cast<double>(best_ns_.size());
  }

  /// Of the ticks, each the best of its rounds; `share` from 0 to 1.
  [[nodiscard]] double quantile_ns(double share) const;

 private:
  std::size_t lead_;
  std::size_t group_;
  double overhead_ns_;
  std::vector<double> best_ns_;
};

}  // namespace sparsha::bench
