// bench_haptics: time of a proxy update beside its error, for the exact solver, the C1 surface and the source paper's
// solver. Writes haptics_speed.csv and haptics_speed.svg; never a time alone. Also the figures of the source paper
// (figures.h).
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/numbers/statistics.h"
#include "bench/haptics/device_stability.h"
#include "bench/haptics/drag.h"
#include "bench/haptics/edges.h"
#include "bench/haptics/figures.h"
#include "bench/haptics/loops.h"
#include "bench/haptics/objects.h"
#include "bench/haptics/plot.h"
#include "bench/haptics/scanned.h"
#include "bench/haptics/scenes.h"
#include "bench/haptics/softened.h"
#include "bench/haptics/stability.h"
#include "haptics/proxy/proxy.h"
#include "haptics/proxy/rest_residual.h"

namespace sparsha::bench {
namespace {

using haptics::ProxyState;
using haptics::ProxyUpdate;
using haptics::SolverOptions;
using Clock = std::chrono::steady_clock;

struct Method {
  std::string name;  ///< exact | rounded | c1 | paper
  SolverOptions options;
};

struct Figures {
  double batch_ns = 0.0;  ///< mean, processor time of whole runs, best of several
  double ticks_ns = 0.0;  ///< mean of single ticks, best of several, timer overhead off
  double p50_ns = 0.0;
  double p99_ns = 0.0;
  double overhead_ns = 0.0;
  double segments = 0.0;
  double error_mean = 0.0;  ///< of the force, relative to the true force; with friction: cone residual, cells
  double error_p99 = 0.0;
  double error_max = 0.0;
  std::size_t unfinished = 0;
};

ProxyUpdate update(const HapticScene& scene, const Method& method, std::size_t tick, ProxyState& state) {
  return method.name == "paper" ? update_paper(scene.surface, scene.hands[tick], state, method.options)
                                : update_exact(scene.surface, scene.hands[tick], state, method.options);
}

double processor_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e9 * static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec);
}

double between_ns(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double, std::nano>(end - begin).count();
}

double share(std::vector<double>& values, double fraction) { return values.empty() ? 0.0 : quantile(values, fraction); }

void measure_time(const HapticScene& scene, const Method& method, Figures& figures) {
  constexpr int kRuns = 5;
  figures.batch_ns = 1e18;
  double sink = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    ProxyState state = start_proxy(scene.surface, scene.hands[0]);
    const double begin = processor_ns();
    for (std::size_t tick = 0; tick < scene.hands.size(); ++tick) sink += update(scene, method, tick, state).normal.z();
    figures.batch_ns = std::min(figures.batch_ns, (processor_ns() - begin) / static_cast<double>(scene.hands.size()));
  }
  std::vector<double> pauses(2001);
  for (double& pause : pauses) {
    const Clock::time_point begin = Clock::now();
    pause = between_ns(begin, Clock::now());
  }
  figures.overhead_ns = share(pauses, 0.5);
  // The same path gives the same work at every tick: the best of several runs is the tick without its disturbances.
  std::vector<double> times(scene.hands.size(), 1e18);
  for (int run = 0; run < kRuns; ++run) {
    ProxyState state = start_proxy(scene.surface, scene.hands[0]);
    for (std::size_t tick = 0; tick < scene.hands.size(); ++tick) {
      const Clock::time_point begin = Clock::now();
      sink += update(scene, method, tick, state).normal.z();
      times[tick] = std::min(times[tick], between_ns(begin, Clock::now()) - figures.overhead_ns);
    }
  }
  for (const double time : times) figures.ticks_ns += time / static_cast<double>(times.size());
  figures.p50_ns = share(times, 0.5);
  figures.p99_ns = share(times, 0.99);
  if (!std::isfinite(sink)) std::puts("not a number");
}

