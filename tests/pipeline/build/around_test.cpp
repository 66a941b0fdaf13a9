// Whole objects from scans on disk to a scene folder and back, judged by the analytic surface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>

#include <Eigen/Core>

#include "base/error.h"
#include "base/files/files.h"
#include "pipeline/build/build.h"
#include "pipeline/build/recheck.h"
#include "pipeline/export/export.h"
#include "pipeline/scan/reader.h"
#include "scene/scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr double kRing_m = 0.1, kTube_m = 0.04;  // of a torus about the scan's z axis
constexpr int kPoints = 12'000;
constexpr double kSpacing_m = 0.00363;  // root of its area over the points
const Vector3d kCentre_m(5.0, -3.0, 40.0);

Vector3d ring_to(const Vector3d& p) {
  const Vector3d q = p - kCentre_m;
  return q - kRing_m * Vector3d(q.x(), q.y(), 0.0).normalized();
}

/// A colour and an intensity of each place, and what they change by along an axis in 2.5 spacings.
std::array<double, 3> tint_at(const Vector3d& p) {
  const Vector3d q = (p - kCentre_m) / (kRing_m + kTube_m);
  return {120.0 + 100.0 * q.x(), 120.0 + 100.0 * q.y(), 120.0 + 100.0 * q.z()};
}
double shine_at(const Vector3d& p) { return 500.0 + 1000.0 * (p - kCentre_m).x(); }
constexpr double kTintSlack = 2.5 * 100.0 / (kRing_m + kTube_m) * kSpacing_m, kShineSlack = 2.5 * 1000.0 * kSpacing_m;

/// A node as --nodes writes it.
struct Node {
  double place[3];
  float normal[3];
  std::int32_t chart;
};

class AroundBuild : public ::testing::Test {
 protected:
  void SetUp() override {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> noise(0.0, 0.1 * kSpacing_m);
    std::string text, tinted = "//X Y Z R G B Intensity\n";
    for (int k = 0; k < kPoints;) {
      const double a = 6.283185307179586 * unit(random), b = 6.283185307179586 * unit(random);
      if (unit(random) * (kRing_m + kTube_m) > kRing_m + kTube_m * std::cos(b)) continue;
      const double tube = kTube_m + noise(random), r = kRing_m + tube * std::cos(b);
      const Vector3d p = kCentre_m + Vector3d(r * std::cos(a), r * std::sin(a), tube * std::sin(b));
      std::string place;
      for (int axis = 0; axis < 3; ++axis) place += std::to_string(p[axis]) + (axis < 2 ? " " : "");
      text += place + '\n';
      tinted += place;
      for (const double level : tint_at(p)) tinted += ' ' + std::to_string(std::lround(level));
      tinted += ' ' + std::to_string(shine_at(p)) + '\n';
      ++k;
    }
    write_file(folder_ / "torus.xyz", text);
    write_file(folder_ / "tinted.xyz", tinted);
  }

  // `more` are blocks of the configuration.
  BuildResult build(const std::string& more, unsigned threads = 2, const std::string& name = "scene",
                    const BuildOptions& given = {}, const std::string& scan = "torus.xyz") {
    write_file(folder_ / "torus.yaml", "scans:\n  - {file: " + scan +
                                           ", units: m}\n"
                                           "orientation: {look_from: [1, 0.3, 0.5], up: [0, 0, 1], scale: 2}\n"
                                           "check: {samples: all}\n" +
                                           more);
    Progress progress;
    BuildOptions options = given;
    options.threads = threads;
    return build_scene_folder(scene::load_config(folder_ / "torus.yaml"), options, folder_ / name, progress);
  }
  std::string bytes(const fs::path& file) { return read_file(folder_ / file, std::size_t{1} << 30U); }

  const test::TestFolder folder_;
};

