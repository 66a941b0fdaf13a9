// Raw clouds of whole objects: the front, and only the front. Analytic shapes, and real meshes where SPARSHA_SCANS_DIR
// says; errors beside times, and CloudCompare's raster of the same cloud beside both.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "base/error.h"
#include "bench/pipeline/cloudcompare.h"
#include "bench/pipeline/run.h"
#include "bench/report/figure_text.h"
#include "pipeline/projection/projection.h"
#include "pipeline/simulate/ply_stream.h"
#include "tests/support/closed_bounds.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;
using test::Judgement;
using test::ObjectScan;

constexpr double kResolution_m = 0.00005;  // the configuration's default
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Case {
  test::ScanOptions scan;
  double grid_spacings = 1.0;  ///< node spacing in point spacings
  int nodes = 0;               ///< along the longer side, instead of grid_spacings
};

std::string text_of(const Case& c) {
  std::string text = fmt::format("{}, {}, ", c.scan.points, c.scan.noise_spacings);
  text += c.nodes > 0 ? fmt::format("{} nodes", c.nodes) : fmt::format("{:g}", c.grid_spacings);
  if (c.scan.density_ratio != 1.0) text += fmt::format(", density 1:{}", c.scan.density_ratio);
  if (c.scan.lines > 0.0) text += fmt::format(", lines 1:{}", c.scan.lines);
  if (c.scan.hole_spacings > 0.0) text += fmt::format(", hole of {}", c.scan.hole_spacings);
  return text;
}

struct Peer {
  Judgement figures;
  double ms = kNone;
};
struct Row {
  std::string object;
  Case what;
  Judgement figures;
  double noise_ratio = kNone;
  double ms_one = kNone, ms_two = kNone;
  std::optional<Peer> peer;
};

/// Share of a hole's nodes that show what lies behind; NaN without a hole.
double through_percent(const Judgement& f) {
  if (f.hole_nodes == 0) return kNone;
  return 100.0 * static_cast<double>(f.hole_through) / static_cast<double>(f.hole_nodes);
}

