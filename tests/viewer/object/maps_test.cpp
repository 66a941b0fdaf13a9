// Maps of whole objects, on all their sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/scenes.h"
#include "tests/viewer/object/exhibit.h"
#include "viewer/object/paint.h"

namespace sparsha::viewer::test {
namespace {

/// With friction, and a front view without any height.
scene::ScenePointer flat_scene(const scene::Charts& charts) {
  return sparsha::test::scene_of([](double, double) { return 0.0; }, sparsha::test::SceneOptions{},
                                 [&](scene::SceneDescription& description) {
                                   description.charts = std::make_shared<const scene::Charts>(charts);
                                   description.config.friction.emplace();
                                   description.friction_c_m = 0.005;
                                 });
}

/// Texture and friction of every vertex, on all sides: those of the nodes of the charts that were set so.
TEST(WholePicture, TextureAndFrictionAreShownOnAllSides) {
  const sparsha::test::ObjectPtr torus = sparsha::test::make_torus();
  scene::Charts charts = charts_of(*torus, 5'000, 0.0);
  for (scene::Sheet& sheet : charts.sheets) {
    sheet.texture_m.assign(sheet.count(), std::numeric_limits<float>::quiet_NaN());
    sheet.curvature_per_m = sheet.texture_m;
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        const std::size_t node = sheet.index(i, j);
        if (!sheet.measured(node)) continue;
        const bool rough = charts.place_m(sheet, i, j).x() + charts.origin_m.x() > 0.0;
        sheet.texture_m[node] = rough ? 0.001F : -0.001F;
        sheet.curvature_per_m[node] = rough ? 100.0F : 0.0F;
      }
  }
  const gl::OffscreenContext context;
  Exhibit exhibit(charts);
  const scene::ScenePointer scene = flat_scene(charts);
  const Paint nothing;
  const ReliefData front;
  for (const ColourMode mode : {ColourMode::texture, ColourMode::friction}) {
    const Paint paint = paint_object(exhibit.view(), {scene->description(), 0.1, front, nothing}, mode);
    const std::size_t count = exhibit.view().finest().place.size();
    ASSERT_EQ(paint.rgba.size(), 4 * count);
    std::array<std::size_t, 2> behind{};  // smooth, rough
    for (std::size_t v = 0; v < count; ++v) {
      ASSERT_EQ(paint.rgba[4 * v + 3], 255) << "a vertex without colour";
      const double x = exhibit.view().place_m(v).x();
      if (std::abs(x) < 4.0 * exhibit.spacing_m()) continue;
      const double value = mode == ColourMode::texture ? (x > 0.0 ? 1.0 : -1.0) : (x > 0.0 ? 0.7 : 0.2);
      const auto want =
          colour_of(paint.legend.map, (value - paint.legend.low) / (paint.legend.high - paint.legend.low));
      for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(paint.rgba[4 * v + c], want[c], 1) << x;
      if (exhibit.view().finest().normal[v].z() < 0.0F) ++behind[x > 0.0 ? 1 : 0];
    }
    EXPECT_GT(std::min(behind[0], behind[1]), 300U);
    EXPECT_EQ(paint.legend.title.find("front"), std::string::npos);
  }
}

// Red where x is positive, blue elsewhere, on the back as on the front; intensities alone are greys.
TEST(WholePicture, HasTheScansColoursOnAllSides) {
  scene::Charts charts = charts_of(*sparsha::test::make_torus(), 20'000, 0.1);
  for (scene::Sheet& sheet : charts.sheets) {
    sheet.colour_rgba.assign(sheet.count(), 0);
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i)
        if (sheet.measured(sheet.index(i, j)))
          sheet.colour_rgba[sheet.index(i, j)] =
              (charts.origin_m + charts.place_m(sheet, i, j)).x() > 0.0 ? 0xFF0000C8U : 0xFFC80000U;
  }
  const gl::OffscreenContext context;
  const scene::ScenePointer scene = flat_scene(charts);
  const Paint nothing;
  const ReliefData front;
  const auto expect_halves = [&](Exhibit& exhibit, const Paint& paint, const std::array<std::array<int, 3>, 2>& want) {
    const ObjectView& view = exhibit.view();
    ASSERT_EQ(paint.rgba.size(), 4 * view.finest().place.size());
    std::array<std::size_t, 2> behind{};
    for (std::size_t v = 0; v < view.finest().place.size(); ++v) {
      ASSERT_EQ(paint.rgba[4 * v + 3], 255) << "a vertex without colour";
      const double x = view.place_m(v).x();
      if (std::abs(x) < 4.0 * exhibit.spacing_m()) continue;
      for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(paint.rgba[4 * v + c], want[x > 0.0 ? 1 : 0][c], 1) << x;
      if (view.finest().normal[v].z() < 0.0F) ++behind[x > 0.0 ? 1 : 0];
    }
    EXPECT_GT(std::min(behind[0], behind[1]), 300U);
    EXPECT_EQ(paint.legend.title.find("front"), std::string::npos);
  };
  {
    Exhibit exhibit(charts);
    expect_halves(exhibit, paint_object(exhibit.view(), {scene->description(), 0.1, front, nothing}, ColourMode::scan),
                  {{{0, 0, 200}, {200, 0, 0}}});
  }
  for (scene::Sheet& sheet : charts.sheets) {
    for (const std::uint32_t rgba : sheet.colour_rgba)
      sheet.intensity.push_back(rgba == 0             ? std::numeric_limits<float>::quiet_NaN()
                                : rgba == 0xFF0000C8U ? 9.0F
                                                      : 4.0F);
    sheet.colour_rgba.clear();
  }
  Exhibit exhibit(charts);
  expect_halves(exhibit, paint_object(exhibit.view(), {scene->description(), 0.1, front, nothing}, ColourMode::scan),
                {{{40, 40, 40}, {255, 255, 255}}});
}

// Half the sum of the principal curvatures times sigma squared is what a Gaussian mean cuts off.
TEST(WholePicture, HasLocalReliefCoverageAndDistancesOfItsOwn) {
  scene::Charts charts = charts_of(*sparsha::test::make_torus(Eigen::Matrix3d::Identity()), 40'000, 0.0);
  for (scene::Sheet& sheet : charts.sheets) sheet.error_m.assign(sheet.count(), 0.002F);
  const gl::OffscreenContext context;
  Exhibit exhibit(charts);
  const scene::ScenePointer scene = flat_scene(charts);
  const Paint nothing;
  const ReliefData front;
  const ObjectSource source{scene->description(), 0.1, front, nothing};
  const ObjectView& view = exhibit.view();
  const Paint relief = paint_object(view, source, ColourMode::local_relief);
  ASSERT_EQ(relief.rgba.size(), 4 * view.finest().place.size());
  constexpr double kRing = 1.0, kTube = 0.4, kSigma = 0.816 / 40.0 * 2.0 * (kRing + kTube);
  std::array<double, 2> off{}, count{};  // levels; on the inner side of the ring and on the outer one
  for (std::size_t v = 0; v < view.finest().place.size(); ++v) {
    const Eigen::Vector3d normal = view.finest().normal[v].cast<double>();
    const Eigen::Vector3d place = view.place_m(v);
    const double towards = place.head<2>().normalized().dot(normal.head<2>());
    if (std::abs(towards) < 0.95) continue;
    const double ring = kRing + kTube * towards;
    const double value = 1e3 * 0.5 * (1.0 / kTube + towards / ring) * kSigma * kSigma;
    const auto want =
        colour_of(relief.legend.map, (value - relief.legend.low) / (relief.legend.high - relief.legend.low));
    const std::size_t side = towards > 0.0 ? 1 : 0;
    for (std::size_t c = 0; c < 3; ++c) off[side] += (relief.rgba[4 * v + c] - static_cast<double>(want[c])) / 3.0;
    count[side] += 1.0;
  }
  for (const std::size_t side : {0U, 1U}) {
    ASSERT_GT(count[side], 500.0);
    EXPECT_LT(std::abs(off[side] / count[side]), 6.0) << (side == 0 ? "inner" : "outer");
  }

  // Nothing is continued of what has no edges; along those of a cube the sheets go on to where they meet.
  const Paint coverage = paint_object(view, source, ColourMode::coverage);
  ASSERT_EQ(coverage.legend.swatches.size(), 2U);
  EXPECT_EQ(coverage.legend.swatches[0].name, "measured 100.0 %");
  Exhibit cube(charts_of(*sparsha::test::make_box({0.6, 0.6, 0.6}, Eigen::Matrix3d::Identity()), 20'000, 0.1));
  const Paint of_cube = paint_object(cube.view(), source, ColourMode::coverage);
  std::size_t continued = 0;
  const std::vector<Eigen::Vector3f>& vertices = cube.view().finest().place;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (of_cube.rgba[4 * v + 2] != kFilledColour[2]) continue;
    ++continued;
    Eigen::Vector3d place = cube.view().place_m(v).cwiseAbs();
    std::sort(place.begin(), place.end());
    EXPECT_GT(place[1], 0.6 - 4.0 * cube.spacing_m());
  }
  EXPECT_GT(continued, 100U);
  EXPECT_LT(continued, vertices.size() / 5);
  const Paint distance = paint_object(view, source, ColourMode::error);
  EXPECT_NEAR(distance.legend.high, 2.0, 1e-6);
  EXPECT_EQ(distance.legend.unit, "mm");
  for (std::size_t v = 0; v < view.finest().place.size(); ++v) ASSERT_EQ(distance.rgba[4 * v + 3], 255);
  for (const Paint* paint : {&relief, &coverage, &distance})
    EXPECT_EQ(paint->legend.title.find("front"), std::string::npos);
}

}  // namespace
}  // namespace sparsha::viewer::test