void measure_error(const HapticScene& scene, const Method& method, Figures& figures) {
  ProxyState state = start_proxy(scene.surface, scene.hands[0]);
  std::vector<double> errors;
  for (std::size_t tick = 0; tick < scene.hands.size(); ++tick) {
    const ProxyUpdate found = update(scene, method, tick, state);
    figures.segments += static_cast<double>(found.segments) / static_cast<double>(scene.hands.size());
    if (found.unfinished) ++figures.unfinished;
    if (!found.contact) continue;
    if (scene.truth.empty())
      errors.push_back(rest_residual(scene.surface, found, scene.hands[tick], method.options.shape).excess_cells);
    else
      errors.push_back((found.position - scene.truth[tick]).norm() / (scene.truth[tick] - scene.hands[tick]).norm());
    figures.error_mean += errors.back();
  }
  if (!errors.empty()) figures.error_mean /= static_cast<double>(errors.size());
  figures.error_p99 = share(errors, 0.99);
  figures.error_max = share(errors, 1.0);
}

class Table {
 public:
  explicit Table(const std::filesystem::path& file) : csv_(file) {
    csv_ << "method,surface,nodes,friction,cells_per_tick,tolerance_cells,rho,iterations,ns_mean,ns_tick_mean,ns_p50,"
            "ns_p99,"
            "timer_overhead_ns,segments_per_tick,error,error_mean,error_p99,error_max,unfinished\n";
    std::printf("%-6s %-8s %5s %3s %6s %7s %4s %5s | %8s %8s %8s %6s | %9s %9s %9s\n", "method", "surface", "nodes",
                "mu", "c/tick", "tol", "rho", "iter", "ns mean", "p50", "p99", "seg", "err mean", "p99", "max");
  }
  void add(const HapticScene& scene, const Method& method) {
    Figures f;
    measure_time(scene, method, f);
    measure_error(scene, method, f);
    const bool friction = !scene.surface.mu_dynamic.empty();
    const bool paper = method.name == "paper";
    char line[400];
    std::snprintf(line, sizeof line,
                  "%s,%s,%d,%d,%.4g,%.3g,%.3g,%d,%.1f,%.1f,%.1f,%.1f,%.1f,%.3f,%s,%.4g,%.4g,%.4g,%zu\n",
                  method.name.c_str(), scene.name.c_str(), scene.surface.lattice.nx, friction ? 1 : 0,
                  scene.cells_per_tick, method.options.tolerance_cells, paper ? method.options.paper_rho : 0.0,
                  paper ? method.options.paper_iterations : 0, f.batch_ns, f.ticks_ns, f.p50_ns, f.p99_ns,
                  f.overhead_ns, f.segments, scene.truth.empty() ? "residual_cells" : "force_relative", f.error_mean,
                  f.error_p99, f.error_max, f.unfinished);
    csv_ << line;
    std::printf("%-6s %-8s %5d %3s %6.3f %7.0e %4.1f %5d | %8.1f %8.1f %8.1f %6.2f | %9.2e %9.2e %9.2e\n",
                method.name.c_str(), scene.name.c_str(), scene.surface.lattice.nx, friction ? "yes" : "no",
                scene.cells_per_tick, method.options.tolerance_cells, paper ? method.options.paper_rho : 0.0,
                paper ? method.options.paper_iterations : 0, f.batch_ns, f.p50_ns, f.p99_ns, f.segments, f.error_mean,
                f.error_p99, f.error_max);
    std::fflush(stdout);
    if (!scene.truth.empty() && scene.surface.lattice.nx == 200)
      points_.push_back({method.name, f.batch_ns, std::max(f.error_mean, 1e-12)});
  }
  [[nodiscard]] const std::vector<PlotPoint>& points() const { return points_; }
  [[nodiscard]] bool good() { return static_cast<bool>(csv_.flush()); }

 private:
  std::ofstream csv_;
  std::vector<PlotPoint> points_;
};

Method exact(double tolerance = 1e-9) {
  Method method{"exact", {}};
  method.options.tolerance_cells = tolerance;
  return method;
}
Method smooth(haptics::CellShape shape, double tolerance = 1e-9) {
  Method method{shape == haptics::CellShape::c1 ? "c1" : "rounded", {}};
  method.options.tolerance_cells = tolerance;
  method.options.shape = shape;
  return method;
}
Method paper(double rho, int iterations) {
  Method method{"paper", {}};
  method.options.paper_rho = rho;
  method.options.paper_iterations = iterations;
  return method;
}

