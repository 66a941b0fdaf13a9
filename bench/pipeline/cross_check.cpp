// Our cross-check of a scene against CloudCompare's distances between the scan and the exported mesh.
#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "bench/pipeline/cloudcompare.h"
#include "bench/pipeline/run.h"
#include "pipeline/build/build.h"
#include "pipeline/export/export.h"
#include "pipeline/simulate/simulate.h"
#include "scene/config/config.h"

namespace sparsha::bench {

bool run_cross_check(const RunOptions& options) {
  if (!options.cloudcompare) return true;
  // Front points only: what is occluded does not count in our check and would in theirs.
  pipeline::SimulationConfig simulation;
  simulation.seed = 41;
  simulation.nodes = 512;
  simulation.scan = pipeline::SamplerConfig{3.6, 1.0, 1};
  simulation.write_truth = false;
  const std::filesystem::path folder = options.work / "c2m";
  Progress progress;
  pipeline::write_simulation(simulation, folder, progress);
  scene::Config config = scene::load_config(folder / "sparsha.yaml");
  config.check = scene::CheckConfig{0};
  const pipeline::BuildResult built = pipeline::build_scene(config, {}, progress);
  pipeline::export_scene(*built.scene, folder / "mesh.ply", false, progress);
  const auto theirs = cloudcompare_distances(folder / "scan.ply", folder / "mesh.ply");
  std::filesystem::remove_all(folder);
  if (!theirs || !built.report.check) return true;
  const pipeline::DistanceStatistics& ours = built.report.check->cloud_to_surface;
  std::ofstream csv(options.out / "pipeline_c2m.csv");
  csv << "method,points,mean_mm,rms_mm\n"
      << fmt::format("sparsha,{},{},{}\ncloudcompare c2m,{},{},{}\n", ours.samples, 1e3 * ours.mean_m, 1e3 * ours.rms_m,
                     theirs->points, 1e3 * theirs->mean_m, 1e3 * theirs->rms_m);
  const double off =
      std::max(std::fabs(ours.mean_m / theirs->mean_m - 1.0), std::fabs(ours.rms_m / theirs->rms_m - 1.0));
  fmt::print(
      "\ncloud to surface: ours mean {:.4f} mm, RMS {:.4f} mm of {} points; CloudCompare C2M mean {:.4f} mm, RMS "
      "{:.4f} mm of {}: they differ by {:.2f} %\n",
      1e3 * ours.mean_m, 1e3 * ours.rms_m, ours.samples, 1e3 * theirs->mean_m, 1e3 * theirs->rms_m, theirs->points,
      100.0 * off);
  return off <= 0.05;
}

}  // namespace sparsha::bench
