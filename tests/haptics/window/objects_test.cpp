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

/// A strip of 61 x 11 nodes in two parts, the right one 10 cells higher: by its texture, so that the envelope is flat.
scene::Charts stepped_strip() {
  scene::Charts charts;
  charts.spacing_m = 0.001;
  scene::Sheet sheet;
  sheet.side = scene::Side::front;
  sheet.nx = 61;
  sheet.ny = 11;
  for (int j = 0; j < sheet.ny; ++j)
    for (int i = 0; i < sheet.nx; ++i) {
      const bool high = i > 30;
      sheet.height_m.push_back(high ? 0.01F : 0.0F);
      sheet.texture_m.push_back(high ? 0.01F : 0.0F);
      sheet.slope_u.push_back(0.0F);
      sheet.slope_v.push_back(0.0F);
      const bool cell = i + 1 < sheet.nx && j + 1 < sheet.ny && i != 30;
      sheet.mask.push_back(scene::Sheet::kMeasured | (cell ? scene::Sheet::kCell : 0));
    }
  charts.sheets.push_back(sheet);
  return charts;
}

// A swap keeps the number of the proxy's sheet and its cell there, and the servo reads by them.
TEST(WholeObjects, WithTextureOrWithoutHaveTheSameSheetsWhereverTextureMakesAStep) {
  const scene::Charts charts = stepped_strip();
  scene::Charts envelope = charts;
  for (float& height : envelope.sheets[0].height_m) height = 0.0F;
  const auto with = make_object_surface(charts, {}, {}, true), without = make_object_surface(charts, {}, {}, false);
  ASSERT_NE(with->sheets.size(), make_object_surface(envelope)->sheets.size()) << "a step that cuts the sheet";
  ASSERT_EQ(with->sheets.size(), without->sheets.size());
  for (std::size_t k = 0; k < with->sheets.size(); ++k) {
    const scene::Lattice &a = with->sheets[k].surface->lattice, &b = without->sheets[k].surface->lattice;
    EXPECT_EQ(a.nx, b.nx);
    EXPECT_EQ(a.ny, b.ny);
    EXPECT_EQ(with->sheets[k].corner_m, without->sheets[k].corner_m);
  }
}

}  // namespace
}  // namespace sparsha::haptics