// Time beside error; writes haptics_speed.csv and .svg.
bool write_speed(bool quick, const std::filesystem::path& out) {
  const int ticks = quick ? 10000 : 50000;
  Table table(out / "haptics_speed.csv");
  // Speed against error, frictionless, where the truth is known.
  for (const int nodes : {200, 800}) {
    const HapticScene scene = sinusoid_scene(nodes, 0.25, ticks, false);
    for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9}) table.add(scene, exact(tolerance));
    for (const auto shape : {haptics::CellShape::rounded, haptics::CellShape::c1})
      for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9}) table.add(scene, smooth(shape, tolerance));
    for (const double rho : {0.1, 0.3, 0.5, 0.7, 0.9})
      for (const int iterations : {1, 3, 10, 30, 100})
        if (!quick || (nodes == 200 && rho == 0.5)) table.add(scene, paper(rho, iterations));
  }
  // With friction: how time grows with the cells crossed, and with the surface.
  for (const double cells : {0.05, 0.25, 1.0, 4.0, 16.0}) table.add(sinusoid_scene(200, cells, ticks, true), exact());
  for (const auto shape : {haptics::CellShape::rounded, haptics::CellShape::c1})
    for (const double cells : {0.25, 1.0, 4.0}) table.add(sinusoid_scene(200, cells, ticks, true), smooth(shape));
  table.add(sinusoid_scene(800, 0.25, ticks, true), exact());
  if (!quick)
    for (const double cells : {0.25, 1.0})
      for (const bool friction : {false, true}) table.add(sinusoid_scene(8192, cells, ticks, friction), exact());
  for (const double cells : {0.25, 1.0}) {
    table.add(stone_scene(1025, cells, ticks, true, 1), exact());
    table.add(stone_scene(1025, cells, ticks, true, 1), smooth(haptics::CellShape::rounded));
  }
  return table.good() && write_plot(out / "haptics_speed.svg", table.points());
}

constexpr std::array<const char*, 9> kParts{"speed",     "objects", "figures", "scanned", "drag",
                                            "stability", "edges",   "loops",   "softened"};

bool run(bool quick, const std::string& only, const std::filesystem::path& out,
         const std::vector<std::filesystem::path>& scenes) {
  std::filesystem::create_directories(out);
  const auto asked = [&](const char* part) { return only.empty() || only == part; };
  // The quick mode leaves out what takes longest; --only has it.
  const auto slow = [&](const char* part) { return only == part || (only.empty() && !quick); };
  return (!asked("speed") || write_speed(quick, out)) && (!asked("objects") || write_objects(out, quick)) &&
         (!asked("figures") || write_figures(out)) && (!asked("scanned") || write_scanned(out, quick)) &&
         (!slow("drag") || write_drag(out)) &&
         (!slow("stability") || (write_stability(out, quick) && write_device_stability(out, quick))) &&
         (!slow("edges") || write_edges(scenes, quick ? 10 : 40)) &&
         (!slow("loops") || write_loops(scenes, quick ? 600 : 5000)) && (!slow("softened") || write_softened());
}

int usage() {
  std::fputs(
      "usage: bench_haptics [--mode quick|full] [--only "
      "speed|objects|figures|scanned|drag|stability|edges|loops|softened]\n"
      "                     [--out DIR] [--scene FOLDER]...   of edges and loops\n",
      stderr);
  return 2;
}

}  // namespace
}  // namespace sparsha::bench

int main(int argc, char** argv) {
  using namespace sparsha::bench;
  bool quick = true;
  std::string only;
  std::filesystem::path out = ".";
  std::vector<std::filesystem::path> scenes;
  for (int k = 1; k < argc; k += 2) {
    const std::string word = argv[k], value = k + 1 < argc ? argv[k + 1] : "";
    if (word == "--mode" && (value == "quick" || value == "full")) {
      quick = value == "quick";
    } else if (word == "--only" && std::ranges::find(kParts, value) != kParts.end()) {
      only = value;
    } else if (word == "--out" && !value.empty()) {
      out = value;
    } else if (word == "--scene" && !value.empty()) {
      scenes.emplace_back(value);
    } else {
      return usage();
    }
  }
  try {
    return run(quick, only, out, scenes) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
