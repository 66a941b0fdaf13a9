// The whole pipeline on the sample relief: sums, bytes, blocks that are absent, failure that keeps the old scene.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include <Eigen/Geometry>

#include "base/error.h"
#include "base/files/files.h"
#include "pipeline/build/build.h"
#include "pipeline/build/recheck.h"
#include "pipeline/suggest/suggest.h"
#include "scene/scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

fs::path source_folder() { return SPARSHA_SOURCE_DIR; }

// The sample at a coarse spacing: the same code in a tenth of the time.
scene::Config sample_config(const std::vector<std::string>& settings = {}) {
  std::vector<std::string> all = {"grid={spacing_mm: 2}"};
  all.insert(all.end(), settings.begin(), settings.end());
  return scene::load_config(source_folder() / "configs" / "relief.yaml", all);
}

class Build : public ::testing::Test {
 protected:
  const test::TestFolder folder_;
  Progress progress_;
};

void expect_same_layers_and_description(const fs::path& a, const fs::path& b) {
  std::size_t compared = 0;
  for (const auto& entry : fs::recursive_directory_iterator(a)) {
    const fs::path relative = entry.path().lexically_relative(a);
    const bool counts = relative == "scene.yaml" || relative.string().starts_with("level-");
    if (!entry.is_regular_file() || !counts) continue;
    EXPECT_EQ(read_file(entry.path(), 1U << 30U), read_file(b / relative, 1U << 30U)) << relative;
    ++compared;
  }
  EXPECT_GT(compared, 4U);
}

TEST_F(Build, EveryPointReadIsAccountedForOnce) {
  const BuildResult result = build_scene(sample_config(), {}, progress_);
  const Report::Points& points = result.report.points;
  EXPECT_EQ(points.read,
            points.used + points.occluded + points.outlier + points.outside + points.filtered + points.invalid);
  std::uint64_t sources = 0;
  for (const scene::ScanSource& source : result.scene->description().sources) sources += source.points;
  EXPECT_EQ(points.read, sources);
  EXPECT_GT(result.report.coverage, 0.95);
  ASSERT_TRUE(result.report.check.has_value());
  EXPECT_LT(result.report.check->cloud_to_surface.median_m, 3.0 * result.scene->description().noise_m);
}

TEST_F(Build, SmoothingIsJudgedByThePointsAsMeasured) {
  const std::vector<std::string> settings = {"grid={spacing_mm: 4}", "check={samples: all}"};
  const BuildResult plain = build_scene(sample_config(settings), {}, progress_);
  std::vector<std::string> smooth = settings;
  smooth.emplace_back("filters=[{smooth: {radius_mm: 6, order: 2}}]");
  const BuildResult smoothed = build_scene(sample_config(smooth), {}, progress_);
  const DistanceStatistics& before = plain.report.check->cloud_to_surface;
  const DistanceStatistics& after = smoothed.report.check->cloud_to_surface;
  // The points that were moved lie nearer to the surface, by the noise; those that were measured do not.
  EXPECT_GT(after.median_m, 0.9 * before.median_m);
  EXPECT_GT(smoothed.scene->description().noise_m, 0.8 * plain.scene->description().noise_m);
  const Report::Points& points = smoothed.report.points;
  EXPECT_EQ(points.read,
            points.used + points.occluded + points.outlier + points.outside + points.filtered + points.invalid);
}

TEST_F(Build, ThinningKeepsAnAutomaticGridAsItWas) {
  const scene::Config whole = sample_config({"grid={}"});
  scene::Config thinned = whole;
  thinned.filters.emplace_back(scene::ThinConfig{2});
  const BuildResult a = build_scene(whole, {}, progress_);
  const BuildResult b = build_scene(thinned, {}, progress_);
  EXPECT_EQ(a.scene->description().levels.front().spacing_m, b.scene->description().levels.front().spacing_m);
  ASSERT_EQ(b.report.filters.size(), whole.filters.size() + 1);
  EXPECT_EQ(b.report.filters.back().removed, b.report.points.filtered);
  EXPECT_GT(b.report.points.filtered, 0U);
}

