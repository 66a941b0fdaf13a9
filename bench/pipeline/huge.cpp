// Whole builds of scans that are larger than the memory they get: time, peak memory, error, and every byte of the scene
// against the same build in memory.
#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "base/files/files.h"
#include "base/system.h"
#include "bench/pipeline/judge.h"
#include "bench/pipeline/process.h"
#include "bench/pipeline/run.h"
#include "pipeline/simulate/simulate.h"
#include "scene/scene.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;

// As docs/measure/simulation.md has it: 1.5625 points per node of the lattice, in four files.
pipeline::SimulationConfig scan_of(double points) {
  constexpr double kPerNode = 1.5625;
  pipeline::SimulationConfig config;
  config.seed = 31;
  config.nodes = 1 + static_cast<int>(std::lround(std::sqrt(points / kPerNode)));
  config.outlier_fraction = 0.005;
  config.scan = pipeline::SamplerConfig{kPerNode, 1.0, 4};
  config.write_truth = false;
  return config;
}

bool same_bytes(const fs::path& a, const fs::path& b) {
  for (const auto& entry : fs::recursive_directory_iterator(a)) {
    const fs::path relative = entry.path().lexically_relative(a);
    if (!entry.is_regular_file() || !(relative == "scene.yaml" || relative.string().starts_with("level-"))) continue;
    if (!fs::exists(b / relative)) return false;
    if (MappedFile(entry.path()).text() != MappedFile(b / relative).text()) return false;
  }
  return true;
}

struct Built {
  bool good = false;
  double points = 0.0, cpu_seconds = 0.0;
};

// One scan under a limit of memory that its build breaks without files on disk.
Built build_under(double points, const std::string& limit, double limit_bytes, const RunOptions& options,
                  std::ofstream& csv) {
  const fs::path folder = options.work / "huge";
  const pipeline::SimulationConfig simulation = scan_of(points);
  Progress progress;
  pipeline::write_simulation(simulation, folder, progress);
  const auto build = [&](const std::string& scene, const std::vector<std::string>& more) {
    std::vector<std::string> command = {options.program.string(),           "build",
                                        (folder / "sparsha.yaml").string(), "--out",
                                        (folder / scene).string(),          "--quiet"};
    command.insert(command.end(), more.begin(), more.end());
    return run_process(command);
  };
  const ProcessResult limited = build("disk", {"--memory", limit});
  if (limited.exit_code != 0) {
    fmt::print("{:.0f} points under {}: failed with exit code {}\n", points, limit, limited.exit_code);
    fs::remove_all(folder);
    return {};
  }
  const Figures error =
      judge(samples_of(scene::open_scene(folder / "disk")->read_level(0).grid, pipeline::Truth(simulation)),
            pipeline::Truth(simulation));
  const auto peak = static_cast<double>(limited.peak_rss_bytes);
  constexpr double kBytesInMemory = 80.0;  // a point, generously
  std::string same = "not compared: too little memory";
  bool good = peak <= limit_bytes;
  double seconds_in_memory = 0.0;
  if (kBytesInMemory * points < 0.8 * static_cast<double>(system::physical_memory_bytes())) {
    const ProcessResult free = build("memory", {});
    seconds_in_memory = free.seconds;
    const bool equal = free.exit_code == 0 && same_bytes(folder / "memory", folder / "disk");
    same = equal ? "the same bytes" : "OTHER BYTES";
    good = good && equal;
  }
  fmt::print(
      "{:.0f} points under {}: {:.1f} s (in memory {:.1f}), {:.2f} us CPU a point, peak {:.0f} MB{}, RMS away "
      "from the step {:.4g} mm; {}\n",
      points, limit, limited.seconds, seconds_in_memory, limited.cpu_seconds * 1e6 / points, peak * 1e-6,
      peak <= limit_bytes ? "" : " BREAKS THE LIMIT", error.rms_away_mm, same);
  csv << fmt::format("{:.0f},{},{},{},{},{},{},{}\n", points, limit, limited.seconds, limited.cpu_seconds,
                     seconds_in_memory, peak * 1e-6, error.rms_away_mm, same);
  fs::remove_all(folder);
  return {good, points, limited.cpu_seconds};
}

}  // namespace

bool run_huge(const RunOptions& options) {
  if (options.huge_points <= 0.0 || !fs::exists(options.program)) return true;
  std::ofstream csv(options.out / "pipeline_huge.csv");
  csv << "points,memory_limit,seconds,cpu_seconds,seconds_in_memory,peak_rss_mb,rms_away_mm,bytes\n";
  const Built tenth = build_under(options.huge_points / 10, "200MB", 200e6, options, csv);
  const Built whole = build_under(options.huge_points, "1GB", 1e9, options, csv);
  // The nodes do not fit either.
  const Built little = build_under(options.huge_points, "300MB", 300e6, options, csv);
  if (tenth.good && whole.good) {
    fmt::print("CPU time grows as points to the power of {:.2f}\n",
               std::log(whole.cpu_seconds / tenth.cpu_seconds) / std::log(whole.points / tenth.points));
  }
  return tenth.good && whole.good && little.good;
}

}  // namespace sparsha::bench
