// Clicks on a whole object that is turned: places are those of the side that is seen.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "tests/support/whole_scenes.h"
#include "tests/viewer/marks/marking_bench.h"

namespace sparsha::viewer::test {
namespace {

using Eigen::Vector3d;

constexpr double kRadius_m = 0.04;

/// A ball, and a mouse that points at places of it, however it is turned.
struct BallBench : MarkingBench {
  Stage stage;

  void turn(const Eigen::AngleAxisd& device_from_grid) {
    const Eigen::Quaterniond turn(device_from_grid);
    state.turn = {turn.x(), turn.y(), turn.z(), turn.w()};
    state.flags |= haptics::kFlagAround;
    state.tick = 1;
    run();
    stage = stage_of(scene->description(), state);
    ASSERT_LT((stage.turn - device_from_grid.toRotationMatrix()).norm(), 1e-9);
  }

  BallBench()
      : MarkingBench(
            sparsha::test::whole_scene(sparsha::test::ball_charts(kRadius_m, 0.001), 0.1,
                                       [](scene::SceneDescription& d) { d.config.around = scene::AroundConfig{}; })),
        stage(stage_of(scene->description())) {}

  void click_on(const Vector3d& grid_m, bool presses = true) {
    const auto pixel = view().to_pixel(stage.to_world(grid_m));
    ASSERT_TRUE(pixel);
    controller->mouse_move(layout().detail.x + pixel->x(), pixel->y(), layout(), view(), stage, slope);
    if (!presses) return;
    controller->mouse_button(0, true, 0);
    controller->mouse_button(0, false, 0);
    run();
  }
  /// A place of the ball before the visitor, as far right and up as said, of a ball that is turned.
  [[nodiscard]] Vector3d seen(double right_m, double up_m) const {
    const double near_m = std::sqrt(kRadius_m * kRadius_m - right_m * right_m - up_m * up_m);
    return stage.turn.transpose() * Vector3d(right_m, up_m, near_m);
  }
};

TEST(ObjectMarks, ADistanceIsThatOfThePlacesThatAreSeenHoweverTheObjectIsTurned) {
  for (const Eigen::AngleAxisd& turn :
       {Eigen::AngleAxisd(0.0, Vector3d::UnitY()), Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitY()),
        Eigen::AngleAxisd(2.0, Vector3d(1.0, -1.0, 0.5).normalized())}) {
    BallBench bench;
    bench.turn(turn);
    bench.key('U');
    const Vector3d a_m = bench.seen(-0.01, 0.005), b_m = bench.seen(0.015, -0.01);
    bench.click_on(a_m);
    bench.click_on(b_m);
    ASSERT_EQ(bench.marks().notes.measures.size(), 1U);
    const Measure& measure = bench.marks().notes.measures[0];
    EXPECT_LT((measure.points_m[0] - a_m).norm(), 0.0003);
    EXPECT_LT((measure.points_m[1] - b_m).norm(), 0.0003);
  }
}

TEST(ObjectMarks, APinLiesOnTheSideThatIsClickedAndIsHiddenWhereThatLooksAway) {
  BallBench bench;
  bench.turn(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitY()));
  const Vector3d behind_m = bench.seen(0.01, 0.01);
  ASSERT_LT(behind_m.z(), 0.0);
  bench.click_on(behind_m, false);
  bench.key('K');
  ASSERT_EQ(bench.marks().notes.pins.size(), 1U);
  EXPECT_LT((bench.marks().notes.pins[0].at_m - behind_m).norm(), 0.0003);
  bench.type("mark");
  bench.key(key::kEnter);
  ASSERT_EQ(bench.marks().pin_normals.size(), 1U);
  const Vector3d& normal = bench.marks().pin_normals[0];
  EXPECT_GT(normal.dot(behind_m.normalized()), 0.99);
  EXPECT_FALSE(looks_away(bench.view(), bench.stage, behind_m, normal));
  bench.turn(Eigen::AngleAxisd(0.0, Vector3d::UnitY()));
  EXPECT_TRUE(looks_away(bench.view(), bench.stage, behind_m, normal));
  // The same pixel of the front is not the pin's: nothing is removed there.
  bench.click_on(behind_m, false);
  bench.key(key::kDelete);
  EXPECT_EQ(bench.marks().notes.pins.size(), 1U);
  bench.turn(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitY()));
  bench.click_on(behind_m, false);
  bench.key(key::kDelete);
  EXPECT_TRUE(bench.marks().notes.pins.empty());
}

TEST(ObjectMarks, ProfilesAreOfOneView) {
  BallBench bench;
  for (const Tool tool : {Tool::distance, Tool::angle, Tool::none}) {
    bench.key('U');
    EXPECT_EQ(bench.marks().tool, tool);
  }
}

}  // namespace
}  // namespace sparsha::viewer::test
