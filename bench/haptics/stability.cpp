// Energy delivered, swing and share of altered ticks by mass, damping, delay, rate and stiffness. The hand is that of
// the tests and shares no code with the governor.
#include "bench/haptics/stability.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "bench/haptics/lines.h"
#include "bench/haptics/touch_runs.h"

namespace sparsha::bench {
namespace {

using test::Ground;
using test::TouchCase;
using test::TouchResult;

constexpr double kOrdinary = 2.0;  // N s/m, of hand and device together, and more: the hand of the stiffness limit

/// A loop and a motion; hands of all masses and dampings go through it.
using Loops = std::vector<TouchCase>;

Loops loops() {
  Loops result;
  TouchCase c;
  result.push_back(c);
  c.delay_s = 0.003;
  result.push_back(c);
  c.declared_ticks = 3;
  result.push_back(c);
  c.declared_ticks = 1;
  c.rate_hz = 333.0;
  result.push_back(c);
  c.rate_hz = 851.0;
  c.configured_hz = 5000.0;
  result.push_back(c);
  c.rate_hz = c.configured_hz = 4000.0;
  c.wish_n_per_m = 8000.0;
  result.push_back(c);
  c = TouchCase{};
  c.jitter_s = 0.003;
  c.lost = 0.1;
  result.push_back(c);
  c.jitter_s = 0.0;
  c.told_lost = true;
  result.push_back(c);
  c = TouchCase{};
  c.strike_m_per_s = 0.3;
  c.duration_s = 4.0;
  result.push_back(c);
  return result;
}

/// One mass and damping in one loop: held and stroked on each ground, or struck on the plane.
std::vector<TouchCase> motions(TouchCase c, bool quick) {
  std::vector<TouchCase> result;
  if (c.strike_m_per_s > 0.0) return {c};
  for (const bool stroke : {false, true})
    for (const Ground ground : test::kGrounds) {
      if (quick && ground != Ground::plane && ground != Ground::relief) continue;
      c.stroke = stroke;
      c.ground = ground;
      result.push_back(c);
    }
  return result;
}

std::vector<TouchRun> run_all(const Loops& loops, bool quick) {
  std::vector<TouchRun> runs;
  for (const TouchCase& loop : loops)
    for (const double mass : kHandMasses_kg)
      for (const double damping : kHandDampings_n_s_per_m) {
        TouchCase c = loop;
        c.mass_kg = mass;
        c.damping_n_s_per_m = damping;
        for (const TouchCase& motion : motions(c, quick)) runs.push_back({motion, {}, {}});
      }
  run_both_ways(runs);
  return runs;
}

bool same_loop(const TouchCase& a, const TouchCase& b) {
  return a.rate_hz == b.rate_hz && a.configured_hz == b.configured_hz && a.jitter_s == b.jitter_s && a.lost == b.lost &&
         a.told_lost == b.told_lost && a.delay_s == b.delay_s && a.declared_ticks == b.declared_ticks &&
         a.wish_n_per_m == b.wish_n_per_m && a.strike_m_per_s == b.strike_m_per_s;
}

/// The worst of many runs.
struct Worst {
  double free_j = 0.0, delivered_j = 0.0, steps = 0.0, altered = 0.0, calm_s = -1.0;
  void take(const TouchRun& run) {
    free_j = std::max(free_j, run.free.delivered_j);
    delivered_j = std::max(delivered_j, run.governed.delivered_j);
    // A stroked relief lifts the hand, and after a gap of over 10 ms there is no force that could calm it.
    if (!run.c.stroke && !run.governed.fault) steps = std::max(steps, run.governed.swing_m / run.c.encoder_step_m);
    altered = std::max(altered, run.governed.altered);
    calm_s = std::max(calm_s, run.governed.calm_s);
  }
};

const char* lost_in_words(const TouchCase& c) { return c.lost == 0.0 ? "none" : c.told_lost ? "told" : "silent"; }

void print_row(const TouchCase& c, const char* dampings, const Worst& worst) {
  const bool strike = c.strike_m_per_s > 0.0;
  char swing[16] = "";
  char calm[16] = "";
  if (!strike) std::snprintf(swing, sizeof swing, "%.2f", worst.steps);
  if (strike) std::snprintf(calm, sizeof calm, "%.2f", worst.calm_s);
  std::printf("| %s | %.2f | %s | %.0f, %s | %.0f of %.0f | %.0f | %s | %.0f | %.0f | %.2f | %s | %.2f | %s |\n",
              strike ? "strike" : "hold, stroke", c.mass_kg, dampings, 1e3 * c.delay_s,
              c.delay_s * c.configured_hz > c.declared_ticks + 0.5 ? "no" : "yes", c.rate_hz, c.configured_hz,
              1e3 * c.jitter_s, lost_in_words(c), c.wish_n_per_m, 1e3 * worst.free_j, 1e3 * worst.delivered_j, swing,
              100.0 * worst.altered, calm);
}

/// The worst hands of each loop and mass, those of ordinary damping and weaker ones apart.
void print_table(const Loops& loops, const std::vector<TouchRun>& runs) {
  std::puts(
      "| motion | mass kg | damping N s/m | delay ms, declared | Hz, of planned | jitter ms | 10 % lost | wish N/m | "
      "ungoverned mJ | delivered mJ | swing held, steps | altered ticks % | calm after s |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
  for (const TouchCase& loop : loops)
    for (const bool ordinary : {true, false})
      for (const double mass : kHandMasses_kg) {
        Worst worst;
        for (const TouchRun& run : runs)
          if (same_loop(run.c, loop) && run.c.mass_kg == mass && (run.c.damping_n_s_per_m >= kOrdinary) == ordinary)
            worst.take(run);
        TouchCase c = loop;
        c.mass_kg = mass;
        print_row(c, ordinary ? "2 to 10" : "0.3 to 1", worst);
      }
}

bool write_csv(const std::filesystem::path& file, const std::vector<TouchRun>& runs) {
  std::ofstream csv(file);
  csv << "ground,motion,mass_kg,damping_n_s_per_m,delay_s,declared_ticks,rate_hz,planned_hz,jitter_s,lost,lost_told,"
         "wish_n_per_m,strike_m_per_s,ungoverned_j,delivered_j,swing_m,altered,static_share,stiffness_n_per_m,calm_s,"
         "ended_by_gap\n";
  for (const TouchRun& run : runs) {
    const TouchCase& c = run.c;
    const TouchResult& r = run.governed;
    csv << test::name_of(c.ground) << ','
        << (c.strike_m_per_s > 0.0 ? "strike"
            : c.stroke             ? "stroke"
                                   : "hold")
        << ',' << c.mass_kg << ',' << c.damping_n_s_per_m << ',' << c.delay_s << ',' << c.declared_ticks << ','
        << c.rate_hz << ',' << c.configured_hz << ',' << c.jitter_s << ',' << c.lost << ',' << c.told_lost << ','
        << c.wish_n_per_m << ',' << c.strike_m_per_s << ',' << run.free.delivered_j << ',' << r.delivered_j << ','
        << r.swing_m << ',' << r.altered << ',' << r.static_share << ',' << r.stiffness_n_per_m << ',' << r.calm_s
        << ',' << r.fault << '\n';
  }
  return static_cast<bool>(csv.flush());
}

/// Worst over masses and motions, by damping: energy above, swing below.
bool draw(const std::filesystem::path& file, const std::vector<TouchRun>& runs) {
  struct Line {
    const char* name;
    const char* colour;
    TouchCase loop;
  };
  std::vector<Line> lines{{"1 kHz, 1 ms", "#1b6ca8", {}},
                          {"3 ms undeclared", "#c0392b", {}},
                          {"333 Hz of 1000", "#2e7d32", {}},
                          {"jitter, 10 % lost", "#7b4fa3", {}}};
  lines[1].loop.delay_s = lines[2].loop.delay_s = 0.003;
  lines[2].loop.rate_hz = 333.0;
  lines[3].loop.jitter_s = 0.003;
  lines[3].loop.lost = 0.1;
  Panel energy{"delivered in 10 s, mJ", 0.0, kHandDampings_n_s_per_m.back(), {}};
  Panel swing{"swing held, encoder steps", 0.0, kHandDampings_n_s_per_m.back(), {}};
  for (const Line& line : lines) {
    Curve joules{line.name, line.colour, "", {}, {}};
    Curve steps = joules;
    for (const double damping : kHandDampings_n_s_per_m) {
      Worst worst;
      for (const TouchRun& run : runs)
        if (same_loop(run.c, line.loop) && run.c.damping_n_s_per_m == damping) worst.take(run);
      joules.x.push_back(damping);
      joules.y.push_back(1e3 * worst.delivered_j);
      steps.x.push_back(damping);
      steps.y.push_back(worst.steps);
    }
    energy.curves.push_back(joules);
    swing.curves.push_back(steps);
  }
  return write_lines(file, "What the worst hand gets, 800 N/m wished", "damping of the hand, N s/m", {energy, swing});
}

}  // namespace

bool write_stability(const std::filesystem::path& folder, bool quick) {
  const Loops all = loops();
  const std::vector<TouchRun> runs = run_all(all, quick);
  print_table(all, runs);
  const bool written = write_csv(folder / "haptics_stability.csv", runs);
  return draw(folder / "haptics_stability.svg", runs) && written;
}

}  // namespace sparsha::bench
