// One entrant over one course: times and errors, tick by tick.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/peers/entrants.h"
#include "protocol/course.h"

namespace sparsha::bench {

/// What is raced on, but for the entrants.
struct Scenario {
  std::string group;  ///< what this row shows: front, speed, depth, size, surfaces
  protocol::Ground ground;
  int nodes = 200;  ///< per side
  double speed_m_per_s = 0.25;
  double depth_m = 0.002;
};

struct Row {
  std::string method;
  std::string setting;
  std::string group;
  std::string ground;
  int nodes = 0;
  double speed_m_per_s = 0.0;
  double depth_m = 0.0;
  double cells_per_tick = 0.0;
  double seconds = 0.0;  ///< of pre-processing
  std::size_t bytes = 0;
  double p50_ns = 0.0;  ///< of ticks, each the best of the repeats, timer overhead off
  double p99_ns = 0.0;
  double max_ns = 0.0;
  double ratio = 0.0;  ///< median over the repeats of this method's mean time over that of `exact` in the same repeat
  double ratio_low = 0.0;
  double ratio_high = 0.0;
  double error_median = 0.0;  ///< of the force vector over the true force; no force: 1
  double error_p99 = 0.0;
  double size_median = 0.0;  ///< | |F| / |F true| - 1 |
  double size_p99 = 0.0;
  double angle_median_deg = 0.0;
  double angle_p99_deg = 0.0;
  double lost = 0.0;  ///< share of ticks without force, not finite, or off by as much as the force
  double jumps =
      0.0;  ///< share of ticks in which the force changes otherwise than the truth by 7 % of it: one can feel it
};

/// A surface's nodes, and the entrants made from them one after the other.
struct Field {
  haptics::MongeSurface surface;
  std::vector<Entrant> entrants;
  std::vector<PeerPointer> peers;
  std::vector<double> seconds;  ///< each took to be made
};

[[nodiscard]] Field make_field(const protocol::Ground& ground, int nodes, std::vector<Entrant> entrants);

/// All entrants take turns over the same path, `repeats` times, each time another one first. The first entrant is what
/// ratios refer to.
[[nodiscard]] std::vector<Row> race(const Scenario& scenario, const Field& field, int ticks, int repeats);

}  // namespace sparsha::bench
