// Keys and mouse to the setup of the depth scan.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "tests/viewer/cloud/points.h"
#include "viewer/cloud/controller.h"

namespace sparsha::viewer::test {
namespace {

struct Bench {
  Workshop workshop{square(120, 1.0)};
  CloudController controller{workshop.orienting()};
  double time_s = 0.0;

  Bench() { rest(); }
  void rest() {
    for (int k = 0; k < 3; ++k) controller.update(time_s += 1.0, 800, 600, true);
  }
  const CloudFrame& frame() { return controller.frame(); }
};

TEST(CloudController, EveryActionHasAKeyAndNoKeyHasTwo) {
  std::set<CloudAction> reached;
  for (const int modifiers : {0, kShift, kControl, kControl | kShift})
    for (int key = 0; key < 300; ++key)
      if (const auto action = cloud_action_of({key, modifiers, false})) reached.insert(*action);
  for (const CloudActionInfo& info : all_cloud_actions()) EXPECT_TRUE(reached.contains(info.action)) << info.label;
}

TEST(CloudController, EnterScansWhatIsSeen) {
  Bench bench;
  bench.controller.press({'5'});
  bench.controller.press({key::kLeft});
  bench.rest();
  bench.controller.press({key::kEnter});
  ASSERT_EQ(bench.workshop.scans.size(), 1U);
  EXPECT_EQ(bench.workshop.scans[0].scan_to_grid, bench.frame().setup.scan_to_grid);
  const Eigen::Matrix4d truth =
      turned(seen_from(Face::top, false, Eigen::Matrix4d::Identity()), false, -5.0 * std::numbers::pi / 180.0, 0.0);
  EXPECT_TRUE(bench.workshop.scans[0].scan_to_grid.isApprox(truth, 1e-12));
}

TEST(CloudController, AnyAxisOfTheScanCanPointUpByKeyAndByList) {
  Bench bench;
  EXPECT_EQ(all_up_axes().size(), 6U);
  (void)bench.controller.take_words();
  bench.controller.press({'Y'});  // y by custom; z is the next
  const Eigen::Matrix4d z_up = bench.frame().setup.scan_to_grid;
  EXPECT_TRUE(z_up.row(1).head<3>().transpose().isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  EXPECT_TRUE(z_up.row(2).head<3>().transpose().isApprox(-Eigen::Vector3d::UnitY(), 1e-12));
  EXPECT_EQ(bench.controller.take_words(), std::vector<std::string>{"Up axis: z"});
  bench.controller.set_up(UpAxis(0, true));
  bench.controller.press({key::kLeft});  // a turntable about that axis
  const Eigen::Vector3d up = bench.frame().setup.scan_to_grid.row(1).head<3>();
  EXPECT_TRUE(up.isApprox(-Eigen::Vector3d::UnitX(), 1e-12));
  EXPECT_EQ(bench.controller.take_words().front(), "Up axis: -x");
}

TEST(CloudController, WorkIsNotStartedTwiceAndEscapeStopsIt) {
  Bench bench;
  bench.workshop.status.busy = true;
  bench.rest();
  bench.controller.press({key::kEnter});
  bench.controller.press({'S', kControl});
  bench.controller.press({'7'});
  EXPECT_TRUE(bench.workshop.scans.empty());
  EXPECT_TRUE(bench.workshop.saves.empty());
  EXPECT_TRUE(bench.workshop.faces.empty());
  bench.controller.press({key::kEscape});
  EXPECT_EQ(bench.workshop.cancelled, 1);
  EXPECT_EQ(bench.controller.take_wish(), CloudController::Wish::none);
  bench.workshop.status.busy = false;
  bench.rest();
  bench.controller.press({key::kEscape});
  EXPECT_EQ(bench.controller.take_wish(), CloudController::Wish::back);
  bench.controller.press({'8'});
  ASSERT_EQ(bench.workshop.faces.size(), 1U);
  EXPECT_EQ(bench.workshop.faces[0], scene::OrientationConfig::Face::principal);
}

TEST(CloudController, ControlSKeepsTheDepthScanAndBeforeTheFirstTheOrientation) {
  Bench bench;
  bench.controller.press({'S', kControl});
  EXPECT_EQ(bench.workshop.saves.size(), 1U);
  EXPECT_EQ(bench.workshop.saved_scenes, 0);
  bench.workshop.status.can_save_scene = true;
  bench.rest();
  bench.controller.press({'S', kControl});
  EXPECT_EQ(bench.workshop.saves.size(), 1U);
  EXPECT_EQ(bench.workshop.saved_scenes, 1);
  bench.controller.press({'S', kControl | kShift});
  EXPECT_EQ(bench.workshop.saves.size(), 2U) << "the orientation by itself";
  bench.workshop.status.busy = true;
  bench.rest();
  bench.controller.press({'S', kControl});
  EXPECT_EQ(bench.workshop.saved_scenes, 1);
}

TEST(CloudController, AnEscapeThatComesTooLateToStopDoesNotLeave) {
  Bench bench;
  const auto see = [&](double seconds) { bench.controller.update(bench.time_s += seconds, 800, 600, false); };
  bench.workshop.status.busy = true;
  see(0.02);
  bench.workshop.status.busy = false;
  see(0.02);
  EXPECT_FALSE(bench.controller.rests()) << "time goes on";
  bench.controller.press({key::kEscape});
  EXPECT_EQ(bench.controller.take_wish(), CloudController::Wish::none);
  see(kLateStop_s + 0.02);
  EXPECT_TRUE(bench.controller.rests());
  bench.controller.press({key::kEscape});
  EXPECT_EQ(bench.controller.take_wish(), CloudController::Wish::quit);
}

TEST(CloudController, TheFirstViewIsTakenOverUnlessSomebodyHasTurnedTheObject) {
  for (const bool turned_before : {false, true}) {
    Bench bench;
    if (turned_before) bench.controller.press({key::kRight});
    const Eigen::Matrix4d mine = bench.frame().setup.scan_to_grid;
    bench.workshop.status.proposal.scan_to_grid = seen_from(Face::back, true, mine);
    bench.workshop.status.proposals = 1;
    bench.rest();
    EXPECT_EQ(bench.frame().setup.scan_to_grid, turned_before ? mine : bench.workshop.status.proposal.scan_to_grid);
    // A face that was asked for is always taken.
    bench.workshop.status.proposal.scan_to_grid = seen_from(Face::top, true, mine);
    bench.workshop.status.proposals = 2;
    bench.rest();
    EXPECT_EQ(bench.frame().setup.scan_to_grid, bench.workshop.status.proposal.scan_to_grid);
  }
}

TEST(CloudController, ADragTurnsAndUndoGoesBackToBefore) {
  Bench bench;
  const Eigen::Matrix4d before = bench.frame().setup.scan_to_grid;
  bench.controller.mouse_move(400.0, 300.0);
  bench.controller.mouse_button(0, true, 0);
  for (int k = 1; k <= 20; ++k) bench.controller.mouse_move(400.0 + 10.0 * k, 300.0 + 3.0 * k);
  bench.controller.mouse_button(0, false, 0);
  bench.controller.mouse_move(100.0, 100.0);
  EXPECT_FALSE(bench.frame().setup.scan_to_grid.isApprox(before, 0.1));
  bench.controller.press({'Z', kControl});
  EXPECT_EQ(bench.frame().setup.scan_to_grid, before) << "the whole gesture is undone";
}

TEST(CloudController, ADragToTheRightMovesTheNearSideToTheRight) {
  for (const bool ball : {false, true}) {
    Bench bench;
    if (ball) bench.controller.press({'B'});
    const auto near = [&] {  // the x in the picture of the point that was nearest to the viewer
      return (bench.frame().setup.scan_to_grid * Eigen::Vector4d(0, 0, 1, 1)).x();
    };
    bench.controller.mouse_move(400.0, 300.0);
    bench.controller.mouse_button(0, true, 0);
    bench.controller.mouse_move(440.0, 300.0);
    EXPECT_GT(near(), 0.1) << ball;
    bench.controller.mouse_move(440.0, 340.0);
    EXPECT_LT((bench.frame().setup.scan_to_grid * Eigen::Vector4d(0, 0, 1, 1)).y(), -0.1) << "down";
  }
}

TEST(CloudController, MovingThePictureKeepsThePlaceUnderTheMouse) {
  Bench bench;
  bench.controller.press({'U'});
  bench.controller.press({key::kUp});
  bench.rest();
  const Eigen::Vector3d place(0.2, 0.1, 0.0);
  const Eigen::Vector3d before = bench.frame().view.to_pixel(place);
  bench.controller.mouse_move(before.x(), before.y());
  bench.controller.mouse_button(1, true, 0);
  bench.controller.mouse_move(before.x() + 37.0, before.y() - 21.0);
  const Eigen::Vector3d after = bench.frame().view.to_pixel(place);
  EXPECT_NEAR(after.x() - before.x(), 37.0, 1e-6);
  EXPECT_NEAR(after.y() - before.y(), -21.0, 1e-6);
}

TEST(CloudController, ACropHandleMovesOneFaceAsFarAsTheMouse) {
  Bench bench;
  bench.controller.press({'K'});
  ASSERT_TRUE(bench.frame().setup.crop);
  const scene::CropConfig before = *bench.frame().setup.crop;
  EXPECT_NEAR(before.max_m.x(), 0.5, 0.01);
  const auto handle = bench.controller.crop_handle(1);
  ASSERT_TRUE(handle);
  EXPECT_FALSE(bench.controller.crop_handle(5)) << "its axis points at the viewer";
  bench.controller.mouse_move(handle->x() + 2.0, handle->y());
  bench.controller.mouse_button(0, true, 0);
  const double by_m = 0.25;
  bench.controller.mouse_move(handle->x() + 2.0 - by_m * bench.frame().view.pixels_per_m, handle->y() + 40.0);
  bench.controller.mouse_button(0, false, 0);
  const scene::CropConfig after = *bench.frame().setup.crop;
  EXPECT_NEAR(after.max_m.x(), before.max_m.x() - by_m, 1e-9);
  EXPECT_EQ(after.min_m, before.min_m);
  EXPECT_EQ(after.max_m.tail<2>(), before.max_m.tail<2>());
  bench.rest();
  EXPECT_NEAR(bench.frame().preview.size_m().x(), 0.75, 0.02) << "the preview follows";
  bench.controller.press({key::kEnter});
  ASSERT_EQ(bench.workshop.scans.size(), 1U);
  EXPECT_EQ(bench.workshop.scans[0].crop->max_m, after.max_m);
}

TEST(CloudController, ABoxWithoutPointsIsNotScanned) {
  Bench bench;
  bench.controller.set_crop(scene::CropConfig{{7, 7, 7}, {8, 8, 8}});
  bench.rest();
  bench.controller.press({key::kEnter});
  EXPECT_TRUE(bench.workshop.scans.empty());
  const auto words = bench.controller.take_words();
  ASSERT_FALSE(words.empty());
  EXPECT_NE(words.back().find("crop box"), std::string::npos);
}

TEST(CloudController, AnotherUnitTakesTheCropBoxAlong) {
  Bench bench;
  bench.controller.press({'K'});
  const Eigen::Vector3d before = bench.frame().setup.crop->max_m;
  bench.controller.set_unit(scene::LengthUnit::mm);
  ASSERT_EQ(bench.workshop.units.size(), 1U);
  Workshop smaller(square(120, 0.001));
  smaller.points->metres_per_unit = 0.001;
  bench.workshop.status.points = smaller.points;
  bench.rest();
  EXPECT_TRUE(bench.frame().setup.crop->max_m.isApprox(0.001 * before, 1e-9));
  EXPECT_TRUE(bench.frame().preview.any);
  // Other scans: their box is their own, whatever unit was shown before.
  ++bench.workshop.status.work;
  bench.workshop.status.points = nullptr;
  bench.rest();
  bench.controller.set_crop(scene::CropConfig{{1, 1, 1}, {2, 2, 2}});
  Workshop metric(square(50, 1.0));
  bench.workshop.status.points = metric.points;
  bench.rest();
  EXPECT_TRUE(bench.frame().setup.crop->max_m.isApprox(Eigen::Vector3d(2, 2, 2), 1e-9));
}

}  // namespace
}  // namespace sparsha::viewer::test
