// Updates as they are lived: one method a wake-up, 1 kHz, woken from sleep, instead of one after the other on warm
// caches and a running clock.
#pragma once

#include <string>
#include <vector>

#include "bench/race/measure.h"

namespace sparsha::bench {

struct LivedRow {
  std::string method;
  double hot_p50_ns = 0.0;  ///< of the same ticks, one after the other, the best of some repeats
  double hot_p99_ns = 0.0;
  double p50_ns = 0.0;  ///< woken from sleep, each tick once
  double p99_ns = 0.0;
  double max_ns = 0.0;
  double error_median = 0.0;  ///< of the force, over the true force
};

/// All entrants take turns: every millisecond the thread wakes and one of them does its next tick.
[[nodiscard]] std::vector<LivedRow> live(const Scenario& scenario, const Field& field, int ticks);

}  // namespace sparsha::bench