class Table {
 public:
  explicit Table(const fs::path& file) : csv_(file) {
    csv_ << "object,points,noise_spacings,grid_spacings,density_ratio,hole_spacings,lines,method,nodes,covered_percent,"
            "smooth_percent,wrong_smooth_percent,wrong_percent,beyond_percent,median_spacings,noise_ratio,"
            "hole_through_percent,ms_one_thread,ms_two_threads\n";
    fmt::print(
        "\n| object: points, noise, grid | wrong, smooth % | wrong, all % | beyond silhouette % | median, smooth, "
        "spacings | "
        "noise found / true | back in hole % | ms, 1 thread | 2 threads | CloudCompare: wrong, smooth % | all % | "
        "beyond "
        "% | median | ms |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  }

  /// False when a bound is broken; bounds are ours, not the peer's.
  bool row(const Row& r) {
    bool kept = true;
    const auto cell = [&](double value, double limit) {
      const bool good = std::isnan(value) || value <= limit;
      kept = kept && good;
      return field_of("%.3g", value) + (good ? "" : fmt::format(" (> {:.3g}!)", limit));
    };
    const test::ClosedBounds b = test::closed_bounds(r.object, r.what.scan);
    const Judgement& f = r.figures;
    std::string line =
        fmt::format("| {}: {} | {} | {} | {} | {} |", r.object, text_of(r.what),
                    cell(100.0 * f.wrong_smooth, 100.0 * b.wrong_smooth), cell(100.0 * f.wrong, 100.0 * b.wrong),
                    cell(100.0 * f.beyond, 100.0 * b.beyond), cell(f.median_spacings, b.median_spacings));
    const bool noise_found = !b.noise || std::abs(r.noise_ratio - 1.0) <= 0.25;
    kept = kept && noise_found;
    line +=
        fmt::format(" {}{} | {} | {} | {} |", field_of("%.3g", r.noise_ratio), noise_found ? "" : " (not within 25 %!)",
                    cell(through_percent(f), 0.0), field_of("%.0f", r.ms_one), field_of("%.0f", r.ms_two));
    csv_line(r, "sparsha", f, r.noise_ratio, r.ms_one, r.ms_two);
    if (r.peer) {
      const Judgement& p = r.peer->figures;
      line += fmt::format(" {:.3g} | {:.3g} | {:.3g} | {:.3g} | {} |", 100.0 * p.wrong_smooth, 100.0 * p.wrong,
                          100.0 * p.beyond, p.median_spacings, field_of("%.0f", r.peer->ms));
      csv_line(r, "cloudcompare max", p, kNone, r.peer->ms, kNone);
    } else {
      line += " | | | | |";
    }
    fmt::print("{}\n", line);
    std::fflush(stdout);
    return kept;
  }

 private:
  void csv_line(const Row& r, const char* method, const Judgement& f, double noise, double ms_one, double ms_two) {
    const test::ScanOptions& s = r.what.scan;
    const double grid = r.what.nodes > 0 ? kNone : r.what.grid_spacings;
    csv_ << fmt::format("\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", r.object, s.points,
                        s.noise_spacings, field_of("%.3g", grid), s.density_ratio, s.hole_spacings, s.lines, method,
                        f.nodes, 100.0 * f.covered, 100.0 * f.smooth, 100.0 * f.wrong_smooth, 100.0 * f.wrong,
                        100.0 * f.beyond, f.median_spacings, field_of("%.3g", noise),
                        field_of("%.3g", through_percent(f)), field_of("%.3g", ms_one), field_of("%.3g", ms_two));
    csv_.flush();
  }

  std::ofstream csv_;
};

scene::GridConfig grid_of(const Case& c, double spacing_m) {
  scene::GridConfig grid;
  if (c.nodes > 0) {
    grid.size = c.nodes;
  } else {
    grid.spacing_m = c.grid_spacings * spacing_m;
  }
  return grid;
}

/// The best of three runs, milliseconds, after one that fetches its memory: what a view of the same scan costs. The
/// benchmark of whole programs has what the first one costs.
double timed(const pipeline::Cloud& cloud, const scene::GridConfig& grid, unsigned threads,
             pipeline::Projection& projection) {
  ThreadPool pool(threads);
  Progress progress;
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 4; ++k) {
    const auto began = std::chrono::steady_clock::now();
    projection = pipeline::project(cloud, Eigen::Matrix4d::Identity(), grid, kResolution_m, {pool, progress});
    const double ms = 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    if (k > 0) best = std::min(best, ms);
  }
  return best;
}

std::optional<Peer> raster_of_peer(const RunOptions& options, const test::ClosedObject& object, const ObjectScan& scan,
                                   double step_m) {
  const fs::path file = options.work / "closed.ply";
  {
    pipeline::PlyStream stream(file, file.string(), {}, "closed object");
    std::vector<pipeline::SimulatedPoint> points;
    for (const auto& p : scan.points) points.push_back({{p[0], p[1], p[2]}});
    stream.append(points, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
    stream.close();
  }
  const auto raster = cloudcompare_raster(file, step_m, "MAX", false);
  fs::remove(file);
  if (!raster) return std::nullopt;
  std::vector<Eigen::Vector3d> nodes;
  for (const Sample& s : raster->samples) nodes.emplace_back(s.x_m, s.y_m, s.z_m);
  return Peer{judge_object(nodes, step_m, object, scan), 1e3 * raster->process.seconds};
}

bool run_case(const RunOptions& options, const test::NamedObject& named, const Case& c, Table& table) {
  const ObjectScan scan = scan_object(*named.object, c.scan);
  if (c.scan.hole_spacings > 0.0 && !scan.hole) return true;
  const pipeline::Cloud cloud = test::make_cloud(scan.points);
  const scene::GridConfig grid = grid_of(c, scan.spacing_m);
  Row row;
  row.object = named.name;
  row.what = c;
  pipeline::Projection projection;
  try {
    row.ms_two = timed(cloud, grid, 2, projection);
    row.ms_one = timed(cloud, grid, 1, projection);
  } catch (const Error& error) {
    fmt::print("| {}: {} | {} |\n", named.name, text_of(c), error.what());
    return false;
  }
  row.figures = judge_object(projection.grid, *named.object, scan);
  row.noise_ratio = projection.noise_m / scan.noise_m;
  if (options.cloudcompare) {
    row.peer = raster_of_peer(options, *named.object, scan, projection.grid.lattice.spacing_m);
  }
  return table.row(row);
}

/// Noise of one cloud as seen from six sides: the same cloud, so the same noise.
bool run_directions(const test::NamedObject& named, double noise_spacings) {
  const ObjectScan scan = scan_object(*named.object, {100'000, noise_spacings, 3});
  const pipeline::Cloud cloud = test::make_cloud(scan.points);
  scene::GridConfig grid;
  grid.spacing_m = scan.spacing_m;
  std::string cells;
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const Eigen::Matrix4d& view : test::six_views()) {
    const double ratio = test::project_cloud(cloud, grid, view).noise_m / scan.noise_m;
    cells += fmt::format(" {:.3g} |", ratio);
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  const bool kept = most <= 1.15 * least;
  fmt::print("| {} | {} |{} {:.1f}{} |\n", named.name, noise_spacings, cells, 100.0 * (most / least - 1.0),
             kept ? "" : " (> 15!)");
  std::fflush(stdout);
  return kept;
}

std::vector<Case> cases_of(const RunOptions& options, const std::string& object, bool real) {
  std::vector<Case> cases;
  const auto add = [&](std::size_t points, double noise, double grid, double ratio = 1.0, double hole = 0.0) {
    Case c;
    c.scan.points = points;
    c.scan.noise_spacings = noise;
    c.scan.density_ratio = ratio;
    c.scan.hole_spacings = hole;
    c.grid_spacings = grid;
    cases.push_back(c);
  };
  const std::vector<std::size_t> all_counts{20'000, 100'000, 400'000, 1'000'000};
  const std::vector<std::size_t> few_counts{20'000, 100'000}, real_counts{20'000, 100'000, 400'000};
  const auto& counts = options.every ? all_counts : real && !options.quick ? real_counts : few_counts;
  const std::vector<double> noises =
      options.every ? std::vector<double>{0.02, 0.1, 0.3, 0.5} : std::vector<double>{0.1};
  const std::vector<double> grids = options.every ? std::vector<double>{1.0, 2.0, 0.5} : std::vector<double>{1.0};
  for (const std::size_t points : counts) {
    for (const double noise : noises) {
      for (const double grid : grids) add(points, noise, grid);
    }
  }
  for (const std::size_t points : options.every ? all_counts : std::vector<std::size_t>{100'000}) {
    add(points, 0.1, 1.0, 10.0);
    add(points, 0.1, 1.0, 1.0, 10.0);
    add(points, 0.1, 1.0);
    cases.back().scan.lines = 4.0;
  }
  const bool timed_object = object == "torus" || object == "vase from above" || object == "lionstatue.obj";
  if (options.every || (!options.quick && timed_object)) {
    add(1'000'000, 0.1, 1.0);
    cases.back().nodes = 800;
  }
  return cases;
}

}  // namespace

bool run_closed(const RunOptions& options) {
  fs::create_directories(options.work);
  const char* scans = std::getenv("SPARSHA_SCANS_DIR");
  const std::vector<test::NamedObject> shapes = test::analytic_objects();
  const std::vector<test::NamedObject> meshes = test::mesh_objects(scans == nullptr ? "" : scans);
  bool kept = true;
  Table table(options.out / "pipeline_closed.csv");
  for (const auto* objects : {&shapes, &meshes}) {
    for (const test::NamedObject& named : *objects) {
      for (const Case& c : cases_of(options, named.name, objects == &meshes)) {
        if ((named.name + ", " + text_of(c)).find(options.scenes) == std::string::npos) continue;
        kept = run_case(options, named, c, table) && kept;
      }
    }
  }
  fmt::print(
      "\n| object, 100000 points | noise, spacings | found / true from +z | -z | +x | -x | +y | -y | spread % |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const auto* objects : {&shapes, &meshes}) {
    for (const test::NamedObject& named : *objects) {
      if (named.name.find(options.scenes) == std::string::npos) continue;
      for (const double noise : {0.1, 0.3}) kept = run_directions(named, noise) && kept;
    }
  }
  return kept;
}

}  // namespace sparsha::bench
