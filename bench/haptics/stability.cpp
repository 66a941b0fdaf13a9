// Energy delivered, swing and share of altered ticks by mass, damping, delay, rate and stiffness. The hand is that of
// the tests and shares no code with the governor.
#include "bench/haptics/stability.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "base/thread_pool.h"
#include "tests/support/touch_loop.h"

namespace sparsha::bench {
namespace {

using test::Ground;
using test::TouchCase;

struct Row {
  std::string name;
  std::vector<TouchCase> cases;
};

/// Each case for light and heavy hands of little and of ordinary damping, held and stroked.
Row row(std::string name, TouchCase base, const std::vector<double>& dampings, bool quick) {
  Row result{std::move(name), {}};
  for (const double damping : dampings)
    for (const double mass : {0.05, 0.15, 0.5})
      for (const bool stroke : {false, true})
        for (const Ground ground : test::kGrounds) {
          if (quick && ground != Ground::plane && ground != Ground::relief) continue;
          if (base.strike_m_per_s > 0.0 && (stroke || ground != Ground::plane)) continue;
          TouchCase c = base;
          c.damping_n_s_per_m = damping;
          c.mass_kg = mass;
          c.stroke = stroke;
          c.ground = ground;
          result.cases.push_back(c);
        }
  return result;
}

std::vector<Row> rows(bool quick) {
  std::vector<Row> result;
  const auto add = [&](const std::string& name, const TouchCase& c, const std::vector<double>& dampings) {
    result.push_back(row(name, c, dampings, quick));
  };
  const std::vector<double> weak = {0.3, 1.0};
  const std::vector<double> ordinary = {2.0, 10.0};
  TouchCase c;
  add("1 kHz, 1 ms", c, ordinary);
  add("1 kHz, 1 ms", c, weak);
  c.delay_s = 0.003;
  add("1 kHz, 3 ms undeclared", c, ordinary);
  add("1 kHz, 3 ms undeclared", c, weak);
  c.declared_ticks = 3;
  add("1 kHz, 3 ms declared", c, weak);
  c.declared_ticks = 1;
  c.rate_hz = 333.0;
  add("333 Hz, planned 1 kHz, 3 ms", c, weak);
  c.rate_hz = c.configured_hz = 4000.0;
  c.wish_n_per_m = 8000.0;
  add("4 kHz, 3 ms undeclared, 8000 N/m", c, weak);
  c = TouchCase{};
  c.jitter_s = 0.003;
  c.lost = 0.1;
  add("1 kHz, jitter 3 ms, 10 % lost", c, weak);
  c = TouchCase{};
  c.strike_m_per_s = 0.3;
  c.duration_s = 4.0;
  add("strike at 0.3 m/s", c, ordinary);
  add("strike at 0.3 m/s", c, weak);
  return result;
}

struct Both {
  test::TouchResult governed, free;
};

/// With and without the governor, on all processors: nothing is timed here, and each run has its own seed.
std::vector<Both> both_of(const std::vector<TouchCase>& cases, const std::map<Ground, pipeline::ScenePointer>& scenes) {
  std::vector<Both> results(cases.size());
  ThreadPool().for_ranges(cases.size(), 1, [&](std::size_t k, std::size_t) {
    TouchCase c = cases[k];
    results[k].governed = test::touch(c, scenes.at(c.ground));
    c.governed = false;
    results[k].free = test::touch(c, scenes.at(c.ground));
  });
  return results;
}

}  // namespace

bool write_stability(const std::filesystem::path& folder, bool quick) {
  std::map<Ground, pipeline::ScenePointer> scenes;
  for (const Ground ground : test::kGrounds) scenes[ground] = test::make_ground(ground);
  std::ofstream csv(folder / "haptics_stability.csv");
  csv << "case,ground,motion,mass_kg,damping_n_s_per_m,delivered_j,swing_m,altered,static_share,stiffness_n_per_m,"
         "calm_s\n";
  std::printf(
      "| loop | damping | ungoverned mJ | delivered mJ | swing held, steps | altered ticks | calm after s |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Row& each : rows(quick)) {
    double free_j = 0.0, most_j = 0.0, swing = 0.0, altered = 0.0, calm_s = -1.0;
    const std::vector<Both> results = both_of(each.cases, scenes);
    for (std::size_t k = 0; k < each.cases.size(); ++k) {
      const TouchCase& c = each.cases[k];
      const test::TouchResult& r = results[k].governed;
      free_j = std::max(free_j, results[k].free.delivered_j);
      most_j = std::max(most_j, r.delivered_j);
      if (!c.stroke && c.strike_m_per_s == 0.0) swing = std::max(swing, r.swing_m / c.encoder_step_m);
      altered = std::max(altered, r.altered);
      calm_s = std::max(calm_s, r.calm_s);
      csv << each.name << ',' << test::name_of(c.ground) << ',' << (c.stroke ? "stroke" : "hold") << ',' << c.mass_kg
          << ',' << c.damping_n_s_per_m << ',' << r.delivered_j << ',' << r.swing_m << ',' << r.altered << ','
          << r.static_share << ',' << r.stiffness_n_per_m << ',' << r.calm_s << '\n';
    }
    const bool strikes = each.cases.front().strike_m_per_s > 0.0;
    std::printf("| %s | %.1f to %.1f | %.0f | %.2f | %s | %.2f %% | %s |\n", each.name.c_str(),
                each.cases.front().damping_n_s_per_m, each.cases.back().damping_n_s_per_m, 1e3 * free_j, 1e3 * most_j,
                strikes ? "" : std::to_string(swing).substr(0, 4).c_str(), 100.0 * altered,
                strikes ? std::to_string(calm_s).substr(0, 4).c_str() : "");
    std::fflush(stdout);
  }
  return static_cast<bool>(csv.flush());
}

}  // namespace sparsha::bench