TEST_F(AroundBuild, WritesTheSameChartsForAnyThreadsAndReadsThemBack) {
  const BuildResult built = build("around: {}\n", 1);
  const scene::SceneDescription description = built.scene->description();
  ASSERT_TRUE(description.charts);
  ASSERT_TRUE(built.report.around);
  EXPECT_EQ(built.report.around->nodes, description.charts->measured_nodes());
  static_cast<void>(build("around: {}\n", 3, "again"));
  EXPECT_EQ(bytes("scene/charts.bin"), bytes("again/charts.bin"));
  EXPECT_EQ(bytes("scene/scene.yaml"), bytes("again/scene.yaml"));

  const scene::ScenePointer opened = scene::open_scene(folder_ / "scene");
  const auto& charts = opened->description().charts;
  ASSERT_TRUE(charts);
  EXPECT_TRUE(opened->description().config.around);
  EXPECT_EQ(charts->sheets.size(), description.charts->sheets.size());
  EXPECT_EQ(charts->origin_m, description.charts->origin_m);
  EXPECT_EQ(charts->spacing_m, description.charts->spacing_m);
  fs::create_directories(folder_ / "copy");
  scene::write_scene(*opened, folder_ / "copy");
  EXPECT_EQ(bytes("scene/charts.bin"), bytes("copy/charts.bin"));
  // A scene with charts is one that may be replaced, also by one without.
  static_cast<void>(build("", 2));
  EXPECT_FALSE(fs::exists(folder_ / "scene" / "charts.bin"));
  EXPECT_FALSE(scene::open_scene(folder_ / "scene")->description().charts);
}

TEST_F(AroundBuild, ChangesNothingOfTheFrontView) {
  static_cast<void>(build("around: {}\n"));
  static_cast<void>(build("", 2, "front"));
  for (const char* layer : {"level-0/height.tif", "level-0/mask.tif"}) {
    EXPECT_EQ(bytes(fs::path("scene") / layer), bytes(fs::path("front") / layer)) << layer;
  }
}

TEST_F(AroundBuild, ExportsNodesOfAllSidesWithOutwardNormalsInTheScanFrame) {
  const BuildResult built = build("around: {}\n");
  Progress progress;
  export_scene(*built.scene, folder_ / "nodes.ply", true, progress);
  const std::string text = bytes("nodes.ply");
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment measured nodes of all charts in the scan frame, metres; outward "
      "normals\nelement vertex " +
      std::to_string(built.report.around->nodes) +
      "\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\nproperty float ny\n"
      "property float nz\nproperty int chart\nend_header\n";
  ASSERT_EQ(text.substr(0, header.size()), header);
  constexpr std::size_t kBytes = 3 * sizeof(double) + 3 * sizeof(float) + sizeof(std::int32_t);
  ASSERT_EQ(text.size(), header.size() + kBytes * built.report.around->nodes);
  ASSERT_GT(built.report.around->nodes, kPoints);
  Vector3d low = Vector3d::Constant(1e9), high = -low;
  double worst = 0.0, sum = 0.0;
  int charts = 0;
  for (std::size_t n = 0; n < built.report.around->nodes; ++n) {
    Node node{};
    const char* from = text.data() + header.size() + n * kBytes;
    std::memcpy(node.place, from, sizeof(node.place));
    std::memcpy(node.normal, from + sizeof(node.place), sizeof(node.normal));
    std::memcpy(&node.chart, from + sizeof(node.place) + sizeof(node.normal), sizeof(node.chart));
    const Vector3d place(node.place[0], node.place[1], node.place[2]);
    const Vector3d normal(node.normal[0], node.normal[1], node.normal[2]);
    const Vector3d ring = ring_to(place);
    const double error = std::abs(ring.norm() - kTube_m) / kSpacing_m;
    worst = std::max(worst, error);
    sum += error;
    EXPECT_NEAR(normal.norm(), 1.0, 1e-5);
    EXPECT_GT(normal.dot(ring.normalized()), 0.86);
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
    charts = std::max(charts, node.chart + 1);
  }
  EXPECT_LT(worst, 1.0);
  EXPECT_LT(sum / static_cast<double>(built.report.around->nodes), 0.08);
  EXPECT_EQ(static_cast<std::size_t>(charts), built.report.around->sheets);
  const Vector3d size(2.0 * (kRing_m + kTube_m), 2.0 * (kRing_m + kTube_m), 2.0 * kTube_m);
  EXPECT_LT((high - low - size).cwiseAbs().maxCoeff(), kSpacing_m);
}

