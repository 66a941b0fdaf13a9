// Real scans become scenes with the points, coverage and cross-check figures expected of them, and can be touched.
// Expectations: points from the list of scans; coverage and distances from independent looks at the data, with room for
// better projections but not for wrong ones.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <thread>

#include "base/error.h"
#include "base/numbers/statistics.h"
#include "base/yaml/yaml.h"
#include "haptics/device/simulated/simulated_device.h"
#include "haptics/session/session.h"
#include "pipeline/build/build.h"
#include "pipeline/scan/reader.h"
#include "pipeline/suggest/suggest.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

fs::path scans_folder() {
  const char* folder = std::getenv("SPARSHA_SCANS_DIR");
  return folder == nullptr ? fs::path() : fs::path(folder);
}

struct Expected {
  std::string file;
  std::uint64_t points;       // records in the file
  double least_coverage;      // measured nodes / all
  double median_in_spacings;  // cloud to surface, at most
  double longest_m;           // longer side of the grid, within 15 %
};
void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.file; }

void expect_scene(const BuildResult& result, const Expected& expected) {
  const scene::Lattice& base = result.scene->description().levels.front();
  EXPECT_EQ(result.report.points.read, expected.points);
  EXPECT_GE(result.report.coverage, expected.least_coverage);
  const double longest = base.spacing_m * (std::max(base.nx, base.ny) - 1);
  EXPECT_NEAR(longest, expected.longest_m, 0.15 * expected.longest_m);
  ASSERT_TRUE(result.report.check.has_value());
  EXPECT_LE(result.report.check->cloud_to_surface.median_m, expected.median_in_spacings * base.spacing_m);
  EXPECT_GT(result.report.check->cloud_to_surface.samples, 0U);
}

