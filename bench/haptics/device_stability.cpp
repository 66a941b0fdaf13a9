// Devices' own limits, rates and delays. Falcon: what its driver measures of the bus, with and without a delay behind
// it that nobody measures. Inverse3: its service's damping, and its force gate on and off.
#include "bench/haptics/device_stability.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <vector>

#include "bench/haptics/touch_runs.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/haply/haply.h"
#include "haptics/device/haply/messages.h"

namespace sparsha::bench {
namespace {

using test::Ground;
using test::TouchCase;
using test::TouchResult;

constexpr double kGate = 0.3;     // the gain of the documented inventory
constexpr double kUsb_s = 0.001;  // from service to motors: taken, no page tells it

/// A Falcon's bus: as USB allows at most; rate of answers and median delay as `sparsha device check` prints them on the
/// emulated bus; the 99th percentile of a busy machine, as if each answer took so long.
struct Bus {
  double rate_hz, told_s;
};
constexpr std::array kBuses{Bus{1000.0, 0.001}, Bus{950.0, 0.001}, Bus{930.0, 0.0035}};
constexpr double kFirmware_s = 0.001;    // its own cycle and the motors, which no answer tells
constexpr double kFalconStep_m = 50e-6;  // a count, sideways near the middle

std::vector<TouchCase> falcon_loops() {
  std::vector<TouchCase> result;
  for (const Bus& bus : kBuses)
    for (const double more_s : {0.0, kFirmware_s}) {
      TouchCase c;
      c.device = haptics::falcon::falcon_info({});
      c.rate_hz = bus.rate_hz;
      c.declared_ticks = c.device->limits.delay_ticks;
      c.told_delay_s = bus.told_s;
      c.delay_s = bus.told_s + more_s;
      c.encoder_step_m = kFalconStep_m;
      result.push_back(c);
    }
  return result;
}

/// Loops by rate, damping of the service and gate.
std::vector<TouchCase> inverse3_loops() {
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
    for (const double mass : kHandMasses_kg)
      for (const double damping : kHandDampings_n_s_per_m)
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

/// The worst of many runs.
struct Worst {
  double free_j = 0.0, reached_j = 0.0, steps = 0.0, gated = 0.0, altered = 0.0, stiffest_n_per_m = 0.0;
};

bool same_loop(const TouchCase& a, const TouchCase& b) {
  return a.rate_hz == b.rate_hz && a.delay_s == b.delay_s && a.told_delay_s == b.told_delay_s &&
         (!a.service || (a.service->gate_gain == b.service->gate_gain &&
                         a.service->damping_n_s_per_m == b.service->damping_n_s_per_m));
}

/// Of hands of 2 N s/m and more, or of weaker ones.
Worst worst_of(const TouchCase& loop, const std::vector<TouchRun>& runs, bool ordinary) {
  Worst worst;
  for (const TouchRun& run : runs) {
    if (!same_loop(run.c, loop) || (run.c.damping_n_s_per_m >= 2.0) != ordinary) continue;
    worst.free_j = std::max(worst.free_j, run.free.reached_j);
    worst.reached_j = std::max(worst.reached_j, run.governed.reached_j);
    if (!run.c.stroke) worst.steps = std::max(worst.steps, run.governed.swing_m / run.c.encoder_step_m);
    worst.gated = std::max(worst.gated, run.governed.gated);
    worst.altered = std::max(worst.altered, run.governed.altered);
    worst.stiffest_n_per_m = std::max(worst.stiffest_n_per_m, run.governed.stiffness_n_per_m);
  }
  return worst;
}

const char* name_of_dampings(bool ordinary) { return ordinary ? "2 to 10" : "0.3 to 1"; }

void print_falcon(const std::vector<TouchCase>& loops, const std::vector<TouchRun>& runs) {
  std::puts(
      "| Falcon, Hz | delay ms | of that told | hand's damping N s/m | N/m | ungoverned mJ | reached mJ | swing held, "
      "steps | altered ticks % |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
  for (const TouchCase& loop : loops)
    for (const bool ordinary : {true, false}) {
      const Worst worst = worst_of(loop, runs, ordinary);
      std::printf("| %.0f | %.2f | %.2f | %s | %.0f | %.0f | %.2f | %.2f | %.1f |\n", loop.rate_hz, 1e3 * loop.delay_s,
                  1e3 * loop.told_delay_s, name_of_dampings(ordinary), worst.stiffest_n_per_m, 1e3 * worst.free_j,
                  1e3 * worst.reached_j, worst.steps, 100.0 * worst.altered);
    }
}

void print_inverse3(const std::vector<TouchCase>& loops, const std::vector<TouchRun>& runs) {
  std::puts(
      "| Inverse3, Hz | delay ms | service's damping N s/m | gate | hand's damping N s/m | N/m | ungoverned mJ | "
      "reached mJ | swing held, steps | gate closed % | altered ticks % |\n| --- | --- | --- | --- | --- | --- | --- | "
      "--- | --- | --- | --- |");
  for (const TouchCase& loop : loops)
    for (const bool ordinary : {true, false}) {
      const Worst worst = worst_of(loop, runs, ordinary);
      std::printf("| %.0f | %.2f | %.0f | %s | %s | %.0f | %.0f | %.2f | %.2f | %.1f | %.1f |\n", loop.rate_hz,
                  1e3 * loop.delay_s, loop.service->damping_n_s_per_m, loop.service->gate_gain < 1.0 ? "on" : "off",
                  name_of_dampings(ordinary), worst.stiffest_n_per_m, 1e3 * worst.free_j, 1e3 * worst.reached_j,
                  worst.steps, 100.0 * worst.gated, 100.0 * worst.altered);
    }
}

void write_rows(std::ofstream& csv, const std::vector<TouchRun>& runs) {
  for (const TouchRun& run : runs) {
    const TouchCase& c = run.c;
    const TouchResult& r = run.governed;
    const test::ServiceFilters service = c.service.value_or(test::ServiceFilters{});
    csv << c.device->name << ',' << test::name_of(c.ground) << ',' << (c.stroke ? "stroke" : "hold") << ',' << c.mass_kg
        << ',' << c.damping_n_s_per_m << ',' << c.rate_hz << ',' << c.delay_s << ',' << c.told_delay_s << ','
        << service.damping_n_s_per_m << ',' << service.gate_gain << ',' << run.free.reached_j << ',' << r.reached_j
        << ',' << r.delivered_j << ',' << r.swing_m << ',' << r.gated << ',' << r.altered << ',' << r.stiffness_n_per_m
        << '\n';
  }
}

}  // namespace

bool write_device_stability(const std::filesystem::path& folder, bool quick) {
  std::ofstream csv(folder / "haptics_device_stability.csv");
  csv << "device,ground,motion,mass_kg,damping_n_s_per_m,rate_hz,delay_s,told_delay_s,service_damping_n_s_per_m,"
         "gate_gain,ungoverned_j,reached_j,delivered_j,swing_m,gated,altered,stiffness_n_per_m\n";
  const auto write = [&](const std::vector<TouchCase>& loops, const auto& print) {
    const std::vector<TouchRun> runs = run_all(loops, quick);
    print(loops, runs);
    write_rows(csv, runs);
  };
  write(falcon_loops(), print_falcon);
  write(inverse3_loops(), print_inverse3);
  return static_cast<bool>(csv.flush());
}

}  // namespace sparsha::bench
