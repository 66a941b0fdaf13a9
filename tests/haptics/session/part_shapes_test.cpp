// Parts of any shape in a session: spoken where they are touched, gone to, led along.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "haptics/device/pointer/pointer_device.h"
#include "haptics/session/guide_line.h"
#include "haptics/session/navigator.h"
#include "haptics/session/session.h"
#include "haptics/state/stone_gives.h"
#include "scene/area/regions.h"
#include "tests/support/guided_hand.h"
#include "tests/support/part_scenes.h"
#include "tests/support/placed_hand.h"
#include "tests/support/servo_parts.h"
#include "tests/support/test_folder.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector2d;

test::Polygon polygon_of(const Vector2d& at_m) {
  test::Polygon corners;
  for (const auto& corner : test::el_m(0.03, at_m)) corners.emplace_back(corner[0], corner[1]);
  return corners;
}

const auto kAlongParts = [](scene::SceneDescription& d) {
  d.config.guide = scene::GuideConfig{};
  d.config.guide->path = scene::GuideConfig::Path::part;
};

/// Every place of the line is near the polygon's border, and every place of the border near the line.
void expect_along(const GuidePath& path, const test::Polygon& corners, double within_m) {
  test::Polygon line;
  for (std::size_t k = 0; k <= path.pieces(); ++k) line.emplace_back(path.corner(k).head<2>());
  for (const Vector2d& p : test::along(line, false, 0.0002))
    ASSERT_LE(test::distance_to(corners, true, p), within_m) << p.transpose();
  for (const Vector2d& p : test::along(corners, true, 0.0002))
    ASSERT_LE(test::distance_to(line, false, p), within_m) << p.transpose();
}

TEST(GuideAlongAPart, FollowsAPolygonsOwnEdges) {
  const test::TestFolder folder;
  const auto scene = test::els(folder / "labels.png", {}, kAlongParts);
  const GuideAnswer answer = find_guide({scene, 0, {0.09, 0.035, 0.0}, {}});
  ASSERT_NE(answer.guide, nullptr);
  EXPECT_EQ(answer.part, "Polygon") << "the nearer one";
  expect_along(answer.guide->path, polygon_of({0.06, 0.01}), 1e-12);
  EXPECT_NEAR(answer.guide->path.length_m(), 4.0 * 0.03, 1e-12);
}

TEST(GuideAlongAPart, FollowsALabelsPixels) {
  const test::TestFolder folder;
  const auto scene = test::els(folder / "labels.png", {}, kAlongParts);
  const GuideAnswer answer = find_guide({scene, 0, {0.01, 0.05, 0.0}, {}});
  ASSERT_NE(answer.guide, nullptr);
  EXPECT_EQ(answer.part, "Label");
  expect_along(answer.guide->path, polygon_of({0.01, 0.01}), 0.0005);  // a pixel
}

TEST(GuideAlongAPart, EndsWhereTheSceneEnds) {
  const test::TestFolder folder;
  const auto scene = test::els(folder / "labels.png", {}, [](scene::SceneDescription& d) {
    kAlongParts(d);
    d.config.parts[0].polygon_m = test::el_m(0.08, {0.05, 0.05});
    d.config.parts[1] = {"beyond", "Beyond", {}};
    d.config.parts[1].polygon_m = test::el_m(0.03, {0.2, 0.2});
  });
  const GuideAnswer answer = find_guide({scene, 0, {0.06, 0.06, 0.0}, 0});
  ASSERT_NE(answer.guide, nullptr);
  const test::Polygon left{{0.05, 0.05}, {0.1, 0.05}, {0.1, 0.082}, {0.082, 0.082}, {0.082, 0.1}, {0.05, 0.1}};
  expect_along(answer.guide->path, left, 1e-12);
  EXPECT_EQ(find_guide({scene, 0, {0.06, 0.06, 0.0}, 1}).guide, nullptr);
}

TEST(GuideAlongAPart, OfATurnedStoneStaysOnThePart) {
  const test::TestFolder folder;
  const auto scene = test::els(folder / "labels.png", {}, [](scene::SceneDescription& d) {
    kAlongParts(d);
    d.region_from_grid = Eigen::Matrix4d::Identity();  // by half a turn about the middle
    (*d.region_from_grid)(0, 0) = (*d.region_from_grid)(1, 1) = -1.0;
    (*d.region_from_grid)(0, 3) = (*d.region_from_grid)(1, 3) = 0.1;
  });
  for (const std::size_t part : {0U, 1U}) {
    test::Polygon turned = polygon_of({part == 0 ? 0.06 : 0.01, 0.01});
    for (Vector2d& corner : turned) corner = Vector2d(0.1, 0.1) - corner;
    const GuideAnswer answer = find_guide({scene, 0, {0.05, 0.05, 0.0}, part});
    ASSERT_NE(answer.guide, nullptr);
    expect_along(answer.guide->path, turned, 1.5 * 0.0005);
  }
}

