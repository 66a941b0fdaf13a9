// Every accuracy scene through files, readers and projection, as a user's scan goes.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>

#include "bench/pipeline/cloudcompare.h"
#include "bench/pipeline/judge.h"
#include "bench/pipeline/run.h"
#include "bench/pipeline/scenes.h"
#include "pipeline/projection/projection.h"
#include "pipeline/scan/reader.h"
#include "scene/config/config.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;

std::string bound(double value, double limit, bool at_most, bool& kept) {
  if (std::isinf(limit) || (!at_most && limit == 0.0)) return "";
  const bool good = at_most ? value <= limit : value >= limit;
  kept = kept && good;
  return good ? "" : fmt::format(" ({} {:.3g}!)", at_most ? ">" : "<", limit);
}

class Table {
 public:
  explicit Table(const fs::path& file) : csv_(file) {
    csv_ << "scene,method,points,nodes,coverage_percent,rms_away_mm,p99_away_mm,off_2mm_away_percent,rms_all_mm,"
            "off_5mm_all_percent,rms_smooth_mm,median_mm,beside_bar_right_percent,seconds\n";
    fmt::print(
        "| scene | method | coverage % | RMS away mm | p99 away mm | > 2 mm away % | RMS all mm | > 5 mm all % | RMS "
        "smooth mm | beside bar % | s |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  }
  /// False when a bound of the scene is broken; bounds are ours, not the peer's.
  bool row(const Scene& scene, const std::string& method, std::size_t points, std::size_t nodes, const Figures& f,
           double seconds) {
    bool kept = true;
    const bool ours = method == "sparsha";
    const auto cell = [&](double value, double limit, bool at_most) {
      return fmt::format("{:.4g}{}", value, ours ? bound(value, limit, at_most, kept) : "");
    };
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.4g}{} | {:.3f} |\n", scene.name, method,
               cell(f.coverage_percent, scene.least_coverage_percent, false),
               cell(f.rms_away_mm, scene.rms_away_mm, true), cell(f.p99_away_mm, scene.p99_away_mm, true),
               cell(f.off2_away_percent, scene.off2_away_percent, true), cell(f.rms_all_mm, scene.rms_all_mm, true),
               cell(f.off5_all_percent, scene.off5_all_percent, true), cell(f.rms_smooth_mm, scene.rms_smooth_mm, true),
               f.beside_percent, ours ? bound(f.beside_percent, scene.least_beside_percent, false, kept) : "", seconds);
    std::fflush(stdout);
    csv_ << fmt::format("\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{}\n", scene.name, method, points, nodes,
                        f.coverage_percent, f.rms_away_mm, f.p99_away_mm, f.off2_away_percent, f.rms_all_mm,
                        f.off5_all_percent, f.rms_smooth_mm, f.median_mm, f.beside_percent, seconds);
    csv_.flush();
    return kept;
  }

 private:
  std::ofstream csv_;
};

/// The peer sees scans in the grid frame only, and of those the first two, on which its best is known.
void run_peer(const Scene& scene, const fs::path& folder, const pipeline::Truth& truth, std::size_t points,
              Table& table) {
  for (const auto& [projection, clean] : {std::pair<const char*, bool>{"AVG", true}, {"AVG", false}, {"MAX", false}}) {
    const auto raster = cloudcompare_raster(folder / "scan.ply", truth.lattice().spacing_m, projection, clean);
    if (!raster) continue;
    std::string method = fmt::format("cloudcompare{} {}", clean ? " sor" : "", projection);
    std::transform(method.begin(), method.end(), method.begin(), [](unsigned char c) { return std::tolower(c); });
    table.row(scene, method, points, truth.lattice().count(), judge(raster->samples, truth), raster->process.seconds);
  }
}

}  // namespace

bool run_accuracy(const RunOptions& options) {
  Table table(options.out / "pipeline_accuracy.csv");
  bool kept = true;
  int number = 0;
  for (const Scene& scene : accuracy_scenes(options.quick)) {
    ++number;
    if (scene.name.find(options.scenes) == std::string::npos) continue;
    const fs::path folder = options.work / fmt::format("scene-{}", number);
    Progress progress;
    pipeline::SimulationConfig simulation = scene.config;
    simulation.write_truth = false;
    pipeline::write_simulation(simulation, folder, progress);
    const pipeline::Truth truth(simulation);
    const scene::Config config = scene::load_config(folder / "sparsha.yaml");
    const pipeline::Cloud cloud = pipeline::load_scans(config.scans, progress);
    ThreadPool pool(1);
    const auto began = std::chrono::steady_clock::now();
    const pipeline::Projection projection = pipeline::project(cloud, config.orientation.scan_to_grid, config.grid,
                                                              config.haptics.resolution_m, {pool, progress});
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const std::vector<Sample> samples = samples_of(projection.grid, truth);
    kept = table.row(scene, "sparsha", cloud.size(), truth.lattice().count(), judge(samples, truth), seconds) && kept;
    if (options.cloudcompare && number <= 2) run_peer(scene, folder, truth, cloud.size(), table);
    fs::remove_all(folder);
  }
  return kept;
}

}  // namespace sparsha::bench
