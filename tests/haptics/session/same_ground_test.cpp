// A scene whose labels were edited: the hand stays where it is, in the same window, and feels no step.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "haptics/device/pointer/pointer_device.h"
#include "haptics/session/navigator.h"
#include "haptics/session/session.h"
#include "tests/support/changing_scenes.h"
#include "tests/support/servo_parts.h"
#include "tests/support/test_folder.h"

namespace sparsha::haptics {
namespace {

using scene::ScenePointer;
using sparsha::test::Table;

/// Without invented forces, so that a hand at rest feels the surface alone.
ScenePointer plain_stone() {
  return sparsha::test::stone(401, [](scene::SceneDescription& d) {
    d.config.haptics.impact = d.config.haptics.grain = false;
    d.config.cues.reset();
    d.config.parts.clear();
  });
}

/// The same with one part under the hand.
ScenePointer with_part(const ScenePointer& scene, const scene::PartTouch& touch) {
  scene::SceneDescription description = scene->description();
  scene::PartConfig part;
  part.name = part.say = "Under the hand";
  part.box_m = {2.0, -3.0, 2.1, -2.9};
  part.touch = touch;
  description.config.parts = {part};
  return scene::with_description(scene, std::move(description));
}

TEST(SameGround, ANavigatorKeepsWindowAndLevelAndOnlyAnotherStoneIsShownWhole) {
  AnnouncementBoard board;
  const ScenePointer first = plain_stone();
  Announcer announcer(board, first);
  constexpr double kWorkspace_m = 0.1;
  Navigator navigator(first, kWorkspace_m, {}, announcer);
  const ZoomStep near = zoom_steps(first->description(), kWorkspace_m).back();
  const WindowPlan before = plan_window(first->description(), near, {2.03, -2.96}, kWorkspace_m);
  navigator.settle(before);

  const ScenePointer edited = with_part(first, {});
  const WindowLoader::Job kept = navigator.change_scene(edited);
  EXPECT_EQ(kept.scene, edited);
  EXPECT_FALSE(kept.command.move) << "what lies under the hand stays under it";
  for (const auto member :
       {&WindowPlan::level, &WindowPlan::i0, &WindowPlan::j0, &WindowPlan::nx, &WindowPlan::ny, &WindowPlan::nodes})
    EXPECT_EQ(kept.plan.*member, before.*member);
  EXPECT_EQ(kept.plan.scale, before.scale);
  EXPECT_EQ(navigator.part(), std::nullopt) << "the list of parts is another one";

  const ScenePointer other = sparsha::test::scanned_anew(301, 0.0);
  const WindowLoader::Job whole = navigator.change_scene(other);
  EXPECT_TRUE(whole.command.move);
  EXPECT_EQ(whole.plan.level, navigator.first_plan().level);
  EXPECT_EQ(whole.command.centre_m, middle_of(other->description().levels.front()));
}

/// A hand that rests in the stone while scenes change under it, recorded.
class RestingInTheStone : public ::testing::Test {
 protected:
  bool poll_until(Session& session, const std::function<bool(const State&)>& so) {
    return eventually([&] {
      session.poll();
      return so(session.state().read());
    });
  }
  /// Zooms in, presses 3 mm deep and gives one scene after the other, half a second each.
  Table rest_on(const ScenePointer& first, const std::vector<ScenePointer>& others) {
    const auto hand = std::make_shared<Seqlock<PointerSample>>();
    hand->publish({{0.01, 0.005, 0.02}, 0, 1});
    SessionOptions options = sparsha::test::options_of(first, folder_ / "run.csv");
    Session session(first, make_pointer_device(hand), options);
    session.start();
    session.requests().post({Request::Kind::zoom_in});
    EXPECT_TRUE(poll_until(session, [](const State& now) { return now.level == 1; }));
    wait(session, 0.3);  // forces begin in the air
    hand->publish({{0.01, 0.005, -0.003}, 0, 2});
    EXPECT_TRUE(poll_until(session, [](const State& now) { return now.commanded_force_n[2] > 0.5; }));
    for (const ScenePointer& scene : others) {
      wait(session, 0.7);
      session.set_scene(scene);
    }
    wait(session, 0.7);
    session.stop();
    return Table(folder_ / "run.csv");
  }
  void wait(Session& session, double duration_s) {
    const double until_s = session.state().read().time_s + duration_s;
    EXPECT_TRUE(poll_until(session, [&](const State& now) { return now.time_s > until_s; }));
  }
  static double force_n(const Table& rows, std::size_t row, const char* axis) {
    return rows.number(row, std::string("commanded_force_") + axis + "_n");
  }
  static double step_n(const Table& rows, std::size_t row) {
    double squared = 0.0;
    for (const char* axis : {"x", "y", "z"}) {
      const double step = force_n(rows, row, axis) - force_n(rows, row - 1, axis);
      squared += step * step;
    }
    return std::sqrt(squared);
  }
  /// The first rows of the scenes that were given later.
  static std::vector<std::size_t> changes(const Table& rows) {
    std::vector<std::size_t> found;
    for (std::size_t row = 1; row < rows.size(); ++row)
      if (rows.at(row, "scene") != rows.at(row - 1, "scene")) found.push_back(row);
    return found;
  }

