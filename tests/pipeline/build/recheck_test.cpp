// A scene that is checked again is judged by the points that its build kept, and nothing else.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "base/error.h"
#include "base/files/files.h"
#include "pipeline/build/build.h"
#include "pipeline/build/recheck.h"
#include "scene/scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

constexpr double kSpacing_m = 0.005;

class Recheck : public ::testing::Test {
 protected:
  // A waved relief of 0.5 m over a floor of 0.8 m that is 0.2 m behind it, and a scaffold's pole above the relief's
  // left.
  void SetUp() override {
    std::mt19937_64 random(3);
    const auto uniform = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
    std::string relief;
    std::string rest;
    const auto add = [](std::string& text, double x, double y, double z) {
      text += std::to_string(x) + ' ' + std::to_string(y) + ' ' + std::to_string(z) + '\n';
    };
    for (int k = 0; k < 40000; ++k) {
      const double x = 0.5 * uniform();
      const double y = 0.5 * uniform();
      add(relief, x, y, 0.02 * std::sin(20.0 * x) * std::cos(17.0 * y) + 0.001 * (uniform() - 0.5));
    }
    for (int k = 0; k < 50000; ++k)
      add(rest, -0.15 + 0.8 * uniform(), -0.15 + 0.8 * uniform(), -0.2 + 0.001 * (uniform() - 0.5));
    for (int k = 0; k < 1000; ++k) add(rest, 0.1 + 0.01 * uniform(), 0.5 * uniform(), 0.3 + 0.001 * uniform());
    write_file(folder_ / "relief.xyz", relief);
    write_file(folder_ / "all.xyz", relief + rest);
  }

  // Builds and opens a scene of all points with those filters.
  BuildResult build(const std::string& filters, const std::string& grid = {}) {
    const std::string text = "scans:\n  - {file: all.xyz, units: m}\n" + filters +
                             "orientation: {look_from: [0, 0, 1], up: [0, 1, 0]}\ngrid: {spacing_mm: 5" + grid +
                             "}\ncheck: {samples: all}\n";
    write_file(folder_ / "scene.yaml", text);
    Progress progress;
    return build_scene_folder(scene::load_config(folder_ / "scene.yaml"), {}, folder_ / "scene", progress);
  }
  Report check(const std::vector<fs::path>& scans = {}) {
    Progress progress;
    return recheck_scene(*scene::open_scene(folder_ / "scene"), scans, {0}, 0, progress);
  }
  static void expect_same(const Report& built, const Report& again) {
    EXPECT_EQ(built.points.read, again.points.read);
    EXPECT_EQ(built.points.filtered, again.points.filtered);
    EXPECT_EQ(built.points.used, again.points.used);
    EXPECT_EQ(built.points.outlier, again.points.outlier);
    EXPECT_EQ(built.filters.size(), again.filters.size());
    const auto same = [](const DistanceStatistics& a, const DistanceStatistics& b) {
      constexpr double kRounding_m = 1e-6 * kSpacing_m;  // of float heights in files
      EXPECT_EQ(a.samples, b.samples);
      EXPECT_NEAR(a.median_m, b.median_m, kRounding_m);
      EXPECT_NEAR(a.rms_m, b.rms_m, kRounding_m);
      EXPECT_NEAR(a.max_m, b.max_m, kRounding_m);
    };
    same(built.check->cloud_to_surface, again.check->cloud_to_surface);
    same(built.check->surface_to_cloud, again.check->surface_to_cloud);
    EXPECT_DOUBLE_EQ(built.check->tolerance_m, again.check->tolerance_m);
    EXPECT_DOUBLE_EQ(*built.check->completeness, *again.check->completeness);
  }

  const test::TestFolder folder_;
};

constexpr const char* kOneObject =
    "filters:\n  - remove_plane: {distance_mm: 5, side: both, normal: [0, 0, 1]}\n"
    "  - keep: {cluster: largest, tolerance_mm: 15}\n";

TEST_F(Recheck, FindsWhatTheBuildFoundWhereFiltersTookFloorAndScaffoldAway) {
  const BuildResult built = build(kOneObject);
  ASSERT_GT(built.report.points.filtered, 50000U);
  expect_same(built.report, check());
}

TEST_F(Recheck, CountsOutliersOfFiltersAndNoiseOfMovedPointsAsTheBuildDoes) {
  const BuildResult built = build(std::string(kOneObject) +
                                  "  - radius_outliers: {radius_mm: 4, neighbours: 4}\n  - smooth: {radius_mm: 20}\n");
  ASSERT_GT(built.report.points.outlier, 0U);
  expect_same(built.report, check());
}

TEST_F(Recheck, UsesTheNoiseThatTheConfigurationGives) {
  const BuildResult built = build(kOneObject, ", noise_mm: 1.2");
  const Report again = check();
  expect_same(built.report, again);
}

TEST_F(Recheck, ReadsTheColumnsThatTheSceneWasBuiltFrom) {
  std::ofstream table(folder_ / "table.txt");
  for (int k = 0; k < 10000; ++k) {
    const double x = 0.005 * (k % 100);
    const double y = 0.005 * (k / 100);
    table << 0.25 * k << ' ' << 0.02 * std::sin(20.0 * x) * std::cos(17.0 * y) << ' ' << x << ' ' << y << " 9\n";
  }
  table.close();
  write_file(folder_ / "scene.yaml",
             "scans:\n  - {file: table.txt, units: m, columns: [skip, z, x, y]}\n"
             "orientation: {look_from: [0, 0, 1], up: [0, 1, 0]}\ngrid: {spacing_mm: 5}\ncheck: {samples: all}\n");
  Progress progress;
  const BuildResult built =
      build_scene_folder(scene::load_config(folder_ / "scene.yaml"), {}, folder_ / "scene", progress);
  EXPECT_LT(built.report.check->cloud_to_surface.median_m, kSpacing_m / 10);
  expect_same(built.report, check());
  fs::copy_file(folder_ / "table.txt", folder_ / "copy.txt");
  expect_same(built.report, check({folder_ / "copy.txt"}));
}

TEST_F(Recheck, AppliesNoFilterToScansThatAreNotTheScenes) {
  static_cast<void>(build(kOneObject));
  const Report own = check({folder_ / "all.xyz"});
  EXPECT_GT(own.points.filtered, 50000U);
  const Report other = check({folder_ / "relief.xyz"});
  EXPECT_EQ(other.points.filtered, 0U);
  EXPECT_EQ(other.points.read, 40000U);
  EXPECT_LT(other.check->cloud_to_surface.median_m, kSpacing_m);
}

TEST_F(Recheck, NamesAScanThatShowsNothingOfTheScene) {
  static_cast<void>(build(kOneObject));
  std::string line;
  for (int k = 0; k < 1000; ++k) line += std::to_string(5.0 + 0.0005 * k) + " 0.1 0\n";
  write_file(folder_ / "line.xyz", line);
  try {
    static_cast<void>(check({folder_ / "line.xyz"}));
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_EQ(fs::path(error.place().file).filename(), "line.xyz");
    EXPECT_EQ(error.expected().find("grid."), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace sparsha::pipeline
