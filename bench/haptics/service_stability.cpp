// The Inverse3's own limits, rates, delays and workspace, its service's damping, and its force gate on and off.
#include "bench/haptics/service_stability.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <vector>

#include "bench/haptics/touch_runs.h"
#include "haptics/device/haply/haply.h"
#include "haptics/device/haply/messages.h"

namespace sparsha::bench {
namespace {

using test::Ground;
using test::TouchCase;
using test::TouchResult;

constexpr std::array kMasses_kg{0.05, 0.15, 0.5};
constexpr std::array kDampings{0.3, 0.5, 1.0, 2.0, 5.0, 10.0};
constexpr double kGate = 0.3;     // the gain of the documented inventory
constexpr double kUsb_s = 0.001;  // from service to motors: taken, no page tells it

/// Loops by rate, damping of the service and gate.
std::vector<TouchCase> loops() {
  std::vector<TouchCase> result;
  for (const double rate_hz : {1000.0, 4000.0})
    for (const double damping : {0.0, haptics::haply::kServiceDamping})
      for (const double gain : {1.0, kGate}) {
        TouchCase c;
        c.device = haptics::haply::haply_info();
        c.rate_hz = c.configured_hz = rate_hz;
        c.declared_ticks = c.device->limits.delay_ticks;
        c.delay_s = 1.0 / rate_hz + kUsb_s;
        c.service = test::ServiceFilters{gain, damping};
        result.push_back(c);
      }
  return result;
}

std::vector<TouchRun> run_all(const std::vector<TouchCase>& loops, bool quick) {
  std::vector<TouchRun> runs;
  for (TouchCase c : loops)
    for (const double mass : kMasses_kg)
      for (const double damping : kDampings)
        for (const bool stroke : {false, true})
          for (const Ground ground : test::kGrounds) {
            if (quick && ground != Ground::plane && ground != Ground::relief) continue;
            c.mass_kg = mass;
            c.damping_n_s_per_m = damping;
            c.stroke = stroke;
            c.ground = ground;
            runs.push_back({c, {}, {}});
          }
  run_both_ways(runs);
  return runs;
}

bool same_loop(const TouchCase& a, const TouchCase& b) {
  return a.rate_hz == b.rate_hz && a.service->gate_gain == b.service->gate_gain &&
         a.service->damping_n_s_per_m == b.service->damping_n_s_per_m;
}

void print_table(const std::vector<TouchCase>& loops, const std::vector<TouchRun>& runs) {
  std::puts(
      "| Hz | delay ms | service's damping N s/m | gate | hand's damping N s/m | N/m | ungoverned mJ | reached mJ | "
      "swing "
      "held, steps | gate closed % | altered ticks % |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | "
      "--- |");
  for (const TouchCase& loop : loops)
    for (const bool ordinary : {true, false}) {
      double free_j = 0.0, reached_j = 0.0, steps = 0.0, gated = 0.0, altered = 0.0, stiffest_n_per_m = 0.0;
      for (const TouchRun& run : runs) {
        if (!same_loop(run.c, loop) || (run.c.damping_n_s_per_m >= 2.0) != ordinary) continue;
        free_j = std::max(free_j, run.free.reached_j);
        reached_j = std::max(reached_j, run.governed.reached_j);
        if (!run.c.stroke) steps = std::max(steps, run.governed.swing_m / run.c.encoder_step_m);
        gated = std::max(gated, run.governed.gated);
        altered = std::max(altered, run.governed.altered);
        stiffest_n_per_m = std::max(stiffest_n_per_m, run.governed.stiffness_n_per_m);
      }
      std::printf("| %.0f | %.2f | %.0f | %s | %s | %.0f | %.0f | %.2f | %.2f | %.1f | %.1f |\n", loop.rate_hz,
                  1e3 * loop.delay_s, loop.service->damping_n_s_per_m, loop.service->gate_gain < 1.0 ? "on" : "off",
                  ordinary ? "2 to 10" : "0.3 to 1", stiffest_n_per_m, 1e3 * free_j, 1e3 * reached_j, steps,
                  100.0 * gated, 100.0 * altered);
    }
}

bool write_csv(const std::filesystem::path& file, const std::vector<TouchRun>& runs) {
  std::ofstream csv(file);
  csv << "ground,motion,mass_kg,damping_n_s_per_m,rate_hz,delay_s,service_damping_n_s_per_m,gate_gain,ungoverned_j,"
         "reached_j,delivered_j,swing_m,gated,altered,stiffness_n_per_m\n";
  for (const TouchRun& run : runs) {
    const TouchCase& c = run.c;
    const TouchResult& r = run.governed;
    csv << test::name_of(c.ground) << ',' << (c.stroke ? "stroke" : "hold") << ',' << c.mass_kg << ','
        << c.damping_n_s_per_m << ',' << c.rate_hz << ',' << c.delay_s << ',' << c.service->damping_n_s_per_m << ','
        << c.service->gate_gain << ',' << run.free.reached_j << ',' << r.reached_j << ',' << r.delivered_j << ','
        << r.swing_m << ',' << r.gated << ',' << r.altered << ',' << r.stiffness_n_per_m << '\n';
  }
  return static_cast<bool>(csv.flush());
}

}  // namespace

bool write_service_stability(const std::filesystem::path& folder, bool quick) {
  const std::vector<TouchCase> all = loops();
  const std::vector<TouchRun> runs = run_all(all, quick);
  print_table(all, runs);
  return write_csv(folder / "haptics_service_stability.csv", runs);
}

}  // namespace sparsha::bench
