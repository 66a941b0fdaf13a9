// Clicks and keys to parts, through the controller as the window feeds it.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>

#include <Eigen/Core>

#include "scene/folder/folder.h"
#include "tests/support/part_scenes.h"
#include "tests/support/test_folder.h"
#include "tests/viewer/marks/marking_bench.h"

namespace sparsha::viewer::test {
namespace {

scene::ScenePointer with_part() {
  return plate([](scene::SceneDescription& d) {
    scene::PartConfig part;
    part.name = part.say = "petal";
    part.box_m = {0.05, 0.05, 0.10, 0.09};
    part.touch.stiffness_n_per_m = 500.0;
    d.config.parts.push_back(part);
  });
}

TEST(Marking, APartsCornerIsDraggedAndWhatElseItHasStays) {
  MarkingBench bench(with_part());
  bench.key('A');
  ASSERT_TRUE(bench.controller->settings().parts);
  bench.point_at(0.10, 0.09);
  bench.controller->mouse_button(0, true, 0);
  bench.point_at(0.13, 0.12);
  EXPECT_TRUE(bench.saved.empty()) << "while it is dragged nothing is kept";
  bench.controller->mouse_button(0, false, 0);
  bench.run();
  ASSERT_EQ(bench.saved.size(), 1U);
  ASSERT_EQ(bench.saved[0].size(), 1U);
  const scene::PartConfig& part = bench.saved[0][0];
  EXPECT_NEAR(part.box_m[0], 0.05, 1e-12);
  EXPECT_NEAR(part.box_m[1], 0.05, 1e-12);
  EXPECT_NEAR(part.box_m[2], 0.13, 0.001);
  EXPECT_NEAR(part.box_m[3], 0.12, 0.001);
  EXPECT_EQ(part.touch.stiffness_n_per_m, 500.0);
  // The middle moves all of it; a corner cannot be dragged through the others.
  bench.point_at(0.09, 0.085);
  bench.controller->mouse_button(0, true, 0);
  bench.point_at(0.10, 0.085);
  bench.controller->mouse_button(0, false, 0);
  bench.run();
  ASSERT_EQ(bench.saved.size(), 2U);
  EXPECT_NEAR(bench.saved[1][0].box_m[0], 0.06, 0.001);
  EXPECT_NEAR(bench.saved[1][0].box_m[2], 0.14, 0.001);
  bench.point_at(0.06, 0.05);
  bench.controller->mouse_button(0, true, 0);
  bench.point_at(0.18, 0.18);
  bench.controller->mouse_button(0, false, 0);
  bench.run();
  EXPECT_LT(bench.marks().parts[0].box_m[0], bench.marks().parts[0].box_m[2]);
}

TEST(Marking, ANewPartGetsItsNameAndOneThatCannotBeKeptGoesBack) {
  MarkingBench bench(with_part());
  bench.point_at(0.15, 0.15);
  bench.key('K', kShift);
  bench.type("leaf");
  bench.key(key::kEnter);
  ASSERT_EQ(bench.saved.size(), 1U);
  ASSERT_EQ(bench.saved[0].size(), 2U);
  EXPECT_EQ(bench.saved[0][1].name, "leaf");
  EXPECT_EQ(bench.saved[0][1].say, "leaf");
  EXPECT_NEAR(0.5 * (bench.saved[0][1].box_m[0] + bench.saved[0][1].box_m[2]), 0.15, 0.001);
  bench.takes_parts = false;
  bench.point_at(0.15, 0.15);
  bench.key(key::kDelete);
  EXPECT_EQ(bench.saved.size(), 2U);
  EXPECT_EQ(bench.marks().parts.size(), 1U) << "as the scene has them";
}

TEST(Marking, PartsDrawnInAnotherOrientationAreShownAndNotEdited) {
  MarkingBench bench(plate([](scene::SceneDescription& d) {
    scene::PartConfig part;
    part.name = "petal";
    part.box_m = {0.05, 0.05, 0.10, 0.09};
    d.config.parts.push_back(part);
    d.region_from_grid = Eigen::Matrix4d::Identity();
  }));
  bench.key('A');
  ASSERT_EQ(bench.marks().parts.size(), 1U);
  EXPECT_TRUE(bench.marks().parts_fixed);
  bench.point_at(0.10, 0.09);
  bench.controller->mouse_button(0, true, 0);
  bench.point_at(0.13, 0.12);
  bench.controller->mouse_button(0, false, 0);
  bench.run();
  EXPECT_TRUE(bench.saved.empty());
}

/// A box, a polygon and a label, of which the pixels from x = 0.10 to 0.15 and y = 0.10 to 0.15 are.
scene::ScenePointer with_shapes(const std::filesystem::path& labels) {
  sparsha::test::write_labels(
      labels, 40, 40, [](int column, int row) { return column >= 20 && column < 30 && row >= 10 && row < 20 ? 3 : 0; });
  return plate([&](scene::SceneDescription& d) {
    d.config.audio.emplace();
    d.config.audio->labels = scene::LabelImageConfig{labels, std::array<double, 4>{0.0, 0.0, 0.2, 0.2}};
    scene::PartConfig polygon;
    polygon.name = polygon.say = "leaf";
    polygon.polygon_m = {{0.02, 0.02}, {0.08, 0.02}, {0.08, 0.04}, {0.04, 0.04}, {0.04, 0.09}, {0.02, 0.09}};
    scene::PartConfig label;
    label.name = label.say = "stalk";
    label.label = 3;
    d.config.parts = {{"petal", "petal", {0.12, 0.03, 0.18, 0.07}}, polygon, label};
  });
}

TEST(Marking, PolygonsAndLabelsAreShownAsTheyAreAndOnlyBoxesAreDragged) {
  const sparsha::test::TestFolder folder;
  const scene::ScenePointer scene = with_shapes(folder / "labels.png");
  MarkingBench bench(scene);
  bench.key('A');
  ASSERT_EQ(bench.marks().parts.size(), 3U);
  EXPECT_TRUE(bench.marks().parts[0].is_box);
  ASSERT_EQ(bench.marks().parts[1].borders_m.size(), 1U);
  EXPECT_EQ(bench.marks().parts[1].borders_m[0].size(), 7U) << "six corners and the first once more";
  EXPECT_EQ(bench.marks().parts[1].box_m, (std::array<double, 4>{0.02, 0.02, 0.08, 0.09}));
  ASSERT_EQ(bench.marks().parts[2].borders_m.size(), 1U);
  for (const Eigen::Vector2d& p : bench.marks().parts[2].borders_m[0])
    EXPECT_NEAR((p - Eigen::Vector2d(0.125, 0.125)).cwiseAbs().maxCoeff(), 0.025, 0.005) << "within a pixel";
  const auto drag = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    bench.point_at(from.x(), from.y());
    bench.controller->mouse_button(0, true, 0);
    bench.point_at(to.x(), to.y());
    bench.controller->mouse_button(0, false, 0);
    bench.run();
  };
  drag({0.08, 0.04}, {0.10, 0.05});
  EXPECT_TRUE(bench.saved.empty());
  ASSERT_FALSE(bench.spoken.empty());
  EXPECT_EQ(bench.spoken.back(), "This part is a polygon: its corners are changed in the configuration");
  const Eigen::Vector2d corner = bench.marks().parts[2].borders_m[0].front();
  drag(corner, corner + Eigen::Vector2d(0.01, 0.01));
  EXPECT_TRUE(bench.saved.empty());
  EXPECT_EQ(bench.spoken.back(), "This part is drawn in the label image: it is changed there");
  // A box beside them is edited, and they stay what they are.
  drag({0.18, 0.07}, {0.19, 0.08});
  ASSERT_EQ(bench.saved.size(), 1U);
  const auto& parts = bench.saved[0];
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_NEAR(parts[0].box_m[2], 0.19, 0.001);
  EXPECT_EQ(parts[1].polygon_m, scene->description().config.parts[1].polygon_m);
  EXPECT_EQ(parts[2].label, 3);
  EXPECT_FALSE(parts[1].is_box() || parts[2].is_box());
  // With a tool the click is the tool's; the part is removed only where it is pointed at.
  bench.key('U');
  bench.click(0.08, 0.04);
  EXPECT_EQ(bench.marks().pending_m.size(), 1U);
  bench.key(key::kEscape);
  bench.point_at(0.04, 0.09);
  bench.key(key::kDelete);
  ASSERT_EQ(bench.saved.size(), 2U);
  ASSERT_EQ(bench.saved[1].size(), 2U);
  EXPECT_EQ(bench.saved[1][1].name, "stalk");
}

TEST(Marking, AnEditedBoxInAFolderKeepsPolygonsAndLabels) {
  const sparsha::test::TestFolder folder;
  std::filesystem::create_directories(folder / "scene");
  const scene::ScenePointer drawn = with_shapes(folder / "labels.png");
  scene::SceneDescription scanned = drawn->description();
  scanned.config.scans.resize(1);
  scanned.config.scans[0].file = "scan.ply";
  scanned.sources = {{"scan.ply", "abc", 1}};
  scene::write_scene(*scene::with_description(drawn, scanned), folder / "scene");
  const scene::ScenePointer opened = scene::open_scene(folder / "scene");
  scene::SceneDescription description = opened->description();
  description.config.parts[0].box_m[2] = 0.19;
  scene::write_description(*scene::with_description(opened, description), folder / "scene");
  const scene::ScenePointer again = scene::open_scene(folder / "scene");
  const auto& parts = again->description().config.parts;
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].box_m[2], 0.19);
  EXPECT_EQ(parts[1].polygon_m, description.config.parts[1].polygon_m);
  EXPECT_EQ(parts[2].label, 3);
}

}  // namespace
}  // namespace sparsha::viewer::test
