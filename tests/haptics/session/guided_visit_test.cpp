// A whole visit without sight on a stone in memory.
#include <gtest/gtest.h>

#include "tests/support/guided_visit.h"
#include "tests/support/scenes.h"

namespace sparsha::haptics {
namespace {

using test::DiscStone;

scene::ScenePointer scene_of(const DiscStone& stone) {
  return sparsha::test::scene_of(
      [&](double x, double y) { return stone.height_m(x, y); }, 401, 1.0, 101, Eigen::Vector3d::Zero(),
      [&](scene::SceneDescription& d) {
        for (const test::Placed& part : stone.parts) {
          const Eigen::Vector2d& m = part.middle_m;
          d.config.parts.push_back({part.say, part.say, {m.x() - 0.05, m.y() - 0.05, m.x() + 0.05, m.y() + 0.05}});
        }
        d.config.guide = scene::GuideConfig{};
        d.config.guide->force_n = stone.guide_n;
        d.config.guide->speed_m_per_s = 0.1;
      });
}

TEST(WithoutSight, AVisitorFindsThreePartsByButtonsAndFollowsTheOutlineOfOneWithTheGuide) {
  const DiscStone stone;
  test::Visitor visitor(scene_of(stone));
  test::visit(visitor, stone);
}

}  // namespace
}  // namespace sparsha::haptics
