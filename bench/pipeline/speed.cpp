// Projection in this process, whole builds as processes of their own; every time stands beside the error it bought.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <functional>
#include <optional>

#include "bench/pipeline/cloudcompare.h"
#include "bench/pipeline/judge.h"
#include "bench/pipeline/process.h"
#include "bench/pipeline/run.h"
#include "pipeline/projection/projector.h"
#include "pipeline/scan/reader.h"
#include "scene/scene.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;

/// A million points, a tenth of them on a sparse back: 0.91 M in front.
pipeline::SimulationConfig million(int nodes) {
  pipeline::SimulationConfig config;
  config.seed = 31;
  config.nodes = nodes;
  config.surface.back = {pipeline::BackConfig::Kind::rough, 0.10, 0.003, 0.1};
  config.outlier_fraction = 0.005;
  const double cells = static_cast<double>(nodes - 1) * (nodes - 1);
  config.scan = pipeline::SamplerConfig{1e6 / 1.1 / cells, 1.0, 1};
  config.write_truth = false;
  return config;
}

struct Best {
  double seconds = 1e300;
  double cpu_seconds = 1e300;
};

Best best_of(int repetitions, const std::function<void()>& work) {
  Best best;
  for (int k = 0; k < repetitions; ++k) {
    const auto wall = std::chrono::steady_clock::now();
    const std::clock_t cpu = std::clock();
    work();
    best.seconds =
        std::min(best.seconds, std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count());
    best.cpu_seconds = std::min(best.cpu_seconds, static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC);
  }
  return best;
}

class Table {
 public:
  explicit Table(const fs::path& file) : csv_(file) {
    csv_ << "task,method,threads,points,nodes,seconds,cpu_seconds,peak_rss_mb,rms_away_mm\n";
    fmt::print("\n| task | method | threads | ms | CPU ms | peak MB | RMS away mm |\n|---|---|---|---|---|---|---|\n");
  }
  void row(const std::string& task, const std::string& method, unsigned threads, std::size_t points, std::size_t nodes,
           const Best& best, std::uint64_t peak_rss_bytes, std::optional<double> rms_away_mm) {
    const double megabytes = static_cast<double>(peak_rss_bytes) * 1e-6;
    const std::string rms = rms_away_mm ? fmt::format("{:.4g}", *rms_away_mm) : "";
    const std::string peak = peak_rss_bytes > 0 ? fmt::format("{:.0f}", megabytes) : "";
    fmt::print("| {} | {} | {} | {:.1f} | {:.1f} | {} | {} |\n", task, method, threads, 1e3 * best.seconds,
               1e3 * best.cpu_seconds, peak, rms);
    std::fflush(stdout);
    csv_ << fmt::format("\"{}\",{},{},{},{},{},{},{},{}\n", task, method, threads, points, nodes, best.seconds,
                        best.cpu_seconds, peak, rms);
    csv_.flush();
  }

 private:
  std::ofstream csv_;
};

