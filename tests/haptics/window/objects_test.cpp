// Whole objects as windows get them: friction and envelope of every side.
#include "haptics/window/objects.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "haptics/around/around_proxy.h"
#include "scene/area/regions.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;

constexpr double kBall_m = 0.04;

/// A ball whose texture bends by 100/m where x > 0, and lies 0.2 mm before its envelope there.
scene::Charts half_rough_ball() {
  scene::Charts charts = sparsha::test::ball_charts(kBall_m);
  for (scene::Sheet& sheet : charts.sheets) {
    sheet.texture_m.assign(sheet.count(), std::nanf(""));
    sheet.curvature_per_m = sheet.texture_m;
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        const std::size_t node = sheet.index(i, j);
        if (!sheet.measured(node)) continue;
        const bool rough = charts.place_m(sheet, i, j).x() > 0.0;
        sheet.texture_m[node] = rough ? 2e-4F : 0.0F;
        sheet.curvature_per_m[node] = rough ? 100.0F : 0.0F;
      }
  }
  return charts;
}

scene::ScenePointer rough_scene() {
  return sparsha::test::whole_scene(half_rough_ball(), 0.1, [](scene::SceneDescription& d) {
    d.config.around = scene::AroundConfig{};
    d.config.friction = scene::FrictionConfig{};
    d.config.friction->mu_0 = 0.1;
    d.config.friction->mu_static = 0.3;
    d.friction_c_m = 0.004;
    scene::PartConfig part;
    part.name = "back";
    part.solid_m = {-0.01, -0.01, -0.05, 0.0, 0.01, -0.03};
    part.touch.mu_dynamic = 0.8;
    d.config.parts.push_back(part);
  });
}

AroundUpdate touched(const ObjectSurface& object, const Vector3d& direction) {
  AroundState state;
  AroundUpdate found;
  for (double r = 1.05; r > 0.97; r -= 0.005)
    found = update_around(object, r * kBall_m * direction.normalized() - object.origin_m, state, {});
  return found;
}

TEST(WholeObjects, FrictionFollowsTheCurvatureOfTheTextureOnEverySide) {
  const auto scene = rough_scene();
  const auto object = whole_object(scene->description(), {});
  for (const Vector3d& across : {Vector3d(0, 0, 1), Vector3d(0, 1, 0), Vector3d(0, -1, 0), Vector3d(0, 0.6, -0.8)}) {
    const AroundUpdate smooth = touched(*object, across - 0.4 * Vector3d::UnitX());
    const AroundUpdate rough = touched(*object, across + 0.4 * Vector3d::UnitX());
    ASSERT_TRUE(smooth.contact && rough.contact);
    EXPECT_NEAR(smooth.mu_dynamic, 0.1, 1e-6);
    EXPECT_NEAR(rough.mu_dynamic, 0.1 + 0.004 * 100.0, 1e-6);
    EXPECT_NEAR(smooth.mu_static, 0.3, 1e-6);
    EXPECT_NEAR(rough.mu_static, 0.5, 1e-6) << "never less than in motion";
  }
  EXPECT_NEAR(touched(*object, {1, 0, 0}).mu_dynamic, 0.5, 1e-6);
  EXPECT_NEAR(touched(*object, {-1, 0, 0}).mu_dynamic, 0.1, 1e-6);
  const auto slippery = whole_object(scene->description(), {true, false});
  EXPECT_EQ(touched(*slippery, {1, 0, 0}).mu_dynamic, 0.0);
}

TEST(WholeObjects, APartInABoxOfSpaceHasItsOwnFrictionOnItsSideAlone) {
  const auto scene = rough_scene();
  const auto object = whole_object(scene->description(), {});
  EXPECT_NEAR(touched(*object, {-0.1, 0.0, -1.0}).mu_dynamic, 0.8, 1e-6);
  EXPECT_NEAR(touched(*object, {-0.1, 0.0, 1.0}).mu_dynamic, 0.1, 1e-6) << "the front of the same place";
  EXPECT_NEAR(touched(*object, {-0.1, 0.5, -1.0}).mu_dynamic, 0.1, 1e-6) << "above it";
}

TEST(WholeObjects, WithoutTextureTheEnvelopeIsTouched) {
  const auto scene = rough_scene();
  const auto object = whole_object(scene->description(), {false, true});
  for (const Vector3d& across : {Vector3d(0, 0, 1), Vector3d(0, 1, 0), Vector3d(0, 0.3, -1)}) {
    const Vector3d smooth = touched(*object, across - 0.5 * Vector3d::UnitX()).position_m + object->origin_m;
    const Vector3d rough = touched(*object, across + 0.5 * Vector3d::UnitX()).position_m + object->origin_m;
    EXPECT_NEAR(smooth.norm(), kBall_m, 2e-5);
    EXPECT_NEAR(rough.norm(), kBall_m - 2e-4, 2e-5);
  }
  EXPECT_TRUE(has_envelope(*scene->description().charts));
  EXPECT_FALSE(has_envelope(sparsha::test::ball_charts(kBall_m)));
}

}  // namespace
}  // namespace sparsha::haptics