TEST_F(AroundBuild, KeepsColoursAndIntensitiesOfAllSidesAndExportsThem) {
  const std::string asked = "around: {}\ngrid: {colour: true, intensity: true}\n";
  static_cast<void>(build(asked, 1, "scene", {}, "tinted.xyz"));
  static_cast<void>(build(asked, 3, "again", {}, "tinted.xyz"));
  EXPECT_EQ(bytes("scene/charts.bin"), bytes("again/charts.bin"));
  const scene::ScenePointer scene = scene::open_scene(folder_ / "scene");
  const scene::Charts& charts = *scene->description().charts;
  const Eigen::Matrix4d& m = scene->description().scan_from_grid;
  std::size_t nodes = 0;
  for (const scene::Sheet& sheet : charts.sheets) {
    ASSERT_EQ(sheet.colour_rgba.size(), sheet.count());
    ASSERT_EQ(sheet.intensity.size(), sheet.count());
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        const std::size_t node = sheet.index(i, j);
        if (!sheet.measured(node)) continue;
        const Vector3d grid_m = charts.origin_m + charts.place_m(sheet, i, j);
        const Vector3d place = m.topLeftCorner<3, 3>() * grid_m + m.topRightCorner<3, 1>();
        const std::array<double, 3> want = tint_at(place);
        for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(sheet.colour_rgba[node] >> (8 * c) & 255U, want[c], kTintSlack);
        ASSERT_NEAR(sheet.intensity[node], shine_at(place), kShineSlack);
        ++nodes;
      }
  }
  EXPECT_EQ(nodes, charts.measured_nodes());

  Progress progress;
  export_scene(*scene, folder_ / "nodes.ply", true, progress);
  const RawScan points = read_scan(folder_ / "nodes.ply");
  ASSERT_EQ(points.rgba.size(), nodes);
  for (std::size_t k = 0; k < nodes; ++k) {
    const std::array<double, 3> want = tint_at(Vector3d(points.points[k][0], points.points[k][1], points.points[k][2]));
    for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(points.rgba[k] >> (8 * c) & 255U, want[c], kTintSlack);
  }
  // Without being asked for they are not kept, as of the front.
  static_cast<void>(build("around: {}\n", 2, "plain", {}, "tinted.xyz"));
  EXPECT_TRUE(scene::open_scene(folder_ / "plain")->description().charts->sheets.front().colour_rgba.empty());
}

TEST_F(AroundBuild, IsCheckedWithEveryPointAndNotOnlyTheFront) {
  const BuildResult built = build("around: {}\n");
  ASSERT_TRUE(built.report.around && built.report.around->check);
  const ChartCheck& check = *built.report.around->check;
  EXPECT_EQ(check.sampled, static_cast<std::uint64_t>(kPoints));
  EXPECT_EQ(check.cloud_to_surface.samples + check.far, check.sampled);
  EXPECT_LE(check.far, static_cast<std::uint64_t>(kPoints / 1000));
  // Distances are the noise's, in the grid frame, which is twice as large.
  EXPECT_NEAR(check.cloud_to_surface.rms_m, 2.0 * 0.1 * kSpacing_m, 2.0 * 0.02 * kSpacing_m);
  EXPECT_LT(check.agreement.median_m, 2.0 * 0.05 * kSpacing_m);
  EXPECT_LT(check.nodes_alone, check.nodes);
  Progress progress;
  const Report again = recheck_scene(*scene::open_scene(folder_ / "scene"), {}, {0}, 2, progress);
  ASSERT_TRUE(again.around && again.around->check);
  EXPECT_EQ(again.around->check->far, check.far);
  EXPECT_EQ(again.around->check->cloud_to_surface.rms_m, check.cloud_to_surface.rms_m);
  EXPECT_EQ(again.around->check->agreement.p99_m, check.agreement.p99_m);
}

