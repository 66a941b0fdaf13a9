// An independent program judges both our cross-check and our mesh: CloudCompare's C2M distances.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "pipeline/build/build.h"
#include "pipeline/export/export.h"
#include "pipeline/simulate/simulate.h"
#include "scene/config/config.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

namespace fs = std::filesystem;

TEST(CloudCompare, DistancesFromScanToExportedMeshConfirmTheCrossCheckWithinFivePercent) {
  if (std::system("command -v CloudCompare > /dev/null 2>&1") != 0) GTEST_SKIP() << "CloudCompare is not installed";
  const sparsha::test::TestFolder folder;
  // Front points only: what is occluded does not count in our check and would in theirs. Turned and moved, so that a
  // mesh that is not back in the scan frame is far off.
  SimulationConfig simulation;
  simulation.nodes = 384;  // coarser, triangles and bilinear patches part visibly in the cells of the step
  simulation.scan = SamplerConfig{2.5, 1.0, 1};
  simulation.origin_m = {3.0, -2.0, 1.0};
  simulation.look_from = {0.0, -1.0, 0.0};
  simulation.up = {0.0, 0.0, 1.0};
  simulation.write_truth = false;
  Progress progress;
  write_simulation(simulation, folder, progress);
  scene::Config config = scene::load_config(folder / "sparsha.yaml");
  config.check = scene::CheckConfig{0};
  const BuildResult built = build_scene(config, {}, progress);
  export_scene(*built.scene, folder / "mesh.ply", false, progress);
  const std::string command =
      "QT_QPA_PLATFORM=offscreen CloudCompare -SILENT -C_EXPORT_FMT ASC -PREC 9 -NO_TIMESTAMP -O " +
      (folder / "scan.ply").string() + " -O " + (folder / "mesh.ply").string() + " -C2M_DIST > /dev/null 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::ifstream stream(folder / "scan_C2M_DIST.asc");
  double sum = 0.0, squares = 0.0;
  std::uint64_t points = 0;
  for (std::string line; std::getline(stream, line);) {
    const double d = std::strtod(line.c_str() + line.find_last_of(' ') + 1, nullptr);
    sum += std::fabs(d);
    squares += d * d;
    ++points;
  }
  ASSERT_TRUE(built.report.check.has_value());
  const DistanceStatistics& ours = built.report.check->cloud_to_surface;
  ASSERT_EQ(points, ours.samples);
  const auto n = static_cast<double>(points);
  EXPECT_NEAR(ours.mean_m / (sum / n), 1.0, 0.05);
  EXPECT_NEAR(ours.rms_m / std::sqrt(squares / n), 1.0, 0.05);
  RecordProperty("ours_mean_mm", std::to_string(1e3 * ours.mean_m));
  RecordProperty("cloudcompare_mean_mm", std::to_string(1e3 * sum / n));
}

}  // namespace
}  // namespace sparsha::pipeline
