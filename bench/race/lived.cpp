#include "bench/race/lived.h"

#include <chrono>
#include <thread>

#include "base/numbers/statistics.h"
#include "bench/report/turns.h"

namespace sparsha::bench {

std::vector<LivedRow> live(const Scenario& scenario, const Field& field, int ticks) {
  using Clock = std::chrono::steady_clock;
  const std::vector<Row> hot = race(scenario, field, ticks, 5);
  const protocol::Course course =
      protocol::make_course(scenario.ground, 0.001 * scenario.speed_m_per_s, scenario.depth_m, ticks);
  const double overhead_ns = timer_overhead_ns();
  std::vector<std::vector<double>> times(field.peers.size());
  for (const PeerPointer& peer : field.peers) peer->place(course.hands.front());
  double sink = 0.0;
  Clock::time_point wake = Clock::now();
  for (std::size_t tick = 0; tick < course.hands.size(); ++tick)
    for (std::size_t n = 0; n < field.peers.size(); ++n) {
      wake += std::chrono::milliseconds(1);
      std::this_thread::sleep_until(wake);
      const Clock::time_point begin = Clock::now();
      sink += field.peers[n]->update(course.hands[tick]).force_m.z();
      const double ns = std::chrono::duration<double, std::nano>(Clock::now() - begin).count() - overhead_ns;
      if (tick >= course.first) times[n].push_back(std::max(0.0, ns));
    }
  std::vector<LivedRow> rows;
  for (std::size_t n = 0; n < field.peers.size(); ++n) {
    LivedRow row;
    row.method = hot[n].method;
    row.hot_p50_ns = hot[n].p50_ns;
    row.hot_p99_ns = hot[n].p99_ns;
    row.error_median = hot[n].error_median;
    row.p50_ns = quantile(times[n], 0.5);
    row.p99_ns = quantile(times[n], 0.99);
    row.max_ns = quantile(times[n], 1.0) + (sink == 0.125 ? 1e-9 : 0.0);  // the sum is used: no update can be left out
    rows.push_back(row);
  }
  return rows;
}

}  // namespace sparsha::bench
