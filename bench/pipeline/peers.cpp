// The way from points to heights beside the rasters of every GIS, PCL's moving least squares and CloudCompare, on open
// and on closed objects, against density, noise and the ratio of spacings.
#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "base/numbers/statistics.h"
#include "bench/pipeline/cloudcompare.h"
#include "bench/pipeline/contest.h"
#include "bench/pipeline/judge.h"
#include "bench/pipeline/points.h"
#include "bench/pipeline/run.h"
#include "bench/report/figure_text.h"
#include "pipeline/scan/reader.h"
#include "pipeline/simulate/ply_stream.h"
#include "pipeline/simulate/simulate.h"
#include "scene/config/config.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;

std::vector<std::array<double, 3>> points_in_metres(const pipeline::Cloud& cloud) {
  std::vector<std::array<double, 3>> points;
  for (const auto& p : points_of(cloud))
    points.push_back({static_cast<double>(p[0]) + cloud.origin_m.x(), static_cast<double>(p[1]) + cloud.origin_m.y(),
                      static_cast<double>(p[2]) + cloud.origin_m.z()});
  return points;
}

/// One setting of an open scene, what differs from the others first.
struct OpenCase {
  std::string back, varied;
  double per_node = 3.6, noise_mm = 0.2;
  int nodes = 256;
};

std::vector<OpenCase> open_cases(bool quick) {
  std::vector<OpenCase> cases;
  for (const std::string back : {"sparse", "dense"}) {
    cases.push_back({back, "base"});
    if (quick) continue;
    for (const double n : {1.0, 8.0}) cases.push_back({back, "density", n});
    for (const double mm : {0.05, 1.0}) cases.push_back({back, "noise", 3.6, mm});
    cases.push_back({back, "spacing", 3.6 * 4.0, 0.2, 128});
    cases.push_back({back, "spacing", 3.6 / 4.0, 0.2, 512});
  }
  return cases;
}

void run_open(const RunOptions& options, const OpenCase& c, std::ofstream& csv) {
  pipeline::SimulationConfig simulation;
  simulation.seed = 53;
  simulation.nodes = c.nodes;
  simulation.noise_m = 1e-3 * c.noise_mm;
  simulation.outlier_fraction = 0.005;
  const bool dense = c.back == "dense";
  simulation.surface.back = {pipeline::BackConfig::Kind::rough, dense ? 0.06 : 0.10, 0.003, dense ? 1.0 : 0.1};
  simulation.scan = pipeline::SamplerConfig{c.per_node, 1.0, 1};
  simulation.write_truth = false;
  const fs::path folder = options.work / "open";
  Progress progress;
  pipeline::write_simulation(simulation, folder, progress);
  const pipeline::Truth truth(simulation);
  const scene::Config config = scene::load_config(folder / "sparsha.yaml");
  const pipeline::Cloud cloud = pipeline::load_scans(config.scans, progress);
  const auto points = points_in_metres(cloud);
  const double point_spacing_m = truth.lattice().spacing_m / std::sqrt(c.per_node);
  const std::vector<ContestRow> rows =
      contest(contestants_of(cloud, points, config.grid, config.haptics.resolution_m, truth.lattice(), point_spacing_m),
              3, options.quick || c.varied != "base" ? 1 : 2);
  const auto row = [&](const std::string& method, const std::vector<Sample>& samples, double seconds,
                       const ContestRow* timed) {
    const Figures f = judge(samples, truth);
    csv << fmt::format("{},{},{},{},{},{:.3g},{},{},{},{},{},{},{},{},{},{}\n", method, c.back, c.varied, c.per_node,
                       c.noise_mm, truth.lattice().spacing_m / point_spacing_m, cloud.size(), truth.lattice().count(),
                       field_of("%.5g", seconds), timed != nullptr ? field_of("%.5g", timed->ratio) : "",
                       timed != nullptr && timed->rounds > 1 ? field_of("%.5g", timed->ratio_low) : "",
                       timed != nullptr && timed->rounds > 1 ? field_of("%.5g", timed->ratio_high) : "",
                       field_of("%.5g", f.rms_away_mm), field_of("%.5g", f.p99_away_mm),
                       field_of("%.5g", f.off5_all_percent), field_of("%.5g", f.coverage_percent));
    fmt::print("| {} | {} {} {} {} | {} | {:.1f} | {:.4g} | {:.4g} | {:.4g} | {:.2f} |\n", c.back, c.varied, c.per_node,
               c.noise_mm, c.nodes, method, 1e3 * seconds, f.rms_away_mm, f.p99_away_mm, f.off5_all_percent,
               f.coverage_percent);
    std::fflush(stdout);
  };
  for (const ContestRow& r : rows) row(r.method, samples_of(r.grid, truth), r.seconds, &r);
  if (options.cloudcompare && c.varied == "base")
    for (const bool clean : {false, true})
      if (const auto theirs =
              cloudcompare_raster(folder / "scan.ply", truth.lattice().spacing_m, clean ? "AVG" : "MAX", clean))
        row(clean ? "CloudCompare SOR + RASTERIZE AVG (process)" : "CloudCompare RASTERIZE MAX (process)",
            theirs->samples, theirs->process.seconds, nullptr);
  fs::remove_all(folder);
}