// Five seconds with the simulated hand: contact is made, nothing is not a number, nothing is left unfinished.
void touch(const scene::ScenePointer& scene) {
  haptics::SessionOptions options;
  options.haptics = scene->description().config.haptics;
  haptics::Session session(scene, haptics::make_simulated_device(1, 5.0), options);
  session.start();
  bool finite = true;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (std::chrono::steady_clock::now() < end && !session.finished()) {
    session.poll();
    const haptics::State state = session.state().read();
    for (const double value : state.proxy_m) finite = finite && std::isfinite(value);
    for (const double value : state.force_n) finite = finite && std::isfinite(value);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const haptics::SessionSummary summary = session.stop();
  EXPECT_TRUE(finite);
  EXPECT_GT(summary.contacts, 0U);
  EXPECT_GT(summary.contact_s, 0.0);
  EXPECT_EQ(summary.unfinished, 0U);
}

TEST(RealScanMug, StandsAloneAfterTwoFilters) {
  if (scans_folder().empty()) GTEST_SKIP() << "SPARSHA_SCANS_DIR is not set: no real scans at hand";
  scene::Config config;
  scene::ScanConfig scan;
  scan.file = scans_folder() / "scans" / "table_scene_mug_stereo_textured.pcd";
  scan.units.unit = scene::LengthUnit::m;
  config.scans = {scan};
  const yaml::Node filters = yaml::parse_text(
      "scans: [{file: x}]\nfilters:\n"
      "  - remove_plane: {distance_mm: 15, normal: [0, -1, -1], max_angle_deg: 45}\n"
      "  - keep: {cluster: largest, tolerance_mm: 15}\n",
      "mug");
  config.filters = scene::parse_config(filters, {}).filters;
  config.orientation.scan_to_grid = scene::look_from({0, 0, -1}, {0, -1, 0}, 1.0);
  Progress progress;
  const BuildResult result = build_scene(config, {}, progress);
  // An independent program (three random points at a time, then one neighbour after the other) found 14 719 points
  // above the table in the largest group, in a box that is widened here by a point's distance to the table.
  const Eigen::Vector3d low(-0.002, 0.0, 0.704);
  const Eigen::Vector3d high(0.147, 0.126, 0.812);
  ASSERT_FALSE(result.report.kept_m.empty());
  for (const Eigen::Vector3d& p : result.report.kept_m) {
    EXPECT_TRUE((p.array() > low.array()).all() && (p.array() < high.array()).all()) << p.transpose();
  }
  const Report::Points& points = result.report.points;
  EXPECT_NEAR(static_cast<double>(points.used + points.occluded + points.outlier), 14719.0, 0.05 * 14719.0);
  // Its header has a viewpoint, which is not applied; the table is most of what was scanned.
  ASSERT_EQ(result.report.warnings.size(), 2U);
  EXPECT_NE(result.report.warnings[0].find("VIEWPOINT"), std::string::npos) << result.report.warnings[0];
  EXPECT_NE(result.report.warnings[1].find("'remove_plane' takes 92.6 %"), std::string::npos)
      << result.report.warnings[1];
}

class RealScan : public ::testing::TestWithParam<Expected> {};

TEST_P(RealScan, BecomesACorrectSceneThatCanBeTouched) {
  if (scans_folder().empty()) GTEST_SKIP() << "SPARSHA_SCANS_DIR is not set: no real scans at hand";
  const Expected& expected = GetParam();
  Progress progress;
  const Suggestion suggestion = suggest_config({scans_folder() / expected.file}, {}, progress);
  const BuildResult result = build_scene(suggestion.config, {}, progress);
  expect_scene(result, expected);
  touch(result.scene);
}

INSTANTIATE_TEST_SUITE_P(Heritage, RealScan,
                         ::testing::Values(Expected{"scans/Example.asc", 7817, 0.35, 0.5, 11.0},
                                           Expected{"heritage/demosthenes-low-res.obj", 8394, 0.60, 0.5, 2.69},
                                           Expected{"heritage/laurana.ply", 25160, 0.48, 0.5, 0.495},
                                           Expected{"heritage/igea.ply", 134345, 0.65, 0.1, 0.099},
                                           Expected{"heritage/lionstatue.obj", 31825, 0.48, 0.5, 1.79},
                                           Expected{"heritage/sceaux/scene_mesh_refine.ply", 87685, 0.65, 0.2, 8.23},
                                           Expected{"scans/room_scan1.pcd", 112586, 0.15, 0.5, 14.5},
                                           Expected{"scans/table_scene_mug_stereo_textured.pcd", 307200, 0.45, 0.5,
                                                    1.17},
                                           Expected{"scans/lato000.ply", 44461, 0.60, 0.1, 0.107}),
                         [](const auto& test) {
                           std::string name = fs::path(test.param.file).stem().string();
                           std::replace_if(
                               name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
                           return name;
                         });

// The poses of bun.conf, whose quaternions must be conjugated: p' = q* p + t.
scene::Config bunny_config() {
  scene::Config config;
  std::ifstream conf(scans_folder() / "scans" / "bunny_range" / "bun.conf");
  std::string kind;
  while (conf >> kind) {
    std::string name;
    if (kind == "bmesh") conf >> name;
    std::array<double, 7> v{};
    for (double& value : v) conf >> value;
    const fs::path file = scans_folder() / "scans" / "bunny_range" / name;
    if (kind != "bmesh" || !fs::exists(file)) continue;
    scene::ScanConfig scan;
    scan.file = file;
    const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
    scan.pose.topLeftCorner<3, 3>() = q.conjugate().normalized().toRotationMatrix();
    scan.pose.topRightCorner<3, 1>() = Eigen::Vector3d(v[0], v[1], v[2]);
    config.scans.push_back(scan);
  }
  config.fill = scene::FillConfig{0.003};
  config.texture = scene::TextureConfig{};
  config.friction = scene::FrictionConfig{};
  config.check = scene::CheckConfig{};
  return config;
}

TEST(RealScanBunny, FourRangeScansMergeIntoOneBunnyThatCanBeTouched) {
  if (scans_folder().empty()) GTEST_SKIP() << "SPARSHA_SCANS_DIR is not set: no real scans at hand";
  const scene::Config config = bunny_config();
  ASSERT_EQ(config.scans.size(), 4U);
  Progress progress;
  const BuildResult result = build_scene(config, {}, progress);
  expect_scene(result, {"bunny", 40256 + 40097 + 40251 + 36023, 0.55, 0.3, 0.156});
  touch(result.scene);
}

// The scans against the surface that others fused from them: registered to half a millimetre, so conjugation was right.
TEST(RealScanBunny, TheMergedBunnyLiesOnItsPublishedReconstruction) {
  if (scans_folder().empty()) GTEST_SKIP() << "SPARSHA_SCANS_DIR is not set: no real scans at hand";
  Progress progress;
  scene::Config config = bunny_config();
  config.check.reset();
  const BuildResult merged = build_scene(config, {}, progress);
  const scene::Lattice& lattice = merged.scene->description().levels.front();
  scene::Config reference;
  scene::ScanConfig zipper;
  zipper.file = scans_folder() / "scans" / "bun_zipper.ply";
  reference.scans = {zipper};
  reference.grid.spacing_m = lattice.spacing_m;
  reference.grid.bounds_m = {lattice.x_m(0), lattice.y_m(0), lattice.x_m(lattice.nx - 1), lattice.y_m(lattice.ny - 1)};
  const BuildResult published = build_scene(reference, {}, progress);
  const scene::DepthGrid a = merged.scene->read_level(0).grid;
  const scene::DepthGrid b = published.scene->read_level(0).grid;
  ASSERT_EQ(a.lattice.nx, b.lattice.nx);
  ASSERT_EQ(a.lattice.ny, b.lattice.ny);
  std::vector<double> difference;
  for (std::size_t n = 0; n < a.height_m.size(); ++n) {
    if (a.state[n] != scene::NodeState::measured || b.state[n] != scene::NodeState::measured) continue;
    difference.push_back(std::abs(static_cast<double>(a.height_m[n]) + a.lattice.origin_m.z() -
                                  static_cast<double>(b.height_m[n]) - b.lattice.origin_m.z()));
  }
  ASSERT_GT(difference.size(), a.height_m.size() / 3);
  EXPECT_LT(median(difference), 0.0005);
}

}  // namespace
}  // namespace sparsha::pipeline
