// Time of each stage of a build against the number of points and of nodes, one thread. bench/report fits the exponents.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <vector>

#include "bench/pipeline/run.h"
#include "pipeline/build/build.h"
#include "pipeline/simulate/simulate.h"
#include "scene/config/config.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;

/// Best of `times` builds, seconds by stage; with texture and friction, so that every stage has work.
std::map<std::string, double> stages_of(const fs::path& folder, double points, int nodes, int times) {
  pipeline::SimulationConfig simulation;
  simulation.seed = 71;
  simulation.nodes = nodes;
  simulation.outlier_fraction = 0.005;
  simulation.surface.back = {pipeline::BackConfig::Kind::rough, 0.10, 0.003, 0.1};
  const double cells = static_cast<double>(nodes - 1) * (nodes - 1);
  simulation.scan = pipeline::SamplerConfig{points / 1.1 / cells, 1.0, 1};
  simulation.write_truth = false;
  Progress simulating;
  pipeline::write_simulation(simulation, folder, simulating);
  {
    std::ofstream yaml(folder / "sparsha.yaml", std::ios::app);
    yaml << "texture: {}\nfriction: {}\n";
  }
  std::map<std::string, double> best;
  for (int k = 0; k < times; ++k) {
    Progress progress;  // its stages add up
    pipeline::BuildOptions build;
    build.threads = 1;
    build.force = true;
    const pipeline::BuildResult built =
        pipeline::build_scene_folder(scene::load_config(folder / "sparsha.yaml"), build, folder / "scene", progress);
    std::map<std::string, double> seconds{{"whole build", built.report.total_seconds}};
    for (const StageTime& stage : built.report.stages) seconds[stage.name] += stage.seconds;
    for (const auto& [name, time] : seconds) {
      const auto [at, added] = best.emplace(name, time);
      if (!added) at->second = std::min(at->second, time);
    }
  }
  fs::remove_all(folder);
  return best;
}

}  // namespace

void run_scaling(const RunOptions& options) {
  std::ofstream csv(options.out / "pipeline_scaling.csv");
  csv << "stage,against,points,nodes,seconds\n";
  fmt::print("\n## Stages against points and nodes, one thread\n");
  const auto measure = [&](const char* against, double points, int nodes) {
    const auto stages = stages_of(options.work / "scaling", points, nodes, 1);
    fmt::print("{:.0f} points, {} x {} nodes:", points, nodes, nodes);
    for (const auto& [name, seconds] : stages) {
      csv << fmt::format("{},{},{:.0f},{},{}\n", name, against, points, nodes * nodes, seconds);
      fmt::print(" {} {:.4f} s;", name, seconds);
    }
    fmt::print("\n");
    std::fflush(stdout);
  };
  const std::vector<double> points =
      options.quick ? std::vector<double>{3e4, 1e5, 3e5, 1e6} : std::vector<double>{3e4, 1e5, 3e5, 1e6, 3e6, 1e7};
  for (const double count : points) measure("points", count, 400);
  const std::vector<int> nodes =
      options.quick ? std::vector<int>{100, 200, 400, 800} : std::vector<int>{100, 200, 400, 800, 1600, 3200};
  for (const int count : nodes) measure("nodes", options.quick ? 3e5 : 1e6, count);
}

}  // namespace sparsha::bench