struct ClosedCase {
  std::string varied = "base";
  std::size_t points = 100'000;
  double noise_spacings = 0.1, grid_spacings = 1.0;
};

struct ClosedFigures {
  test::Judgement judgement;
  double rms_spacings = 0.0, p99_spacings = 0.0;
};

ClosedFigures judge_nodes(const std::vector<Eigen::Vector3d>& nodes, const test::Judgement& judgement,
                          const test::ClosedObject& object, double spacing_m) {
  std::vector<double> errors;
  double squares = 0.0;
  for (const Eigen::Vector3d& node : nodes) {
    const auto truth = object.front_m(node.x(), node.y());
    if (!truth) continue;
    errors.push_back(std::abs(node.z() - *truth) / spacing_m);
    squares += errors.back() * errors.back();
  }
  ClosedFigures f{judgement};
  if (errors.empty()) return f;
  f.rms_spacings = std::sqrt(squares / static_cast<double>(errors.size()));
  f.p99_spacings = quantile(errors, 0.99);
  return f;
}

std::vector<Eigen::Vector3d> nodes_of(const scene::DepthGrid& grid) {
  std::vector<Eigen::Vector3d> nodes;
  for (int j = 0; j < grid.lattice.ny; ++j)
    for (int i = 0; i < grid.lattice.nx; ++i) {
      const std::size_t k = grid.lattice.index(i, j);
      if (grid.state[k] == scene::NodeState::measured)
        nodes.emplace_back(grid.lattice.x_m(i), grid.lattice.y_m(j),
                           grid.lattice.origin_m.z() + static_cast<double>(grid.height_m[k]));
    }
  return nodes;
}

