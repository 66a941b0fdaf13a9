#include "bench/race/measure.h"

#include <utility>

#include "bench/report/turns.h"
#include "protocol/score.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

void measure_errors(Peer& peer, const protocol::Course& course, Row& row) {
  std::vector<Vector3d> forces, truth;
  peer.place(course.hands.front());
  for (std::size_t tick = 0; tick < course.hands.size(); ++tick) {
    forces.push_back(peer.update(course.hands[tick]).force_m);
    truth.emplace_back(course.feet[tick] - course.hands[tick]);
  }
  const protocol::Score score = protocol::score_forces(forces, truth, course.first, truth.size());
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

Field make_field(const protocol::Ground& ground, int nodes, std::vector<Entrant> entrants) {
  Field field{sample(ground, nodes), std::move(entrants), {}, {}};
  for (const Entrant& entrant : field.entrants) {
    field.seconds.push_back(seconds_of([&] { field.peers.push_back(entrant.make(field.surface)); }));
  }
  return field;
}

std::vector<Row> race(const Scenario& scenario, const Field& field, int ticks, int repeats) {
  const protocol::Course course =
      protocol::make_course(scenario.ground, 0.001 * scenario.speed_m_per_s, scenario.depth_m, ticks);
  std::vector<Row> rows;
  for (std::size_t n = 0; n < field.entrants.size(); ++n) {
    Row row;
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
  std::vector<TickTimes> times(field.peers.size(), TickTimes(course.first, static_cast<std::size_t>(ticks)));
  std::vector<Turn> methods;
  for (std::size_t n = 0; n < field.peers.size(); ++n)
    methods.push_back({[&peer = *field.peers[n], &mine = times[n], &course] {
      peer.place(course.hands.front());
      return mine.time_round([&](std::size_t tick) { return peer.update(course.hands[tick]).force_m.z(); });
    }});
  const std::vector<TurnTimes> taken = take_turns(methods, repeats);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    rows[n].ratio_low = taken[n].ratio_low;
    rows[n].ratio_high = taken[n].ratio_high;
    rows[n].ratio = taken[n].ratio;
    rows[n].p50_ns = times[n].quantile_ns(0.5);
    rows[n].p99_ns = times[n].quantile_ns(0.99);
    rows[n].max_ns = times[n].quantile_ns(1.0);
  }
  return rows;
}

}  // namespace sparsha::bench
