// Whole programs from a scan to heights, against the number of points: time, peak memory, bytes read and written. Ours
// in memory and under a limit of memory, CloudCompare and PCL beside it where they end in time.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "bench/pipeline/cloudcompare.h"
#include "bench/pipeline/pcl_mls.h"
#include "bench/pipeline/process.h"
#include "bench/pipeline/run.h"
#include "pipeline/scan/reader.h"
#include "pipeline/simulate/simulate.h"
#include "scene/config/config.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kPerNode = 1.5625;     // points a node of the simulated lattice
constexpr double kMostOfPeers = 1.1e6;  // points; beyond, moving least squares take minutes
constexpr const char* kLimit = "300MB";

class SitesTable {
 public:
  explicit SitesTable(const fs::path& file) : csv_(file) {
    csv_ << "program,points,seconds,cpu_seconds,peak_mb,read_mb,written_mb\n";
    fmt::print("\n## Whole programs against the points\n");
  }

  void add(const std::string& program, double points, const ProcessResult& took) {
    if (took.exit_code != 0) {
      fmt::print("{:.0f} points, {}: ended with exit code {}\n", points, program, took.exit_code);
      return;
    }
    const auto mb = [](std::uint64_t bytes) { return 1e-6 * static_cast<double>(bytes); };
    csv_ << fmt::format("{},{:.0f},{},{},{},{},{}\n", program, points, took.seconds, took.cpu_seconds,
                        mb(took.peak_rss_bytes), mb(took.read_bytes), mb(took.written_bytes));
    fmt::print("{:.0f} points, {}: {:.2f} s, {:.2f} s CPU, peak {:.0f} MB, read {:.0f} MB, written {:.0f} MB\n", points,
               program, took.seconds, took.cpu_seconds, mb(took.peak_rss_bytes), mb(took.read_bytes),
               mb(took.written_bytes));
    std::fflush(stdout);
  }

 private:
  std::ofstream csv_;
};

}  // namespace

void run_sites(const RunOptions& options) {
  if (!fs::exists(options.program)) return;
  SitesTable table(options.out / "pipeline_sites.csv");
  const std::vector<double> counts = options.quick ? std::vector{1e5, 1e6} : std::vector{1e5, 1e6, 1e7};
  for (const double points : counts) {
    const fs::path folder = options.work / "sites";
    pipeline::SimulationConfig simulation;
    simulation.seed = 37;
    simulation.nodes = 1 + static_cast<int>(std::lround(std::sqrt(points / kPerNode)));
    simulation.scan = pipeline::SamplerConfig{kPerNode, 1.0, 1};
    simulation.write_truth = false;
    Progress progress;
    pipeline::write_simulation(simulation, folder, progress);
    const scene::Config config = scene::load_config(folder / "sparsha.yaml");
    const fs::path& scan = config.scans.front().file;
    const auto ours = [&](const std::string& name, const std::vector<std::string>& more) {
      std::vector<std::string> command = {options.program.string(),           "build",
                                          (folder / "sparsha.yaml").string(), "--out",
                                          (folder / "scene").string(),        "--quiet"};
      command.insert(command.end(), more.begin(), more.end());
      forget_pages(scan);
      table.add(name, points, run_process(command));
      fs::remove_all(folder / "scene");
    };
    ours("sparsha build", {});
    ours(std::string("sparsha build --memory ") + kLimit, {"--memory", kLimit});
    if (points < kMostOfPeers) {
      const double spacing_m = config.grid.spacing_m;
      forget_pages(scan);
      table.add("PCL moving least squares", points, run_child([&] {
                  Progress quiet;
                  if (by_pcl_mls(pipeline::load_scan(config.scans.front(), quiet), 3.0 * spacing_m).empty()) _exit(1);
                }));
      forget_pages(scan);
      if (options.cloudcompare)
        if (const auto raster = cloudcompare_raster(scan, spacing_m, "AVG", true))
          table.add("CloudCompare SOR and RASTERIZE", points, raster->process);
    }
    fs::remove_all(folder);
  }
}

}  // namespace sparsha::bench