const std::string kTextured =
    "around: {}\ntexture: {sigma_space_mm: 15, sigma_range_mm: 3}\nfriction: {}\n"
    "parts: [{name: ring, box_m: [5.05, -3.1, 39.9, 5.2, -2.9, 40.1]}, {name: hole, box_m: [4.98, -3.02, 39.9, 5.02, "
    "-2.98, 40.1]}]\n"
    "guide: {path: drawn, line_m: [[5.1, -3, 40.03], [5.1, -2.98, 40.03]]}\n";

TEST_F(AroundBuild, ALineInSpaceFarFromTheObjectIsWarnedOf) {
  const BuildResult built =
      build("around: {}\nguide: {path: drawn, line_m: [[4.9, -3.1, 39.9], [4.9, -3.1, 39.8]]}\n", 1);
  EXPECT_THAT(built.report.warnings,
              ::testing::Contains(::testing::HasSubstr("the guide's line is nowhere: no surface lies in its box")));
}

TEST_F(AroundBuild, TextureAndItsCurvatureAreLayersOfAllSheets) {
  const BuildResult built = build(kTextured, 1);
  static_cast<void>(build(kTextured, 3, "again"));
  EXPECT_EQ(bytes("scene/charts.bin"), bytes("again/charts.bin"));
  const auto charts = scene::open_scene(folder_ / "scene")->description().charts;
  ASSERT_TRUE(charts);
  std::size_t nodes = 0, known = 0, rough = 0;
  for (std::size_t s = 0; s < charts->sheets.size(); ++s) {
    const scene::Sheet& sheet = charts->sheets[s];
    const scene::Sheet& made = built.scene->description().charts->sheets[s];
    ASSERT_EQ(sheet.texture_m.size(), sheet.count());
    ASSERT_EQ(sheet.curvature_per_m.size(), sheet.count());
    for (std::size_t node = 0; node < sheet.count(); ++node) {
      if (!sheet.measured(node)) continue;
      ASSERT_EQ(sheet.texture_m[node], made.texture_m[node]);
      ++nodes;
      known += std::isfinite(sheet.curvature_per_m[node]) ? 1 : 0;
      rough += std::abs(sheet.texture_m[node]) > 0.5 * 2.0 * kSpacing_m ? 1 : 0;
    }
  }
  EXPECT_GT(known, nodes * 99 / 100);
  EXPECT_EQ(rough, 0U) << "a torus is smooth";
  std::string warnings;
  for (const std::string& warning : built.report.warnings) warnings += warning + "\n";
  EXPECT_NE(warnings.find("part 'hole' is nowhere: no surface lies in its box"), std::string::npos) << warnings;
  EXPECT_EQ(warnings.find("part 'ring'"), std::string::npos) << warnings;
  EXPECT_EQ(warnings.find("the guide's line"), std::string::npos) << warnings;
  BuildOptions grid;
  grid.grid_only = true;
  EXPECT_THAT(
      build(kTextured, 2, "grid", grid).report.warnings,
      ::testing::Contains(
          "only heights are built; ignored of the configuration: around, the guide's line in space, parts in space"));
  EXPECT_TRUE(scene::open_scene(folder_ / "grid")->description().config.parts.empty());
}