TEST_F(Build, PointsThatAreRemovedForTheirRadiusAreOutliersThatTheCheckSees) {
  scene::Config config = sample_config({"grid={spacing_mm: 4}", "check={samples: all}"});
  const std::uint64_t before = build_scene(config, {}, progress_).report.check->cloud_to_surface.samples;
  config.filters = {scene::RadiusOutlierConfig{0.004, 3, {}}};
  const BuildResult result = build_scene(config, {}, progress_);
  EXPECT_GT(result.report.filters.at(0).removed, 0U);
  EXPECT_GE(result.report.points.outlier, result.report.filters[0].removed);
  EXPECT_EQ(result.report.points.filtered, 0U);
  // Some of them lie behind the surface, where the check looks at none; most lie before it or beside it.
  EXPECT_GT(result.report.check->cloud_to_surface.samples + result.report.filters[0].removed, before);
}

TEST_F(Build, AScanFromAnotherSideKnowsWherePartsAndSoundsWereWritten) {
  const scene::Config first = sample_config({"grid={spacing_mm: 8}"});
  EXPECT_FALSE(build_scene(first, {}, progress_).scene->description().region_from_grid.has_value());
  scene::Config again = first;
  Eigen::Matrix4d tilt = Eigen::Matrix4d::Identity();
  tilt.topLeftCorner<3, 3>() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).toRotationMatrix();
  again.orientation.scan_to_grid = tilt * first.orientation.scan_to_grid;
  again.orientation.regions_scan_to_grid = first.orientation.scan_to_grid;
  again.grid.bounds_m.reset();
  const scene::ScenePointer scene = build_scene(again, {}, progress_).scene;
  ASSERT_TRUE(scene->description().region_from_grid.has_value());
  const Eigen::Vector4d on_object(0.4, 0.3, 0.05, 1.0);  // scan frame
  const Eigen::Vector4d seen = again.orientation.scan_to_grid * on_object;
  const Eigen::Vector4d written = first.orientation.scan_to_grid * on_object;
  EXPECT_GT((seen - written).norm(), 0.01);
  EXPECT_LT((*scene->description().region_from_grid * seen - written).norm(), 1e-12);
}

TEST_F(Build, NeitherThreadsNorTheOrderOfScansChangeAByteOfTheScene) {
  scene::Config config = sample_config();
  BuildOptions options;
  options.threads = 1;
  build_scene_folder(config, options, folder_ / "one", progress_);
  std::reverse(config.scans.begin(), config.scans.end());
  options.threads = 3;
  build_scene_folder(config, options, folder_ / "three", progress_);
  expect_same_layers_and_description(folder_ / "one", folder_ / "three");
}

TEST_F(Build, TheSceneOnDiskIsTheSceneInMemory) {
  const BuildResult result = build_scene_folder(sample_config(), {}, folder_ / "scene", progress_);
  const scene::ScenePointer disk = scene::open_scene(folder_ / "scene");
  ASSERT_EQ(disk->description().levels.size(), result.scene->description().levels.size());
  const scene::Layers a = disk->read_level(0);
  const scene::Layers b = result.scene->read_level(0);
  EXPECT_EQ(a.grid.state, b.grid.state);
  EXPECT_THAT(a.curvature_per_m, ::testing::Pointwise(::testing::NanSensitiveFloatEq(), b.curvature_per_m));
  ASSERT_TRUE(result.report.friction);
  const auto known = static_cast<std::uint64_t>(std::count_if(
      b.grid.state.begin(), b.grid.state.end(), [](scene::NodeState s) { return s != scene::NodeState::unknown; }));
  const auto decided = static_cast<std::uint64_t>(
      std::count_if(b.curvature_per_m.begin(), b.curvature_per_m.end(), [](float k) { return !std::isnan(k); }));
  EXPECT_EQ(result.report.friction->nodes, known);
  EXPECT_EQ(result.report.friction->nodes - result.report.friction->undecided, decided);
  // scene.yaml is a configuration again.
  EXPECT_EQ(disk->description().config.grid.spacing_m, result.scene->description().config.grid.spacing_m);
  EXPECT_TRUE(fs::exists(folder_ / "scene" / "report.html"));
}

TEST_F(Build, BlocksThatAreAbsentLeaveNoLayersAndNoStages) {
  scene::Config config = sample_config();
  config.fill.reset();
  config.texture.reset();
  config.friction.reset();
  config.check.reset();
  const BuildResult result = build_scene(config, {}, progress_);
  const scene::SceneDescription& description = result.scene->description();
  EXPECT_FALSE(description.has_envelope || description.has_curvature);
  EXPECT_EQ(result.report.filled_fraction, 0.0);
  EXPECT_FALSE(result.report.check.has_value());
  for (const StageTime& stage : result.report.stages) {
    EXPECT_TRUE(stage.name == "read" || stage.name == "filter" || stage.name == "project" || stage.name == "pyramid")
        << stage.name;
  }
}

