#include "bench/report/turns.h"

#include <cmath>

#include "base/numbers/statistics.h"

namespace sparsha::bench {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
volatile double last_result = 0.0;

}  // namespace

double TurnTimes::best() const { return times.empty() ? kNone : *std::min_element(times.begin(), times.end()); }
double TurnTimes::longest() const { return times.empty() ? kNone : *std::max_element(times.begin(), times.end()); }
double TurnTimes::median() const {
  std::vector<double> sorted = times;
  return times.empty() ? kNone : sparsha::median(sorted);
}

std::vector<TurnTimes> take_turns(const std::vector<Turn>& methods, int rounds, int slow_rounds) {
  const std::size_t count = methods.size();
  std::vector<TurnTimes> taken(count);
  for (int round = 0; round < rounds; ++round)
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t n = (k + static_cast<std::size_t>(round)) % count;
      if (!methods[n].slow || round < slow_rounds) taken[n].times.push_back(methods[n].run());
    }
  for (TurnTimes& turns : taken) {
    if (turns.times.empty()) continue;
    std::vector<double> ratios;
    for (std::size_t round = 0; round < turns.times.size(); ++round)
      ratios.push_back(turns.times[round] / taken.front().times[round]);
    turns.ratio_low = *std::min_element(ratios.begin(), ratios.end());
    turns.ratio_high = *std::max_element(ratios.begin(), ratios.end());
    turns.ratio = median(ratios);
  }
  return taken;
}

double range_confidence(int rounds) { return 1.0 - std::exp2(1.0 - rounds); }

double timer_overhead_ns() {
  std::vector<double> pauses(2001);
  for (double& pause : pauses) pause = 1e9 * seconds_of([] {});
  return median(pauses);
}

void use_result(double result) { last_result = result; }

TickTimes::TickTimes(std::size_t lead, std::size_t ticks, std::size_t group)
    : lead_(lead),
      group_(group),
      overhead_ns_(timer_overhead_ns()),
      best_ns_(ticks / group, std::numeric_limits<double>::max()) {}

double TickTimes::quantile_ns(double share) const {
  std::vector<double> sorted = best_ns_;
  return quantile(sorted, share);
}

}  // namespace sparsha::bench