void run_closed_case(const RunOptions& options, const test::NamedObject& named, const ClosedCase& c,
                     std::ofstream& csv) {
  const test::ObjectScan scan = test::scan_object(*named.object, {c.points, c.noise_spacings, 5});
  const pipeline::Cloud cloud = test::make_cloud(scan.points);
  const auto points = points_in_metres(cloud);
  scene::GridConfig grid;
  grid.spacing_m = c.grid_spacings * scan.spacing_m;
  constexpr double kResolution_m = 0.00005;  // the configuration's default
  ThreadPool pool(2);
  Progress progress;
  const scene::Lattice lattice =
      pipeline::project(cloud, Eigen::Matrix4d::Identity(), grid, kResolution_m, {pool, progress}).grid.lattice;
  const std::vector<ContestRow> rows =
      contest(contestants_of(cloud, points, grid, kResolution_m, lattice, scan.spacing_m), options.quick ? 3 : 5,
              options.quick || c.varied != "base" ? 1 : 3);
  const auto row = [&](const std::string& method, const ClosedFigures& f, double seconds, const ContestRow* timed) {
    const test::Judgement& j = f.judgement;
    csv << fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", method, named.name, c.varied, c.points,
                       c.noise_spacings, c.grid_spacings, field_of("%.5g", seconds),
                       timed != nullptr ? field_of("%.5g", timed->ratio) : "",
                       timed != nullptr && timed->rounds > 1 ? field_of("%.5g", timed->ratio_low) : "",
                       timed != nullptr && timed->rounds > 1 ? field_of("%.5g", timed->ratio_high) : "",
                       field_of("%.5g", f.rms_spacings), field_of("%.5g", f.p99_spacings),
                       field_of("%.5g", j.median_spacings), field_of("%.5g", 100.0 * j.wrong),
                       field_of("%.5g", 100.0 * j.beyond), timed != nullptr ? field_of("%.5g", 100.0 * j.covered) : "");
    fmt::print("| {} | {} {} {} {} | {} | {:.1f} | {:.4g} | {:.4g} | {:.4g} |\n", named.name, c.varied, c.points,
               c.noise_spacings, c.grid_spacings, method, 1e3 * seconds, f.rms_spacings, f.p99_spacings,
               100.0 * j.wrong);
    std::fflush(stdout);
  };
  for (const ContestRow& r : rows)
    row(r.method,
        judge_nodes(nodes_of(r.grid), judge_object(r.grid, *named.object, scan), *named.object, scan.spacing_m),
        r.seconds, &r);
  if (!options.cloudcompare || c.varied != "base") return;
  const fs::path file = options.work / "closed.ply";
  fs::create_directories(options.work);
  pipeline::PlyStream stream(file, file.string(), {}, "closed object");
  std::vector<pipeline::SimulatedPoint> simulated;
  for (const auto& p : scan.points) simulated.push_back({{p[0], p[1], p[2]}});
  stream.append(simulated, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  stream.close();
  if (const auto theirs = cloudcompare_raster(file, lattice.spacing_m, "MAX", false)) {
    std::vector<Eigen::Vector3d> nodes;
    for (const Sample& s : theirs->samples) nodes.emplace_back(s.x_m, s.y_m, s.z_m);
    row("CloudCompare RASTERIZE MAX (process)",
        judge_nodes(nodes, judge_object(nodes, lattice.spacing_m, *named.object, scan), *named.object, scan.spacing_m),
        theirs->process.seconds, nullptr);
  }
  fs::remove(file);
}

}  // namespace

void run_peers(const RunOptions& options) {
  {
    std::ofstream csv(options.out / "pipeline_open_peers.csv");
    csv << "method,back,varied,points_per_node,noise_mm,spacing_ratio,points,nodes,seconds,ratio,ratio_low,ratio_high,"
           "rms_away_mm,p99_away_mm,wrong_layer_percent,completeness_percent\n";
    fmt::print(
        "\n## Open objects\n\n| back | varied, points per node, noise mm, nodes | method | ms | RMS away mm | "
        "p99 away mm | wrong layer % | complete % |\n|---|---|---|---|---|---|---|---|\n");
    for (const OpenCase& c : open_cases(options.quick)) run_open(options, c, csv);
  }
  std::ofstream csv(options.out / "pipeline_closed_peers.csv");
  csv << "method,object,varied,points,noise_spacings,spacing_ratio,seconds,ratio,ratio_low,ratio_high,rms_spacings,"
         "p99_spacings,median_spacings,wrong_layer_percent,beyond_percent,completeness_percent\n";
  fmt::print(
      "\n## Closed objects\n\n| object | varied, points, noise, node spacing | method | ms | RMS spacings | p99 "
      "spacings | wrong layer % |\n|---|---|---|---|---|---|---|\n");
  for (const test::NamedObject& named : test::analytic_objects()) {
    if (named.name != "torus" && named.name != "knot" && (options.quick || named.name != "vase from above")) continue;
    std::vector<ClosedCase> cases{{}};
    if (!options.quick && named.name == "torus")
      cases.insert(cases.end(), {{"density", 20'000},
                                 {"density", 300'000},
                                 {"noise", 100'000, 0.02},
                                 {"noise", 100'000, 0.4},
                                 {"spacing", 100'000, 0.1, 2.0},
                                 {"spacing", 100'000, 0.1, 0.5}});
    if (options.quick)
      for (ClosedCase& c : cases) c.points = 50'000;
    for (const ClosedCase& c : cases) run_closed_case(options, named, c, csv);
  }
}

}  // namespace sparsha::bench