TEST_F(Build, FailureAndCancellingKeepTheOldSceneAndLeaveNothingElse) {
  build_scene_folder(sample_config(), {}, folder_ / "scene", progress_);
  const std::string before = read_file(folder_ / "scene" / "scene.yaml", 1U << 20U);
  scene::Config broken = sample_config();
  broken.scans[1].file = folder_ / "missing.ply";
  EXPECT_THROW(build_scene_folder(broken, {}, folder_ / "scene", progress_), Error);
  Progress cancelled;
  cancelled.cancel();
  EXPECT_THROW(build_scene_folder(sample_config(), {}, folder_ / "scene", cancelled), Cancelled);
  EXPECT_EQ(read_file(folder_ / "scene" / "scene.yaml", 1U << 20U), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(Build, AnEmptyCloudIsRefusedByName) {
  std::ofstream(folder_ / "empty.ply")
      << "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  scene::Config config;
  scene::ScanConfig scan;
  scan.file = folder_ / "empty.ply";
  config.scans = {scan};
  try {
    (void)build_scene(config, {}, progress_);
    FAIL() << "an empty cloud was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("empty.ply"), std::string::npos);
  }
}

TEST_F(Build, ReportJsonSaysWhatTheReportSays) {
  const BuildResult result = build_scene(sample_config(), {}, progress_);
  const auto json = nlohmann::json::parse(report_json(*result.scene, result.report));
  EXPECT_EQ(json["points"]["read"], result.report.points.read);
  EXPECT_EQ(json["grid"]["nx"], result.scene->description().levels[0].nx);
  EXPECT_EQ(json["surface"]["method"], "windows");
  EXPECT_EQ(json["check"]["cloud_to_surface"]["samples"], result.report.check->cloud_to_surface.samples);
  for (const char* key : {"size_m", "coverage", "filled_fraction", "noise_m", "stages", "total_seconds",
                          "peak_rss_bytes", "inputs", "warnings", "version"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
}

/// A relief of 26 x 21 vertices, 0.02 apart; of its corners a grid of 1 mm has one in four hundred nodes.
void write_mesh(const fs::path& file) {
  std::ofstream text(file);
  for (int j = 0; j < 21; ++j)
    for (int i = 0; i < 26; ++i)
      text << "v " << 0.02 * i << ' ' << 0.02 * j << ' ' << 0.02 * std::sin(0.4 * i) * std::cos(0.3 * j) << '\n';
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 25; ++i) {
      const int n = 26 * j + i + 1;
      text << "f " << n << ' ' << n + 1 << ' ' << n + 26 << "\nf " << n + 1 << ' ' << n + 27 << ' ' << n + 26 << '\n';
    }
}

TEST_F(Build, AMeshIsJudgedByItsTrianglesAndCalledAMesh) {
  write_mesh(folder_ / "mesh.obj");
  scene::Config config;
  scene::ScanConfig scan;
  scan.file = folder_ / "mesh.obj";
  scan.units.unit = scene::LengthUnit::m;
  config.scans = {scan};
  config.grid.spacing_m = 0.001;
  config.check = scene::CheckConfig{20000};
  const auto built = [&](const std::string& name, unsigned threads, std::uint64_t memory_bytes) {
    BuildOptions options;
    options.threads = threads;
    options.memory_bytes = memory_bytes;
    Progress progress;
    build_scene_folder(config, options, folder_ / name, progress);
    return nlohmann::json::parse(read_file(folder_ / name / "report.json", 1U << 24U));
  };
  const auto report = built("scene", 1, 0);
  EXPECT_EQ(report["triangles"], 1000);
  EXPECT_EQ(report["surface"]["method"], "triangles");
  EXPECT_EQ(report["check"]["against"], "mesh");
  EXPECT_EQ(report["check"]["completeness"], 1.0);
  EXPECT_EQ(report["check"]["cloud_to_surface"]["samples"], 20000);
  // Flat triangles and bilinear cells of 1 mm differ at edges alone; heights are float32.
  EXPECT_LT(report["check"]["cloud_to_surface"]["median_m"], 1e-8);
  EXPECT_LT(report["check"]["surface_to_cloud"]["max_m"], 1e-7);
  EXPECT_TRUE(report["warnings"].empty());
  EXPECT_EQ(built("again", 3, 1'000'000'000)["check"], report["check"]);
  expect_same_layers_and_description(folder_ / "scene", folder_ / "again");

  const std::string page = read_file(folder_ / "scene" / "report.html", 1U << 30U);
  EXPECT_NE(page.find("Half of the mesh lies within"), std::string::npos);
  EXPECT_EQ(page.find("<dt>Points to surface</dt>"), std::string::npos);
  Progress progress;
  const Report checked = recheck_scene(*scene::open_scene(folder_ / "scene"), {}, *config.check, 0, progress);
  EXPECT_EQ(checked.check->against, CheckResult::Against::mesh);
  EXPECT_EQ(checked.triangles, 1000U);
  EXPECT_DOUBLE_EQ(*checked.check->completeness, 1.0);
}

TEST_F(Build, IslandsBesideAMeshAreSaidUnlessAFilterTakesThemAway) {
  write_mesh(folder_ / "mesh.obj");
  std::ofstream(folder_ / "mesh.obj", std::ios::app) << "v 0.1 0.1 0.1\nv 0.13 0.1 0.1\nv 0.1 0.13 0.1\nf -1 -2 -3\n";
  scene::Config config;
  scene::ScanConfig scan;
  scan.file = folder_ / "mesh.obj";
  scan.units.unit = scene::LengthUnit::m;
  config.scans = {scan};
  config.grid.spacing_m = 0.002;
  const BuildResult islands = build_scene(config, {}, progress_);
  ASSERT_EQ(islands.report.warnings.size(), 1U);
  EXPECT_NE(islands.report.warnings[0].find("2 separate pieces"), std::string::npos);
  config.filters = {scene::KeepConfig{{}, 0.03}};
  Progress progress;
  const BuildResult kept = build_scene(config, {}, progress);
  EXPECT_TRUE(kept.report.warnings.empty());
  EXPECT_EQ(kept.report.triangles, 1000U);
  EXPECT_LT(kept.scene->description().height_max_m, 0.03);
}

TEST_F(Build, ASceneCheckedAgainAgreesWithItsBuild) {
  // No filter takes points away here, so that both see the same cloud.
  scene::Config config = sample_config();
  config.filters.clear();
  const BuildResult result = build_scene_folder(config, {}, folder_ / "scene", progress_);
  Progress progress;
  const Report again = recheck_scene(*scene::open_scene(folder_ / "scene"), {}, *config.check, 0, progress);
  const double built = result.report.check->cloud_to_surface.rms_m;
  EXPECT_NEAR(again.check->cloud_to_surface.rms_m, built, 0.02 * built);
  EXPECT_EQ(again.check->cloud_to_surface.samples, result.report.check->cloud_to_surface.samples);
}

TEST_F(Build, TheSuggestedConfigurationBuilds) {
  const Suggestion suggestion =
      suggest_config({source_folder() / "data" / "relief" / "station-1.ply"}, folder_, progress_);
  EXPECT_NE(suggestion.yaml.find("look_from"), std::string::npos);
  write_file(folder_ / "new.yaml", suggestion.yaml);
  scene::Config config = scene::load_config(folder_ / "new.yaml");
  EXPECT_EQ(scene::to_yaml(config), scene::to_yaml(suggestion.config));
  config.check.reset();
  EXPECT_GT(build_scene(config, {}, progress_).report.coverage, 0.5);
}

TEST_F(Build, AScanListedManyTimesIsReadAndCountedOnce) {
  scene::Config config = sample_config();
  const BuildResult once = build_scene(config, {}, progress_);
  const std::vector<scene::ScanConfig> scans = config.scans;
  fs::copy_file(scans.front().file, folder_ / "copy.ply");
  for (int k = 0; k < 100; ++k) config.scans.insert(config.scans.end(), scans.begin(), scans.end());
  config.scans.push_back(scans.front());
  config.scans.back().file = folder_ / "copy.ply";
  Progress progress;
  const BuildResult many = build_scene(config, {}, progress);
  EXPECT_EQ(many.report.points.read, once.report.points.read);
  EXPECT_EQ(many.scene->description().config.scans.size(), scans.size());
  EXPECT_EQ(many.scene->in_memory(0)->grid.state, once.scene->in_memory(0)->grid.state);
  EXPECT_NE(progress.warnings().front().find("is listed 10"), std::string::npos);
  // Elsewhere it is another scan.
  config.scans = scans;
  config.scans.push_back(scans.front());
  config.scans.back().pose(2, 3) = 0.5;
  EXPECT_GT(build_scene(config, {}, progress).report.points.read, once.report.points.read);
}

}  // namespace
}  // namespace sparsha::pipeline
