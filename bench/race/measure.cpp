#include "measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/statistics.h"
#include "bench/open/score.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;
using Clock = std::chrono::steady_clock;

double between_ns(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double, std::nano>(end - begin).count();
}

struct Running {
  Peer* peer;
  std::vector<double> best_ns;   ///< per tick
  std::vector<double> means_ns;  ///< per repeat
};

void run_timed(Running& running, const Course& course, double overhead_ns) {
  running.peer->place(course.hands.front());
  double sum = 0.0;
  double sink = 0.0;
  for (std::size_t tick = 0; tick < course.hands.size(); ++tick) {
    const Clock::time_point begin = Clock::now();
    sink += running.peer->update(course.hands[tick]).force_m.z();
    const double ns = std::max(0.0, between_ns(begin, Clock::now()) - overhead_ns);
    if (tick < course.first) continue;
    sum += ns;
    double& best = running.best_ns[tick - course.first];
    best = std::min(best, ns);
  }
  // The sum of forces is used, so that no update can be left out.
  running.means_ns.push_back(sum / static_cast<double>(running.best_ns.size()) + (sink == 0.125 ? 1e-9 : 0.0));
}

void measure_errors(Peer& peer, const Course& course, Row& row) {
  std::vector<Vector3d> forces, truth;
  peer.place(course.hands.front());
  for (std::size_t tick = 0; tick < course.hands.size(); ++tick) {
    forces.push_back(peer.update(course.hands[tick]).force_m);
    truth.emplace_back(course.feet[tick] - course.hands[tick]);
  }
  const Score score = score_forces(forces, truth, course.first, truth.size());
  row.lost = score.lost;
  row.jumps = score.jumps;
  row.error_median = score.error_median;
  row.error_p99 = score.error_p99;
  row.size_median = score.size_median;
  row.size_p99 = score.size_p99;
  row.angle_median_deg = score.angle_median_deg;
  row.angle_p99_deg = score.angle_p99_deg;
}

}  // namespace

double timer_overhead_ns() {
  std::vector<double> pauses(2001);
  for (double& pause : pauses) {
    const Clock::time_point begin = Clock::now();
    pause = between_ns(begin, Clock::now());
  }
  return median(pauses);
}

Field make_field(const Ground& ground, int nodes, std::vector<Entrant> entrants) {
  Field field{sample(ground, nodes), std::move(entrants), {}, {}};
  for (const Entrant& entrant : field.entrants) {
    const Clock::time_point begin = Clock::now();
    field.peers.push_back(entrant.make(field.surface));
    field.seconds.push_back(1e-9 * between_ns(begin, Clock::now()));
  }
  return field;
}

std::vector<Row> race(const Scenario& scenario, const Field& field, int ticks, int repeats) {
  const Course course = make_course(scenario.ground, 0.001 * scenario.speed_m_per_s, scenario.depth_m, ticks);
  const double overhead_ns = timer_overhead_ns();
  std::vector<Row> rows;
  std::vector<Running> all;
  for (std::size_t n = 0; n < field.entrants.size(); ++n) {
    Row row;
    all.push_back({field.peers[n].get(), std::vector<double>(static_cast<std::size_t>(ticks), 1e18), {}});
    row.seconds = field.seconds[n];
    row.method = field.entrants[n].method;
    row.setting = field.entrants[n].setting;
    row.group = scenario.group;
    row.ground = scenario.ground.name;
    row.nodes = scenario.nodes;
    row.speed_m_per_s = scenario.speed_m_per_s;
    row.depth_m = scenario.depth_m;
    row.bytes = field.peers[n]->bytes();
    for (std::size_t k = course.first + 1; k < course.feet.size(); ++k)
      row.cells_per_tick += (course.feet[k] - course.feet[k - 1]).head<2>().norm() * (scenario.nodes - 1) / ticks;
    measure_errors(*field.peers[n], course, row);
    rows.push_back(row);
  }
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t k = 0; k < all.size(); ++k)
      run_timed(all[(k + static_cast<std::size_t>(repeat)) % all.size()], course, overhead_ns);
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::vector<double> ratios;
    for (std::size_t r = 0; r < all[k].means_ns.size(); ++r)
      ratios.push_back(all[k].means_ns[r] / all.front().means_ns[r]);
    // Between the least and the greatest of n independent ratios the median lies with probability 1 - 2^(1-n).
    rows[k].ratio_low = *std::min_element(ratios.begin(), ratios.end());
    rows[k].ratio_high = *std::max_element(ratios.begin(), ratios.end());
    rows[k].ratio = median(ratios);
    rows[k].p50_ns = quantile(all[k].best_ns, 0.5);
    rows[k].p99_ns = quantile(all[k].best_ns, 0.99);
    rows[k].max_ns = quantile(all[k].best_ns, 1.0);
  }
  return rows;
}

}  // namespace sparsha::bench
