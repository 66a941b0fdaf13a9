// What is edited of a scene: its parts, written into its description; and the small files beside its layers.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/files/files.h"
#include "scene/folder/folder.h"
#include "tests/support/scenes.h"
#include "tests/support/test_folder.h"

namespace sparsha::scene {
namespace {

constexpr std::size_t kMost = 1U << 20U;

ScenePointer scene(const std::string& sha = std::string(64, 'a')) {
  return test::scene_of([](double x, double y) { return 0.1 * x + 0.05 * y; }, {101, 81, 0.001, 2, {3.0, 4.0, 5.0}},
                        [&](SceneDescription& d) {
                          d.config.scans.resize(1);
                          d.config.scans[0].file = "scan.ply";
                          d.sources = {{"scan.ply", sha, 77}};
                          auto map = std::make_shared<CheckMap>();
                          map->lattice = {3, 2, 0.05, {3.01, 4.02, 5.0}};
                          map->error_m = {1e-4F, 2e-4F, kUnknownHeight, 4e-4F, 5e-4F, 6e-4F};
                          map->high_m = 5.5e-4;
                          d.check_map = map;
                        });
}

TEST(Labels, EditedPartsAreWrittenAndAllElseOfTheFolderStaysToTheByte) {
  const test::TestFolder folder;
  write_scene(*scene(), folder);
  const std::string before = read_file(folder / "scene.yaml", kMost);
  const ScenePointer opened = open_scene(folder);
  write_description(*opened, folder);
  EXPECT_EQ(read_file(folder / "scene.yaml", kMost), before) << "nothing was edited";

  SceneDescription description = opened->description();
  PartConfig part;
  part.name = "nose";
  part.say = "the nose";
  part.box_m = {3.01, 4.01, 3.02, 4.03};
  part.touch.stiffness_n_per_m = 400.0;
  description.config.parts = {part};
  const ScenePointer edited = with_description(opened, description);
  EXPECT_EQ(edited->folder(), opened->folder());
  EXPECT_EQ(edited->read_level(1).grid.height_m.size(), opened->read_level(1).grid.height_m.size());
  write_description(*edited, folder);
  const ScenePointer again = open_scene(folder);
  ASSERT_EQ(again->description().config.parts.size(), 1U);
  EXPECT_EQ(again->description().config.parts[0].name, "nose");
  EXPECT_EQ(again->description().config.parts[0].say, "the nose");
  EXPECT_EQ(again->description().config.parts[0].box_m, part.box_m);
  EXPECT_EQ(again->description().config.parts[0].touch.stiffness_n_per_m, 400.0);
  description.config.parts.clear();
  write_description(*with_description(edited, description), folder);
  EXPECT_EQ(read_file(folder / "scene.yaml", kMost), before);
}

TEST(Labels, ADescriptionOfOtherLevelsIsRefused) {
  const ScenePointer made = scene();
  SceneDescription description = made->description();
  description.levels.pop_back();
  EXPECT_THROW(static_cast<void>(with_description(made, description)), Error);
}

TEST(Labels, TheSameGroundIsThatOfTheSameScansAndLevels) {
  const SceneDescription a = scene()->description();
  SceneDescription b = a;
  b.config.parts.resize(1);
  EXPECT_TRUE(same_ground(a, b));
  b.levels[0].origin_m.x() += 1e-9;
  EXPECT_FALSE(same_ground(a, b));
  EXPECT_TRUE(same_scans(a, b));
  EXPECT_FALSE(same_scans(a, scene(std::string(64, 'b'))->description()));
  b.sources.clear();
  EXPECT_FALSE(same_scans(b, b)) << "of unknown scans nothing is known";
}

TEST(CheckMapFile, ComesBackWithTheSceneAndADamagedOneIsAnErrorOfTheInput) {
  const test::TestFolder folder;
  write_scene(*scene(), folder);
  const auto map = open_scene(folder)->description().check_map;
  ASSERT_TRUE(map);
  EXPECT_EQ(map->lattice.nx, 3);
  EXPECT_EQ(map->lattice.origin_m, Eigen::Vector3d(3.01, 4.02, 5.0));
  EXPECT_EQ(map->high_m, 5.5e-4);
  EXPECT_EQ(map->error_m[4], 5e-4F);
  EXPECT_TRUE(std::isnan(map->error_m[2]));
  write_file(folder / "error.tif", "no picture");
  try {
    static_cast<void>(open_scene(folder));
    FAIL() << "a damaged map was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("error.tif"), std::string::npos) << error.what();
  }
}

TEST(CheckMapFile, OutsideTheFolderIsRefusedUnlessTrusted) {
  const test::TestFolder folder;
  std::filesystem::create_directories(folder / "scene");
  write_scene(*scene(), folder / "scene");
  std::filesystem::rename(folder / "scene" / "error.tif", folder / "error.tif");
  std::filesystem::create_symlink("../error.tif", folder / "scene" / "error.tif");
  EXPECT_THROW(static_cast<void>(open_scene(folder / "scene")), Error);
  EXPECT_TRUE(open_scene(folder / "scene", Trust::any_file)->description().check_map);
}

}  // namespace
}  // namespace sparsha::scene