  const test::TestFolder folder_;
};

TEST_F(RestingInTheStone, EditedLabelsMoveNeitherWindowNorForce) {
  const ScenePointer first = plain_stone();
  const Table rows = rest_on(first, {with_part(first, {}), with_part(first, {}), first});
  const std::vector<std::size_t> at = changes(rows);
  ASSERT_EQ(at.size(), 3U);
  double largest_n = 0.0;
  for (const std::size_t change : at) {
    for (const char* name : {"level", "scale", "window_i", "window_j", "window_nx", "window_ny"})
      EXPECT_EQ(rows.at(change, name), rows.at(change - 1, name)) << name;
    for (const char* name : {"centre_x_m", "centre_y_m", "centre_z_m"})
      EXPECT_NEAR(rows.number(change, name), rows.number(change - 1, name), 1e-12) << name;
    EXPECT_GT(std::abs(force_n(rows, change - 1, "z")), 0.5) << "the hand does press";
    for (std::size_t row = change; row < std::min(change + 400, rows.size()); ++row)
      largest_n = std::max(largest_n, step_n(rows, row));
  }
  // Governor and pointer come to rest exponentially; what is left of that after 0.7 s is below a thousandth of a
  // newton.
  EXPECT_LE(largest_n, 0.001);
  std::printf("largest step of the force after an edit of labels: %.2g N a tick\n", largest_n);
}

TEST_F(RestingInTheStone, APartThatBecomesSoftAndSmoothUnderTheHandIsFeltWithoutAStep) {
  const ScenePointer first = plain_stone();
  scene::PartTouch soft;
  soft.stiffness_n_per_m = 300.0;
  soft.mu_dynamic = 0.02;
  soft.mu_static = 0.02;
  const Table rows = rest_on(first, {with_part(first, soft), first});
  const std::vector<std::size_t> at = changes(rows);
  ASSERT_EQ(at.size(), 2U);
  double largest_n = 0.0;
  for (const std::size_t change : at)
    for (std::size_t row = change; row < std::min(change + 600, rows.size()); ++row)
      largest_n = std::max(largest_n, step_n(rows, row));
  EXPECT_LE(largest_n, 0.05) << "per tick";
  EXPECT_NEAR(rows.number(at[1] - 1, "stiffness_n_per_m"), 300.0, 1.0);
  EXPECT_GT(rows.number(at[0] - 1, "stiffness_n_per_m"), 700.0);
  EXPECT_GT(rows.number(rows.size() - 1, "stiffness_n_per_m"), 700.0) << "and hard again";
  std::printf("largest step of the force after an edit of touch: %.2g N a tick\n", largest_n);
}

}  // namespace
}  // namespace sparsha::haptics