// As of a scanner that stood near one side: points at one end are 50 times as dense as at the other.
TEST_F(AroundBuild, PointsThatAreTooUnevenAreThinnedAndItIsSaid) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto on_torus = [&](double tube_m) {
    for (;;) {
      const double a = 6.283185307179586 * unit(random), b = 6.283185307179586 * unit(random);
      if (unit(random) * (kRing_m + kTube_m) > kRing_m + kTube_m * std::cos(b)) continue;
      const double r = kRing_m + tube_m * std::cos(b);
      return Vector3d(kCentre_m + Vector3d(r * std::cos(a), r * std::sin(a), tube_m * std::sin(b)));
    }
  };
  std::string text;
  for (int k = 0; k < 4 * kPoints;) {
    const Vector3d p = on_torus(kTube_m + 0.1 * kSpacing_m * (2.0 * unit(random) - 1.0));
    const double along = 0.5 + 0.5 * (p - kCentre_m).x() / (kRing_m + kTube_m);
    if (unit(random) > std::pow(50.0, -along)) continue;
    for (int axis = 0; axis < 3; ++axis) text += std::to_string(p[axis]) + (axis < 2 ? ' ' : '\n');
    ++k;
  }
  write_file(folder_ / "near.xyz", text);
  const BuildResult built = build("around: {}\ngrid: {spacing_mm: 8}\n", 2, "scene", {}, "near.xyz");
  EXPECT_THAT(built.report.warnings, ::testing::Contains(::testing::HasSubstr("they are thinned to one a cube of")));
  const scene::Charts& charts = *built.scene->description().charts;
  const Eigen::Matrix4d& m = built.scene->description().scan_from_grid;
  std::vector<Vector3d> nodes;
  double worst_m = 0.0;
  for (const scene::Sheet& sheet : charts.sheets)
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        const Vector3d grid_m = charts.origin_m + charts.place_m(sheet, i, j);
        nodes.emplace_back(m.topLeftCorner<3, 3>() * grid_m + m.topRightCorner<3, 1>());
        const Vector3d ring = ring_to(nodes.back());
        worst_m = std::max(worst_m, std::abs(ring.norm() - kTube_m));
        EXPECT_GT((m.topLeftCorner<3, 3>() * scene::Charts::normal(sheet, i, j)).dot(ring), 0.0);
      }
  EXPECT_LT(worst_m, kSpacing_m);
  int covered = 0;
  constexpr int kAsked = 2000;
  for (int k = 0; k < kAsked; ++k) {
    const Vector3d place = on_torus(kTube_m);
    covered += std::ranges::any_of(nodes, [&](const Vector3d& node) { return (node - place).norm() < 0.006; }) ? 1 : 0;
  }
  EXPECT_GE(covered, kAsked * 995 / 1000);
}

TEST_F(AroundBuild, RefusesWhatItCannotDo) {
  BuildOptions small;
  small.memory_points = 1000;
  EXPECT_THROW(static_cast<void>(build("around: {}\n", 2, "small", small)), Error);
  EXPECT_THROW(static_cast<void>(build("around: {spacing_mm: 2}\n", 2, "key")), Error);
  EXPECT_FALSE(fs::exists(folder_ / "small"));
  BuildOptions grid;
  grid.grid_only = true;
  EXPECT_FALSE(build("around: {}\n", 2, "grid", grid).scene->description().charts);
}

TEST_F(AroundBuild, DamagedChartsAreBadInput) {
  const BuildResult built = build("around: {}\n");
  const fs::path file = folder_ / "scene" / "charts.bin";
  const std::string whole = bytes("scene/charts.bin");
  const auto expect_refused = [&](const std::string& text, const std::string& what) {
    write_file(file, text);
    try {
      static_cast<void>(scene::open_scene(folder_ / "scene"));
      ADD_FAILURE() << what << " was read";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << what;
    }
  };
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{10}, std::size_t{20}, whole.size() / 2, whole.size() - 1})
    expect_refused(whole.substr(0, length), "a file of " + std::to_string(length) + " bytes");
  expect_refused(whole + "x", "a longer file");
  const auto changed = [&](std::size_t at, char value) {
    std::string text = whole;
    text[at] = value;
    return text;
  };
  expect_refused(changed(0, 'x'), "another mark");
  expect_refused(changed(21, 1), "another number of sheets");
  expect_refused(changed(24, 64), "an unknown layer");
  expect_refused(changed(28, 9), "a seventh side");
  expect_refused(changed(43, 127), "a huge sheet");
  const std::size_t errors = sizeof(float) * built.scene->description().charts->sheets.back().count();
  expect_refused(changed(whole.size() - errors - 1, 7), "an unknown bit of a mask");
  write_file(file, whole);
  EXPECT_TRUE(scene::open_scene(folder_ / "scene")->description().charts);
  fs::remove(file);
  EXPECT_THROW(static_cast<void>(scene::open_scene(folder_ / "scene")), Error);
}

}  // namespace
}  // namespace sparsha::pipeline