void time_projection(const RunOptions& options, int nodes, Table& table) {
  const fs::path folder = options.work / fmt::format("speed-{}", nodes);
  Progress progress;
  const pipeline::SimulationConfig simulation = million(nodes);
  pipeline::write_simulation(simulation, folder, progress);
  const pipeline::Truth truth(simulation);
  const scene::Config config = scene::load_config(folder / "sparsha.yaml");
  const pipeline::Cloud cloud = pipeline::load_scans(config.scans, progress);
  for (const unsigned threads : {1U, 2U}) {
    ThreadPool pool(threads);
    pipeline::Projection projection;
    const Best best = best_of(options.quick ? 3 : 9, [&] {
      projection = pipeline::project(cloud, config.orientation.scan_to_grid, config.grid, config.haptics.resolution_m,
                                     {pool, progress});
    });
    const Figures figures = judge(samples_of(projection.grid, truth), truth);
    table.row(fmt::format("project 1 M points to {0} x {0}", nodes), "sparsha", threads, cloud.size(),
              truth.lattice().count(), best, 0, figures.rms_away_mm);
    pipeline::Projector projector(cloud, pool);
    const Best again = best_of(options.quick ? 3 : 9, [&] {
      projection = projector.project(config.orientation.scan_to_grid, config.grid, config.haptics.resolution_m,
                                     {pool, progress});
    });
    table.row(fmt::format("look again at 1 M indexed points, {0} x {0}", nodes), "sparsha", threads, cloud.size(),
              truth.lattice().count(), again, 0, judge(samples_of(projection.grid, truth), truth).rms_away_mm);
  }
  if (options.cloudcompare) {
    Best best;
    std::optional<PeerRaster> raster;
    for (int k = 0; k < (options.quick ? 1 : 3); ++k) {
      raster = cloudcompare_raster(folder / "scan.ply", truth.lattice().spacing_m, "AVG", false);
      if (!raster) break;
      best.seconds = std::min(best.seconds, raster->process.seconds);
      best.cpu_seconds = std::min(best.cpu_seconds, raster->process.cpu_seconds);
    }
    if (raster) {
      table.row(fmt::format("project 1 M points to {0} x {0}", nodes), "cloudcompare avg (process)", 1, cloud.size(),
                truth.lattice().count(), best, raster->process.peak_rss_bytes,
                judge(raster->samples, truth).rms_away_mm);
    }
  }
  fs::remove_all(folder);
}

/// Level 0 of a scene that a build left, against the truth.
double scene_error(const fs::path& folder, const pipeline::Truth& truth) {
  const scene::Layers layers = scene::open_scene(folder)->read_level(0);
  return judge(samples_of(layers.grid, truth), truth).rms_away_mm;
}

void time_builds(const RunOptions& options, Table& table) {
  const fs::path folder = options.work / "build";
  Progress progress;
  const pipeline::SimulationConfig simulation = million(800);
  pipeline::write_simulation(simulation, folder, progress);
  const pipeline::Truth truth(simulation);
  {
    std::ofstream yaml(folder / "sparsha.yaml", std::ios::app);
    yaml << "texture: {}\nfriction: {}\n";
  }
  const auto time = [&](const std::string& task, unsigned threads, std::vector<std::string> more, bool judged) {
    std::vector<std::string> command{options.program.string()};
    command.insert(command.end(), more.begin(), more.end());
    Best best;
    std::uint64_t peak = 0;
    for (int k = 0; k < (options.quick ? 2 : 5); ++k) {
      const ProcessResult process = run_process(command);
      if (process.exit_code != 0) {
        fmt::print("| {} | failed with exit code {} |\n", task, process.exit_code);
        return;
      }
      best.seconds = std::min(best.seconds, process.seconds);
      best.cpu_seconds = std::min(best.cpu_seconds, process.cpu_seconds);
      peak = std::max(peak, process.peak_rss_bytes);
    }
    table.row(task, "sparsha (process)", threads, judged ? 1000000 : 0, judged ? truth.lattice().count() : 0, best,
              peak, judged ? std::optional<double>(scene_error(folder / "scene", truth)) : std::nullopt);
  };
  const std::string yaml = (folder / "sparsha.yaml").string();
  const std::string scene = (folder / "scene").string();
  for (const unsigned threads : {1U, 2U}) {
    const std::string count = std::to_string(threads);
    time("whole build, 1 M points at 800 x 800", threads,
         {"build", yaml, "--out", scene, "--quiet", "--threads", count}, true);
    time("build --only grid", threads, {"build", yaml, "--out", scene, "--quiet", "--threads", count, "--only", "grid"},
         true);
  }
  time("start and end", 1, {"--version"}, false);
  fs::remove_all(folder);
}

}  // namespace

void run_speed(const RunOptions& options) {
  Table table(options.out / "pipeline_speed.csv");
  time_projection(options, 512, table);
  time_projection(options, 800, table);
  if (fs::exists(options.program)) time_builds(options, table);
}

}  // namespace sparsha::bench
