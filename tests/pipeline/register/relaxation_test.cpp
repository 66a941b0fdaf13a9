// Our relaxation of all poses beside pcl::registration::LUM, from the same poses, pairs and matches.
#include "pipeline/register/relaxation.h"

#include <cstdio>

#include <gtest/gtest.h>

#include "pipeline/register/posed_scan.h"
#include "tests/support/lum.h"
#include "tests/support/stations.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline::testing {
namespace {

/// Found poses of the configuration's scans after one of the two relaxations.
std::vector<Eigen::Matrix4d> relaxed(const std::vector<scene::ScanConfig>& rough, const std::vector<Edge>& edges,
                                     bool lum) {
  Progress progress;
  ThreadPool pool(2);
  const PosedScans posed = read_posed_scans(rough, 0.0, true, {pool, progress});
  std::vector<PosedSurface> surfaces;
  for (const PosedScan& scan : posed.scans) surfaces.push_back({scan.medium.get(), scan.pose});
  const double spacing_m = posed.spacing_m(&PosedScan::medium);
  if (lum) {
    relax_by_lum(surfaces, edges, 6.0 * spacing_m, 3.0 * spacing_m, 12);
  } else {
    relax_jointly(surfaces, edges, 6.0 * spacing_m, 3.0 * spacing_m, {pool, progress});
  }
  std::vector<Eigen::Matrix4d> poses;
  for (std::size_t s = 0; s < rough.size(); ++s)
    poses.push_back(s == 0 ? rough[s].pose : posed.pose_of(s, surfaces[s].pose));
  return poses;
}

TEST(Relaxation, ACircleOfStationsComesNearerToTheTruthThanByLum) {
  const test::TestFolder folder;
  constexpr int kStations = 6;
  const std::vector<scene::ScanConfig> truth = ring(
      folder.path(), kStations, [](int) { return 12000; }, 1e-4, 1);
  std::vector<Edge> edges;
  for (std::size_t a = 0; a < kStations; ++a) {
    const std::size_t b = (a + 1) % kStations;
    edges.push_back({std::min(a, b), std::max(a, b)});
  }
  for (const std::uint64_t seed : {1U}) {
    const std::vector<scene::ScanConfig> rough = disturbed(truth, seed, 1.0, 0.002);
    std::vector<Eigen::Matrix4d> given;
    for (const scene::ScanConfig& scan : rough) given.push_back(scan.pose);
    const double before_m = rms_error(truth, given);
    const double ours_m = rms_error(truth, relaxed(rough, edges, false));
    const double lum_m = rms_error(truth, relaxed(rough, edges, true));
    std::printf("seed %d: given %.4f mm, ours %.4f mm, LUM %.4f mm\n", static_cast<int>(seed), 1e3 * before_m,
                1e3 * ours_m, 1e3 * lum_m);
    EXPECT_LT(lum_m, before_m) << "seed " << seed << ": LUM is not used well";
    EXPECT_LE(ours_m, lum_m) << "seed " << seed;
    EXPECT_LT(ours_m, 1e-4 / 3.0) << "seed " << seed << ": a third of the noise";
  }
}

}  // namespace
}  // namespace sparsha::pipeline::testing