TEST(GuideAlongAPart, LeadsAHandRoundAnL) {
  const test::TestFolder folder;
  const auto scene = test::els(folder / "labels.png", {}, [](scene::SceneDescription& d) {
    kAlongParts(d);
    d.config.parts[0].polygon_m = test::el_m(0.06, {0.02, 0.02});
  });
  const GuideAnswer answer = find_guide({scene, 0, {0.02, 0.02, 0.0}, 0});
  ASSERT_NE(answer.guide, nullptr);
  const HapticWindow window = load_window(*scene, plan_window(scene->description(), 0, {0.05, 0.05}, 0.1), 1);
  HapticRenderer renderer(DeviceInfo{}, RendererOptions{}, window);
  Command ask;
  ask.kind = Command::Kind::guide;
  ask.guide = answer.guide;
  static_cast<void>(renderer.apply(ask));
  std::vector<Vector2d> felt;
  const auto between = [&](int) { felt.emplace_back(renderer.state().hip_m[0], renderer.state().hip_m[1]); };
  test::run(renderer, {.start_m = {-0.03, -0.03}}, 12.0, 0.04, between);
  test::Polygon corners;
  for (const auto& corner : test::el_m(0.06, {0.02, 0.02})) corners.emplace_back(corner[0], corner[1]);
  const test::Polygon places = test::along(corners, true, 0.001);
  const auto covered = std::count_if(places.begin(), places.end(), [&](const Vector2d& place) {
    return std::any_of(felt.begin(), felt.end(), [&](const Vector2d& hand) { return (hand - place).norm() < 0.003; });
  });
  EXPECT_GE(static_cast<double>(covered), 0.95 * static_cast<double>(places.size()));
}

TEST(Parts, OfAnyShapeAreGoneToInsideThem) {
  const test::TestFolder folder;
  const auto scene = test::els(folder / "labels.png");
  AnnouncementBoard board;
  Announcer announcer(board, scene);
  Navigator navigator(scene, 0.1, Effects{}, announcer);
  for (const char* name : {"Polygon", "Label"}) {
    const auto job = navigator.wish({Request::Kind::next_part}, State{});
    ASSERT_TRUE(job);
    const Vector2d centre = job->command.centre_m.head<2>();
    const scene::PartConfig* part = scene::part_at(scene->description(), {centre.x(), centre.y(), 0.0});
    ASSERT_NE(part, nullptr) << centre.transpose();
    EXPECT_EQ(part->name, name);
    EXPECT_NE(board.since(0).back().text.find(name), std::string::npos);
  }
}

TEST(Parts, OfAnyShapeAreSpokenWhereTheyAreTouched) {
  const test::TestFolder folder;
  const auto scene = test::els(folder / "labels.png");
  Placed hand;
  Session session(scene, make_pointer_device(hand.place), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 100; }));
  const auto touch_until = [&](double x_m, double y_m, const auto& so) {
    return press_until(session, hand, x_m - 0.05, y_m - 0.05, so);
  };
  const auto felt_at = [&](double x_m, double y_m) {
    return [=, &session] {
      const State now = session.state().read();
      return stone_gives(now) && std::hypot(now.proxy_m[0] - x_m, now.proxy_m[1] - y_m) < 0.001;
    };
  };
  ASSERT_TRUE(touch_until(0.082, 0.032, felt_at(0.082, 0.032)));
  ASSERT_TRUE(touch_until(0.032, 0.032, felt_at(0.032, 0.032)));
  for (int k = 0; k < 20; ++k) session.poll();
  EXPECT_FALSE(said(session, "Polygon") || said(session, "Label")) << "in their notches";
  EXPECT_TRUE(touch_until(0.066, 0.032, [&] { return said(session, "Polygon"); }));
  EXPECT_FALSE(said(session, "Label"));
  EXPECT_TRUE(touch_until(0.016, 0.032, [&] { return said(session, "Label"); }));
  session.requests().post({Request::Kind::quit});
  ASSERT_TRUE(poll_until(session, [&] { return session.finished(); }));
  session.stop();
}

}  // namespace
}  // namespace sparsha::haptics
