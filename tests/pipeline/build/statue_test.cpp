// configs/statue.yaml, the sample of a whole object: built as it is shipped, judged by the distance that its scans were
// simulated from.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pipeline/build/build.h"
#include "pipeline/simulate/statue.h"
#include "scene/area/regions.h"
#include "scene/scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;
using Eigen::Vector3d;

const fs::path kSource = SPARSHA_SOURCE_DIR;

TEST(Statue, IsOfOurMakingAndSmall) {
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(kSource / "data/statue")) bytes += entry.file_size();
  EXPECT_LT(bytes, 3'000'000U);
}

TEST(Statue, IsWholeTrueAndNamedOnAllSides) {
  Progress progress;
  const test::TestFolder folder;
  const BuildResult built =
      build_scene_folder(scene::load_config(kSource / "configs/statue.yaml"), {}, folder / "scene", progress);
  const scene::ScenePointer opened = scene::open_scene(folder / "scene");
  const scene::SceneDescription& scene = opened->description();
  ASSERT_TRUE(scene.charts);
  const scene::Charts& charts = *scene.charts;
  std::vector<double> errors;
  std::map<std::string, std::size_t> nodes;
  for (const scene::Sheet& sheet : charts.sheets) {
    ASSERT_EQ(sheet.texture_m.size(), sheet.count());
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        const Vector3d grid = charts.origin_m + charts.place_m(sheet, i, j);
        const Vector3d drawn(grid.x() + 0.5 * kStatueWidth_m, grid.y(), grid.z());
        errors.push_back(std::abs(statue_distance_m(kStatueWidth_m, kStatueHeight_m, drawn)) / charts.spacing_m);
        if (const auto* part = scene::part_at(scene, {grid.x(), grid.y(), grid.z()})) ++nodes[part->name];
      }
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_GT(errors.size(), 100'000U);
  EXPECT_LT(errors[errors.size() / 2], 0.1) << "spacings";
  EXPECT_LT(errors[errors.size() * 99 / 100], 0.5);
  for (const scene::PartConfig& part : scene.config.parts) EXPECT_GT(nodes[part.name], 300U) << part.name;
  EXPECT_EQ(nodes.size(), scene.config.parts.size());

  ASSERT_TRUE(built.report.around && built.report.around->check);
  EXPECT_LT(built.report.around->check->agreement.p99_m, 0.3 * charts.spacing_m);
  EXPECT_LT(built.report.around->check->far, built.report.around->check->sampled / 200);
  for (const std::string& warning : built.report.warnings)
    EXPECT_EQ(warning.find("nowhere"), std::string::npos) << warning;
  EXPECT_TRUE(fs::exists(folder / "scene/around.png")) << "six views";

  // The girdle is behind, and the face in front.
  const auto girdle = scene::part_place(*opened, 3), face = scene::part_place(*opened, 0);
  ASSERT_TRUE(girdle && girdle->solid && face && face->solid);
  EXPECT_LT(girdle->solid->normal.normalized().z(), -0.8);
  EXPECT_GT(face->solid->normal.normalized().z(), 0.5);
}

}  // namespace
}  // namespace sparsha::pipeline
