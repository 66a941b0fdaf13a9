// Looks, contour lines and the section plane, judged by their pixels; positions are recomputed from the scene's
// numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/viewer/relief_scene.h"
#include "tests/viewer/studio.h"

namespace sparsha::viewer::test {
namespace {

SceneOptions plate() { return {201, 201, 0.001, 1}; }

/// Pixel of a place of the object in a bare picture.
Eigen::Vector2d pixel_of(Studio& studio, const Eigen::Vector3d& grid_m) {
  const auto pixel = studio.picture().detail_view().to_pixel(studio.picture().stage().to_world(grid_m));
  return pixel.value_or(Eigen::Vector2d::Constant(-1.0));
}

double around(const Image& image, const Eigen::Vector2d& pixel, int reach) {
  return image.mean_luminance(
      {static_cast<int>(pixel.x()) - reach, static_cast<int>(pixel.y()) - reach, 2 * reach + 1, 2 * reach + 1});
}

TEST(Looks, ContourLinesLieWhereTheHeightIsAMultipleOfTheStep) {
  // A tilted plane from 0 to 20 mm: lines every 2 mm are upright, 20 mm apart.
  const auto tilted = [](double x_m, double) { return 0.1 * x_m; };
  Studio studio(scene_of(tilted, plate()));
  const Image without = studio.shoot_bare();
  studio.controller().frame().settings.contour_m = 0.002;
  const Image with = studio.shoot_bare();
  for (int line = 1; line < 10; ++line) {
    const double x_m = 0.02 * line;
    const auto on = pixel_of(studio, {x_m, 0.11, tilted(x_m, 0)}),
               beside = pixel_of(studio, {x_m + 0.01, 0.11, tilted(x_m + 0.01, 0)});
    double darkest = 255.0;  // the line is a pixel or two wide
    for (int dx = -2; dx <= 2; ++dx)
      darkest = std::min(darkest, with.at(static_cast<int>(on.x()) + dx, static_cast<int>(on.y())).luminance());
    EXPECT_LT(darkest, 0.75 * around(without, on, 2)) << line;
    EXPECT_NEAR(around(with, beside, 3), around(without, beside, 3), 2.0) << line;
  }
  EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
}

TEST(Looks, ContourLinesThatWouldRunIntoEachOtherAreLeftOut) {
  const auto tilted = [](double x_m, double) { return 0.1 * x_m; };
  Studio studio(scene_of(tilted, plate()));
  const Image without = studio.shoot_bare();
  studio.controller().frame().settings.contour_m = 1e-6;
  const Image with = studio.shoot_bare();
  const Rect middle{350, 250, 200, 150};
  EXPECT_NEAR(with.mean_luminance(middle), without.mean_luminance(middle), 1.0);
}

TEST(Looks, ClayIsBrighterWhereItFacesTheLampBesideTheCameraWhateverTheKeyLight) {
  const auto roof = [](double x_m, double) { return 0.05 - 0.25 * std::abs(x_m - 0.1); };
  ViewSettings settings;
  settings.look = Look::clay;
  const Rect left{330, 300, 60, 100}, right{520, 300, 60, 100};
  for (const double azimuth : {0.0, 3.14159}) {
    settings.light.azimuth_rad = azimuth;
    Studio studio(scene_of(roof, plate()), settings);
    const Image image = studio.shoot_bare();
    EXPECT_GT(image.mean_luminance(left), 1.1 * image.mean_luminance(right)) << "the lamp is at the upper left";
    // Turned by half a turn about the line of sight, the other side faces it.
    studio.act(Action::turn_left, 39);
    studio.settle();
    const Image turned = studio.shoot_bare();
    EXPECT_GT(turned.mean_luminance(left), 1.1 * turned.mean_luminance(right));
  }
}

TEST(Looks, SkyLightAloneDarkensAPitAndNotASlopeByItsSide) {
  const auto pit = [](double x_m, double y_m) { return std::hypot(x_m - 0.1, y_m - 0.1) < 0.012 ? -0.03 : 0.0; };
  ViewSettings settings;
  settings.look = Look::sky;
  {
    Studio studio(scene_of(pit, plate()), settings);
    const Image image = studio.shoot_bare();
    EXPECT_LT(around(image, pixel_of(studio, {0.1, 0.1, -0.03}), 4),
              0.7 * around(image, pixel_of(studio, {0.04, 0.1, 0}), 4));
  }
  const auto roof = [](double x_m, double) { return 0.05 - 0.25 * std::abs(x_m - 0.1); };
  Studio gable(scene_of(roof, plate()), settings);
  const Image sides = gable.shoot_bare();
  const double left = sides.mean_luminance({330, 300, 60, 100}), right = sides.mean_luminance({520, 300, 60, 100});
  EXPECT_NEAR(left, right, 0.08 * left) << "no side is favoured";
}

TEST(Looks, EdgesOfDepthAreDarkBelowAStepAndAPlaneHasNone) {
  const auto step = [](double x_m, double) { return x_m < 0.1 ? 0.02 : 0.0; };
  ViewSettings settings;
  settings.look = Look::eye_dome;
  for (const bool parallel : {false, true}) {
    Studio studio(scene_of(step, plate()), settings);
    if (parallel) studio.act(Action::orthographic);
    studio.settle();
    const Image image = studio.shoot_bare();
    const auto foot = pixel_of(studio, {0.1015, 0.1, 0.0}), far = pixel_of(studio, {0.15, 0.1, 0.0}),
               top = pixel_of(studio, {0.05, 0.1, 0.02});
    EXPECT_LT(around(image, foot, 1), 0.8 * around(image, far, 3)) << parallel;
    EXPECT_NEAR(around(image, top, 3), around(image, far, 3), 0.1 * around(image, far, 3)) << parallel;
    EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
  }
}

TEST(Looks, ASectionPlaneLeavesOutWhatLiesBeforeItAndShowsTheCut) {
  Studio studio(scene_of(lotus, {401, 401, 0.0005, 1}));
  studio.act(Action::tilt_down, 10);
  studio.settle();
  const Image whole = studio.shoot_bare();
  studio.act(Action::section);
  studio.settle();
  const Image cut = studio.shoot_bare();
  const auto stone = [](const Pixel& p) { return p.r > 60 && p.r > p.b + 12; };
  const auto at = [&](const Image& image, double x_m, double y_m, double z_m) {
    const auto pixel = pixel_of(studio, {x_m, y_m, z_m});
    return image.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
  };
  // The plane goes through the middle; the near half (small y) is gone, the far one is as it was.
  EXPECT_TRUE(stone(at(whole, 0.1, 0.02, lotus(0.1, 0.02))));
  EXPECT_FALSE(stone(at(cut, 0.1, 0.02, lotus(0.1, 0.02))));
  const Pixel before = at(whole, 0.1, 0.17, lotus(0.1, 0.17)), after = at(cut, 0.1, 0.17, lotus(0.1, 0.17));
  EXPECT_NEAR(before.luminance(), after.luminance(), 2.0);
  // Under the surface at the plane lies the cut face, which is no backdrop.
  const Pixel face = at(cut, 0.05, 0.1, lotus(0.05, 0.1) - 0.003);
  EXPECT_GT(face.luminance(), 45.0);
  EXPECT_GT(face.r, face.b + 8);
  studio.act(Action::section);
  studio.settle();
  EXPECT_EQ(studio.shoot_bare().rgba, whole.rgba);
  EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
}

TEST(Looks, AKioskShowsTheWholeObjectWhateverSectionWasLeft) {
  ViewSettings settings;
  settings.kiosk = true;
  Studio studio(scene_of(lotus, {201, 201, 0.001, 1}), settings);
  const Image whole = studio.shoot_bare();
  studio.act(Action::section);
  studio.settle();
  EXPECT_EQ(studio.shoot_bare().rgba, whole.rgba);
}

TEST(Looks, EveryOneDrawsInEveryStereoModeWithoutErrorsAndFreesWhatItTook) {
  const auto edit = [](scene::SceneDescription& description) {
    auto map = std::make_shared<scene::CheckMap>();
    map->lattice = {2, 2, 0.2, {0.1, 0.1, 0.0}};
    map->error_m = {0.0F, 1e-4F, 2e-4F, std::nanf("")};
    map->high_m = 2e-4;
    description.check_map = map;
  };
  Studio studio(scene_of(lotus, {201, 201, 0.002, 2}, edit));
  const auto scene = studio.picture().scene();
  const haptics::State state = touching(*scene, 0.2, 0.2, 0.01, 0.2, 0.2);
  studio.act(Action::contours_finer);
  studio.act(Action::section);
  studio.controller().frame().settings.colour = ColourMode::error;
  for (int look = 0; look < kLooks; ++look) {
    for (int mode = 0; mode < 4; ++mode) {
      studio.shoot(state, 640, 400);
      studio.act(Action::stereo);
    }
    studio.act(Action::look);
  }
  EXPECT_EQ(studio.picture().legend().title, "Distance to the scan");
  EXPECT_NEAR(studio.picture().legend().high, 0.2, 1e-9);
  EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
  studio.strike();
  EXPECT_EQ(gl::living_objects(), 0);
}

TEST(Looks, EveryVariantOfTheReliefsProgramWithThemCompiles) {
  const gl::OffscreenContext context;
  ReliefPrograms programs;
  for (unsigned look = 64; look < 512; look += 64)
    for (const unsigned others : {0U, 1U, 2U, 62U, 63U})
      EXPECT_NO_THROW(programs.with(look | others).use()) << look + others;
}

TEST(Looks, TheOverviewLiesOnEitherSideAndIsClickedThere) {
  for (const bool left : {false, true}) {
    ViewSettings settings;
    settings.overview_left = left;
    const Layout layout = layout_of(1280, 720, settings);
    EXPECT_EQ(layout.overview.x < layout.detail.x, left);
    EXPECT_GE(layout.detail.x, 0);
    EXPECT_EQ(layout.detail.x + layout.detail.width, left ? 1280 : layout.panel.x);
    Studio studio(scene_of(lotus, {201, 201, 0.002, 1}), settings);
    const Image image = studio.shoot();
    EXPECT_GT(image.mean_luminance(layout.overview), 25.0);
    EXPECT_GT(image.mean_luminance({layout.detail.x + 300, 250, 200, 200}), 25.0);
  }
}

}  // namespace
}  // namespace sparsha::viewer::test
