// bench_race: our solvers and other people's methods over the same surfaces, paths and truth. Writes race.csv,
// race_hard.csv, race_lived.csv, race_front.svg and race.part.html; never a time without its error.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "bench/haptics/plot.h"
#include "bench/race/report.h"
#include "bench/race/spline_ground.h"

namespace sparsha::bench {
namespace {

/// One scenario varied in one thing at a time; full mode crosses surfaces with sizes.
std::vector<Scenario> scenarios(bool quick) {
  const std::vector<protocol::Ground> grounds = protocol::all_grounds();
  std::vector<Scenario> all;
  const auto add = [&all](const std::string& group, const protocol::Ground& ground, int nodes, double speed,
                          double depth) {
    if (depth <= ground.most_depth_m) all.push_back({group, ground, nodes, speed, depth});
  };
  const protocol::Ground& sinusoid = grounds.front();
  const std::vector<int> sizes = quick ? std::vector<int>{100, 316, 1000} : std::vector<int>{100, 316, 1000, 3162};
  add("front", sinusoid, 200, 0.25, 0.002);
  for (const protocol::Ground& ground : grounds) {
    add("surfaces", ground, 316, 0.25, 0.002);
    if (quick) continue;
    for (const int nodes : {100, 1000}) add("surfaces", ground, nodes, 0.25, 0.002);
    for (const double speed : {0.05, 1.0}) add("speed", ground, 316, speed, 0.002);
    for (const double depth : {0.0005, 0.005, 0.02}) add("depth", ground, 316, 0.25, depth);
  }
  for (const protocol::Ground& ground : object_grounds(0.002)) add("surfaces", ground, 316, 0.25, 0.002);
  for (const double speed : {0.01, 0.1, 0.5, 2.0}) add("speed", sinusoid, 316, speed, 0.002);
  for (const double depth : {0.0001, 0.001, 0.01, 0.02})
    if (quick || depth < 0.02) add("depth", sinusoid, 316, 0.25, depth);
  for (const int nodes : sizes) add("size", sinusoid, nodes, 0.25, 0.002);
  // Those of the same nodes follow each other, so that entrants are made once.
  std::stable_sort(all.begin(), all.end(), [](const Scenario& a, const Scenario& b) {
    return a.ground.name != b.ground.name ? a.ground.name > b.ground.name : a.nodes < b.nodes;
  });
  return all;
}

void write_row(std::ofstream& csv, const Row& r) {
  csv << r.method << ',' << r.setting << ',' << r.group << ',' << r.ground << ',' << r.nodes * r.nodes << ','
      << r.speed_m_per_s << ',' << r.depth_m << ',' << r.cells_per_tick << ',' << r.p50_ns << ',' << r.p99_ns << ','
      << r.max_ns << ',' << r.ratio << ',' << r.ratio_low << ',' << r.ratio_high << ',' << r.error_median << ','
      << r.error_p99 << ',' << r.size_median << ',' << r.size_p99 << ',' << r.angle_median_deg << ',' << r.angle_p99_deg
      << ',' << r.lost << ',' << r.jumps << ',' << r.seconds << ',' << r.bytes << '\n';
}

void print_row(const Row& r) {
  std::printf(
      "%-10s %-20s %-8s %8d %5.2f m/s %6.2f mm | %9.0f %9.0f %9.0f ns x%-7.3g | %9.3g %9.3g lost %5.3f jump %5.3f\n",
      r.method.c_str(), r.setting.c_str(), r.ground.c_str(), r.nodes * r.nodes, r.speed_m_per_s, 1e3 * r.depth_m,
      r.p50_ns, r.p99_ns, r.max_ns, r.ratio, r.error_median, r.error_p99, r.lost, r.jumps);
  std::fflush(stdout);
}

bool run(bool quick, const std::filesystem::path& out) {
  std::filesystem::create_directories(out);
  const std::vector<Entrant> entrants = all_entrants();
  std::vector<Entrant> standard;
  for (const Entrant& entrant : entrants)
    if (entrant.standard) standard.push_back(entrant);
  Report report;
  report.repeats = 5;
  std::ofstream csv(out / "race.csv");
  csv << "method,setting,group,surface,points,speed_m_per_s,depth_m,cells_per_tick,p50_ns,p99_ns,max_ns,ratio_to_exact,"
         "ratio_low,ratio_high,force_error_median,force_error_p99,size_error_median,size_error_p99,angle_median_deg,"
         "angle_p99_deg,lost,jumps,preprocessing_s,bytes\n";
  std::vector<PlotPoint> points;
  Field field;
  std::string made;
  for (const Scenario& scenario : scenarios(quick)) {
    const bool front = scenario.group == "front";
    const std::string wanted = scenario.ground.name + ' ' + std::to_string(scenario.nodes);
    if (made != wanted) {
      field = {};  // before the next one needs its memory
      field = make_field(scenario.ground, scenario.nodes, front ? entrants : standard);
      made = wanted;
    }
    for (const Row& row : race(scenario, field, quick ? 1000 : 1500, report.repeats)) {
      write_row(csv, row);
      print_row(row);
      report.rows.push_back(row);
      if (front) points.push_back({row.method, std::max(row.p50_ns, 1.0), std::max(row.error_median, 1e-7)});
    }
  }
  report.hard = hard_cases(entrants);
  std::ofstream hard(out / "race_hard.csv");
  hard << "method,case,verdict,lost,not_finite,energy_gained,worst_step\n";
  for (const HardResult& r : report.hard) {
    hard << r.method << ',' << r.hard_case << ",\"" << r.verdict << "\"," << r.lost << ',' << r.not_finite << ','
         << r.gained << ',' << r.worst_step << '\n';
    std::printf("%-14s %-10s %-14s lost %5.3f NaN %d energy %+9.2e step %8.2e\n", r.hard_case.c_str(), r.method.c_str(),
                r.verdict.c_str(), r.lost, r.not_finite, r.gained, r.worst_step);
  }
  PlotMarks marks;
  marks.title = "Median time of a proxy update against the median error of its force, every method at every setting";
  marks.y_label = "median relative force error";
  marks.front = true;
  marks.budget_ns = 1e6;
  marks.felt_from = 0.07;
  marks.felt_to = 0.10;
  const Scenario lived{"lived", protocol::all_grounds().front(), 200, 0.25, 0.002};
  report.lived = live(lived, make_field(lived.ground, lived.nodes, standard), quick ? 300 : 1000);
  std::ofstream lived_csv(out / "race_lived.csv");
  lived_csv << "method,hot_p50_ns,hot_p99_ns,lived_p50_ns,lived_p99_ns,lived_max_ns,force_error_median\n";
  for (const LivedRow& r : report.lived)
    lived_csv << r.method << ',' << r.hot_p50_ns << ',' << r.hot_p99_ns << ',' << r.p50_ns << ',' << r.p99_ns << ','
              << r.max_ns << ',' << r.error_median << '\n';
  return csv.flush() && hard.flush() && lived_csv.flush() && write_plot(out / "race_front.svg", points, marks) &&
         write_report(out, report);
}

}  // namespace
}  // namespace sparsha::bench

int main(int argc, char** argv) {
  bool quick = true;
  std::filesystem::path out = ".";
  for (int k = 1; k < argc; k += 2) {
    const bool value = k + 1 < argc;
    if (value && std::strcmp(argv[k], "--mode") == 0) {
      quick = std::string(argv[k + 1]) != "full";
    } else if (value && std::strcmp(argv[k], "--out") == 0) {
      out = argv[k + 1];
    } else {
      std::fputs("usage: bench_race [--mode quick|full] [--out DIR]\n", stderr);
      return 2;
    }
  }
  try {
    return sparsha::bench::run(quick, out) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
