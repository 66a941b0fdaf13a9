// Clicks and keys to measures, pins and sections, through the controller as the window feeds it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/files/files.h"
#include "scene/folder/folder.h"
#include "tests/support/part_scenes.h"
#include "tests/support/test_folder.h"
#include "tests/viewer/marks/marking_bench.h"

namespace sparsha::viewer::test {
namespace {

TEST(Marking, ADistanceBetweenTwoClicksIsThatOfThePlacesUnderThem) {
  MarkingBench bench(plate());
  bench.key('U');
  ASSERT_EQ(bench.marks().tool, Tool::distance);
  bench.click(0.05, 0.06);
  EXPECT_EQ(bench.marks().pending_m.size(), 1U);
  EXPECT_TRUE(bench.marks().notes.measures.empty());
  bench.click(0.15, 0.12);
  ASSERT_EQ(bench.marks().notes.measures.size(), 1U);
  // In space, on the tilted surface. A pixel is 0.2 m / 660.
  const double truth = std::sqrt(0.1 * 0.1 + 0.06 * 0.06 + 0.01 * 0.01);
  EXPECT_NEAR(value_of(bench.marks().notes.measures[0]), truth, 0.001);
  EXPECT_TRUE(std::ranges::any_of(bench.spoken, [](const std::string& words) { return words.starts_with("11."); }));
  bench.key('U');
  bench.click(0.10, 0.05);
  bench.click(0.05, 0.05);
  bench.click(0.05, 0.10);
  ASSERT_EQ(bench.marks().notes.measures.size(), 2U);
  EXPECT_NEAR(value_of(bench.marks().notes.measures[1]), 3.14159265358979 / 2.0, 0.02);
  // Delete removes what is pointed at.
  bench.point_at(0.15, 0.12);
  bench.key(key::kDelete);
  ASSERT_EQ(bench.marks().notes.measures.size(), 1U);
  EXPECT_EQ(bench.marks().notes.measures[0].kind, Measure::Kind::angle);
  bench.point_at(0.18, 0.18);
  bench.key(key::kDelete);
  EXPECT_EQ(bench.marks().notes.measures.size(), 1U) << "nothing is there";
}

TEST(Marking, AClickOfAToolNeitherPressesNorTurnsAndEscapeLeavesIt) {
  MarkingBench bench(plate());
  bench.key('U');
  const Camera before = bench.controller->frame().camera;
  bench.point_at(0.1, 0.1);
  bench.controller->mouse_button(0, true, 0);
  bench.point_at(0.12, 0.13);
  bench.controller->mouse_button(0, false, 0);
  bench.run();
  EXPECT_EQ(bench.controller->frame().camera.turn_rad, before.turn_rad);
  EXPECT_EQ(bench.marks().pending_m.size(), 1U);
  bench.key(key::kEscape);
  EXPECT_TRUE(bench.marks().pending_m.empty());
  EXPECT_EQ(bench.marks().tool, Tool::distance);
  bench.key(key::kEscape);
  EXPECT_EQ(bench.marks().tool, Tool::none);
  EXPECT_FALSE(bench.controller->wants_to_leave());
  bench.key(key::kEscape);
  EXPECT_TRUE(bench.controller->wants_to_leave());
}

TEST(Marking, ProfileComesFromTheFinestLevel) {
  MarkingBench bench(plate());
  for (int k = 0; k < 3; ++k) bench.key('U');
  bench.click(0.04, 0.05);
  bench.click(0.16, 0.05);
  ASSERT_FALSE(bench.marks().profile.empty());
  EXPECT_NEAR(static_cast<double>(bench.marks().profile.size()), 121.0, 2.0);
  for (const ProfileSample& s : bench.marks().profile) EXPECT_NEAR(s.at_m.z(), slope(s.at_m.x(), 0.0), 1e-8);
}

TEST(Marking, AClickWhereNothingWasMeasuredIsSaid) {
  MarkingBench bench(
      scene_of([](double x_m, double) { return x_m < 0.1 ? 0.1 * x_m : std::nan(""); }, {201, 201, 0.001, 1}));
  bench.key('U');
  bench.click(0.15, 0.1);
  EXPECT_TRUE(bench.marks().pending_m.empty());
  EXPECT_EQ(bench.spoken.back(), "Nothing was measured there");
}

TEST(Marking, APinKeepsWhatIsTypedAndNotTheKeyThatBeganIt) {
  MarkingBench bench(plate());
  bench.point_at(0.07, 0.13);
  bench.controller->press({'K'});
  bench.controller->type(U'k');  // comes with the key, before the next picture
  bench.run();
  ASSERT_TRUE(bench.marks().typing);
  EXPECT_EQ(*bench.marks().typing, "");
  bench.type("cracQ");
  bench.key('Q');  // while words are written, keys are theirs
  EXPECT_FALSE(bench.controller->wants_to_leave());
  bench.key(key::kBackspace);
  bench.type("k 3");
  bench.controller->type(U'\u0928');
  bench.key(key::kEnter);
  ASSERT_FALSE(bench.marks().typing);
  ASSERT_EQ(bench.marks().notes.pins.size(), 1U);
  EXPECT_EQ(bench.marks().notes.pins[0].text, "crack 3\xE0\xA4\xA8");
  EXPECT_NEAR(bench.marks().notes.pins[0].at_m.x(), 0.07, 0.001);
  EXPECT_NEAR(bench.marks().notes.pins[0].at_m.y(), 0.13, 0.001);
  // Without words there is no pin.
  bench.key('K');
  bench.key(key::kEnter);
  EXPECT_EQ(bench.marks().notes.pins.size(), 1U);
  bench.key('K');
  bench.type("x");
  bench.key(key::kEscape);
  EXPECT_EQ(bench.marks().notes.pins.size(), 1U);
  EXPECT_FALSE(bench.controller->wants_to_leave());
}

TEST(Marking, NotesAreKeptWithTheSceneInTheScansFrameAndComeBack) {
  const sparsha::test::TestFolder folder;
  Eigen::Matrix4d scan_from_grid = Eigen::Matrix4d::Identity();
  scan_from_grid.topLeftCorner<3, 3>() =
      Eigen::AngleAxisd(1.5707963267948966, Eigen::Vector3d::UnitX()).toRotationMatrix();
  scan_from_grid.topRightCorner<3, 1>() = Eigen::Vector3d(10.0, 20.0, 30.0);
  const auto turned = [&](scene::SceneDescription& d) {
    d.config.scans.resize(1);
    d.config.scans[0].file = "scan.ply";
    d.sources = {{"scan.ply", "abc", 1}};
    d.config.orientation.scan_to_grid = scan_from_grid.inverse();
    d.scan_from_grid = scan_from_grid;
  };
  std::filesystem::create_directories(folder / "scene");
  scene::write_scene(*plate(turned), folder / "scene");
  {
    MarkingBench bench(scene::open_scene(folder / "scene"));
    bench.point_at(0.05, 0.08);
    bench.key('K');
    bench.type("Nose");
    bench.key(key::kEnter);
    bench.key('Z');
    bench.key('I');
    for (int k = 0; k < 1; ++k) bench.key('U');
    bench.click(0.05, 0.06);
    bench.click(0.15, 0.12);
  }
  const Notes file = read_notes(folder / "scene" / "notes.yaml");
  ASSERT_EQ(file.pins.size(), 1U);
  // A quarter turn about x: (x, y, z) goes to (x, -z, y), then the shift.
  EXPECT_NEAR(file.pins[0].at_m.x(), 10.05, 0.001);
  EXPECT_NEAR(file.pins[0].at_m.y(), 20.0 - 0.005, 0.001);
  EXPECT_NEAR(file.pins[0].at_m.z(), 30.08, 0.001);
  EXPECT_TRUE(file.parallel);
  EXPECT_TRUE(file.section);
  MarkingBench again(scene::open_scene(folder / "scene"));
  ASSERT_EQ(again.marks().notes.pins.size(), 1U);
  EXPECT_NEAR(again.marks().notes.pins[0].at_m.x(), 0.05, 0.001);
  EXPECT_NEAR(again.marks().notes.pins[0].at_m.y(), 0.08, 0.001);
  ASSERT_EQ(again.marks().notes.measures.size(), 1U);
  EXPECT_TRUE(again.marks().notes.section);
  EXPECT_EQ(again.controller->frame().camera.field_rad, 0.0) << "parallel, as it was left";
  // A depth scan of the same scans from another side lies in no folder: the notes stay on the object.
  const auto other = [&](scene::SceneDescription& d) {
    turned(d);
    d.scan_from_grid = Eigen::Matrix4d::Identity();
    d.scan_from_grid.topRightCorner<3, 1>() = Eigen::Vector3d(10.0, 20.0, 30.0);
  };
  again.controller->set_scene(plate(other));
  again.run();
  ASSERT_EQ(again.marks().notes.pins.size(), 1U);
  EXPECT_NEAR(again.marks().notes.pins[0].at_m.z(), 0.08, 0.001);
  EXPECT_NEAR(again.marks().notes.pins[0].at_m.y(), -0.005, 0.001);
  again.controller->set_scene(plate());
  again.run();
  EXPECT_TRUE(again.marks().notes.empty()) << "another object has none of them";
}

TEST(Marking, NotesMadeAfterANewDepthScanAreKeptInTheFolderOfTheScans) {
  const sparsha::test::TestFolder folder;
  const auto of_scans = [](scene::LengthUnit unit, double shift_m) {
    return [=](scene::SceneDescription& d) {
      d.config.scans.resize(1);
      d.config.scans[0].file = "scan.ply";
      d.config.scans[0].units.unit = unit;
      d.sources = {{"scan.ply", "abc", 1}};
      d.scan_from_grid(0, 3) = shift_m;
      d.config.orientation.scan_to_grid = d.scan_from_grid.inverse();
    };
  };
  std::filesystem::create_directories(folder / "scene");
  scene::write_scene(*plate(of_scans(scene::LengthUnit::mm, 1.0)), folder / "scene");
  MarkingBench bench(scene::open_scene(folder / "scene"));
  const auto pin = [&](double x_m, double y_m, const char* words) {
    bench.point_at(x_m, y_m);
    bench.key('K');
    bench.type(words);
    bench.key(key::kEnter);
  };
  const auto set = [&](const scene::ScenePointer& scene) {
    bench.controller->set_scene(bench.scene = scene);
    bench.run();
  };
  pin(0.05, 0.08, "before");
  set(plate(of_scans(scene::LengthUnit::mm, 3.0)));  // from another side
  pin(0.15, 0.08, "after");
  const auto file = [&] { return read_notes(folder / "scene" / "notes.yaml").pins; };
  ASSERT_EQ(file().size(), 2U);
  const double pixel_m = 0.001;
  EXPECT_NEAR(file()[0].at_m.x(), 1.05, pixel_m);
  EXPECT_NEAR(file()[1].at_m.x(), 3.15, pixel_m);
  // The same numbers read in centimetres: ten times as large, the file stays in the folder's own unit.
  set(plate(of_scans(scene::LengthUnit::cm, 30.0)));
  ASSERT_EQ(bench.marks().notes.pins.size(), 2U);
  EXPECT_NEAR(bench.marks().notes.pins[1].at_m.x(), 10.0 * 3.15 - 30.0, 10.0 * pixel_m);
  pin(0.05, 0.05, "last");
  ASSERT_EQ(file().size(), 3U);
  EXPECT_NEAR(file()[0].at_m.x(), 1.05, pixel_m);
  EXPECT_NEAR(file()[2].at_m.x(), 3.005, pixel_m);
  set(plate());
  pin(0.05, 0.05, "of another object");
  EXPECT_EQ(file().size(), 3U) << "notes of another object are not kept there";
}

TEST(Marking, NotesThatCannotBeReadAreSaidAndNotWrittenOver) {
  const sparsha::test::TestFolder folder;
  std::filesystem::create_directories(folder / "scene");
  scene::write_scene(*plate([](scene::SceneDescription& d) {
    d.config.scans.resize(1);
    d.config.scans[0].file = "scan.ply";
    d.sources = {{"scan.ply", "abc", 1}};
  }),
                     folder / "scene");
  write_file(folder / "scene" / "notes.yaml", "pins: broken\n");
  MarkingBench bench(scene::open_scene(folder / "scene"));
  ASSERT_FALSE(bench.spoken.empty());
  EXPECT_NE(bench.spoken.front().find("notes.yaml:1"), std::string::npos) << bench.spoken.front();
  bench.key('Z');
  EXPECT_EQ(read_file(folder / "scene" / "notes.yaml", 1000), "pins: broken\n");
  bench.controller->set_scene(plate([](scene::SceneDescription& d) {
    d.config.scans.resize(1);
    d.sources = {{"scan.ply", "abc", 1}};
  }));
  bench.key('Z');
  EXPECT_EQ(read_file(folder / "scene" / "notes.yaml", 1000), "pins: broken\n") << "nor after a new depth scan";
}

TEST(Marking, TheSectionPlaneLiesAlongTheNewestProfileAndMoves) {
  MarkingBench bench(plate());
  for (int k = 0; k < 3; ++k) bench.key('U');
  bench.click(0.04, 0.05);
  bench.click(0.16, 0.11);
  bench.key('Z');
  ASSERT_TRUE(bench.marks().notes.section);
  Section section = *bench.marks().notes.section;
  EXPECT_LT(section.out.y(), 0.0) << "what lies towards the viewer is left out";
  EXPECT_NEAR(section.out.dot(Eigen::Vector3d(0.12, 0.06, 0.0).normalized()), 0.0, 0.01);
  bench.key('Y');
  const Section moved = *bench.marks().notes.section;
  EXPECT_LT((moved.at_m - section.at_m).dot(section.out), 0.0);
  bench.key('Y', kShift);
  EXPECT_NEAR((bench.marks().notes.section->at_m - section.at_m).norm(), 0.0, 1e-12);
  bench.key('Z', kShift);
  EXPECT_NEAR(std::acos(bench.marks().notes.section->out.dot(section.out)), 3.14159265358979 / 12.0, 1e-9);
  bench.key('Z');
  EXPECT_FALSE(bench.marks().notes.section);
}

TEST(Contours, StepsAreRoundAndEndInNone) {
  double step_m = next_contour_m(0.0, 0.1, true);
  EXPECT_DOUBLE_EQ(step_m, 0.005);
  std::set<double> steps;
  for (int k = 0; k < 30; ++k) {
    EXPECT_TRUE(steps.insert(step_m).second || k > 6) << step_m;
    const double mantissa = step_m / std::pow(10.0, std::floor(std::log10(step_m) + 1e-9));
    EXPECT_TRUE(std::abs(mantissa - 1) < 1e-6 || std::abs(mantissa - 2) < 1e-6 || std::abs(mantissa - 5) < 1e-6)
        << step_m;
    step_m = next_contour_m(step_m, 0.1, true);
  }
  EXPECT_DOUBLE_EQ(step_m, 5e-5) << "the finest is a two-thousandth of the range";
  step_m = 0.005;
  EXPECT_DOUBLE_EQ(step_m = next_contour_m(step_m, 0.1, false), 0.01);
  EXPECT_DOUBLE_EQ(step_m = next_contour_m(step_m, 0.1, false), 0.02);
  EXPECT_DOUBLE_EQ(step_m = next_contour_m(step_m, 0.1, false), 0.05);
  EXPECT_DOUBLE_EQ(step_m = next_contour_m(step_m, 0.1, false), 0.0);
  EXPECT_DOUBLE_EQ(next_contour_m(0.0, 0.1, false), 0.0);
  EXPECT_DOUBLE_EQ(next_contour_m(0.0, 0.0, true), 0.0);
  EXPECT_DOUBLE_EQ(next_contour_m(0.0, std::nan(""), true), 0.0);
}

}  // namespace
}  // namespace sparsha::viewer::test
