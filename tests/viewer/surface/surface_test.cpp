// Light, continuation, colours and camera, against brute force and closed forms.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/viewer/relief_scene.h"
#include "viewer/camera/camera.h"
#include "viewer/gui/gui.h"
#include "viewer/surface/colour_maps.h"
#include "viewer/surface/height_light.h"
#include "viewer/surface/paint.h"
#include "viewer/surface/relief_data.h"

namespace sparsha::viewer::test {
namespace {

Heights bumps(int nx, int ny, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Heights heights{nx, ny, std::vector<float>(static_cast<std::size_t>(nx * ny), 0.0F)};
  for (int k = 0; k < 8; ++k) {
    const double cx = uniform(random) * nx, cy = uniform(random) * ny, r = 3.0 + 5.0 * uniform(random);
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        heights.value[static_cast<std::size_t>(j * nx + i)] +=
            static_cast<float>(r * std::exp(-(std::pow(i - cx, 2) + std::pow(j - cy, 2)) / (r * r)));
  }
  return heights;
}

double bilinear(const Heights& h, double x, double y) {
  const int i = std::clamp(static_cast<int>(x), 0, h.nx - 2), j = std::clamp(static_cast<int>(y), 0, h.ny - 2);
  const double u = x - i, v = y - j;
  const auto at = [&](int a, int b) { return static_cast<double>(h.value[static_cast<std::size_t>(b * h.nx + a)]); };
  return (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) + v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

/// How far the ray from a node towards the light stays above (positive) or sinks below the surface, spacings.
double clearance(const Heights& h, int i, int j, double azimuth, double elevation) {
  double least = 1e9;
  for (double t = 1.0; t < 200.0; t += 0.05) {
    const double x = i + t * std::cos(azimuth), y = j + t * std::sin(azimuth);
    if (x < 0.0 || y < 0.0 || x > h.nx - 1 || y > h.ny - 1) break;
    const double z = static_cast<double>(h.value[static_cast<std::size_t>(j * h.nx + i)]) + t * std::tan(elevation);
    least = std::min(least, z - bilinear(h, x, y));
  }
  return least;
}

TEST(HeightLight, ShadowsAgreeWithRaysMarchedOneByOne) {
  const unsigned seed = 11;
  SCOPED_TRACE(seed);
  const Heights heights = bumps(64, 48, seed);
  int judged = 0, wrong = 0;
  for (int k = 0; k < 16; ++k) {
    const double azimuth = 0.19 + 2.0 * std::numbers::pi * k / 16, elevation = 0.35;
    const std::vector<float> share = light_visibility(heights, azimuth, elevation, 0.5);
    for (int j = 2; j < 46; ++j)
      for (int i = 2; i < 62; ++i) {
        // Within half a spacing of the shadow's edge interpolation decides.
        const double room = clearance(heights, i, j, azimuth, elevation);
        if (std::abs(room) < 0.5) continue;
        ++judged;
        wrong += (share[static_cast<std::size_t>(j * 64 + i)] > 0.5F) != (room > 0.0);
      }
  }
  EXPECT_GT(judged, 10'000);
  EXPECT_LT(wrong, judged / 200);
}

TEST(HeightLight, APlaneSeesTheWholeSkyAndAPitSeesLess) {
  ThreadPool pool(1);
  const Heights plane{40, 40, std::vector<float>(1600, 3.0F)};
  for (const float sky : sky_visibility(plane, 1.0, pool)) EXPECT_NEAR(sky, 1.0F, 1e-4F);
  // On the axis of a cylindrical pit of radius r and depth d the cosine-weighted share is r^2 / (r^2 + d^2).
  Heights pit{81, 81, std::vector<float>(81 * 81, 12.0F)};
  for (int j = 0; j < 81; ++j)
    for (int i = 0; i < 81; ++i)
      if (std::hypot(i - 40, j - 40) < 12.0) pit.value[static_cast<std::size_t>(j * 81 + i)] = 0.0F;
  const float sky = sky_visibility(pit, 1.0, pool)[40 * 81 + 40];
  EXPECT_NEAR(sky, 0.5F, 0.13F) << "four rings of directions: steps of 1/4, softened";
}

TEST(HeightLight, ResultsDoNotDependOnThreads) {
  ThreadPool one(1), four(4);
  const Heights heights = bumps(70, 50, 5);
  EXPECT_EQ(sky_visibility(heights, 2.0, one), sky_visibility(heights, 2.0, four));
  EXPECT_EQ(soft_shadow(heights, 2.3, 0.5, 0.1, one), soft_shadow(heights, 2.3, 0.5, 0.1, four));
}

TEST(Blur, KeepsAConstantAndTheMeanOfAnImpulse) {
  const Heights constant{30, 20, std::vector<float>(600, 2.5F)};
  for (const float h : blur(constant, 3)) EXPECT_NEAR(h, 2.5F, 1e-5F);
  Heights impulse{61, 61, std::vector<float>(61 * 61, 0.0F)};
  impulse.value[30 * 61 + 30] = 1.0F;
  double sum = 0.0;
  for (const float h : blur(impulse, 4)) sum += static_cast<double>(h);
  EXPECT_NEAR(sum, 1.0, 1e-4);
}

TEST(ReliefData, SlopesAndHeightsOfAPlaneAreExact) {
  const auto plane = [](double x_m, double y_m) { return 0.3 * x_m - 0.2 * y_m + 0.01; };
  const auto scene = scene_of(plane, {33, 21, 0.002, 1, {5.0, -3.0, 7.0}});
  ThreadPool pool(1);
  const ReliefData relief = prepare_relief(scene->read_level(0), 0, false, 0.0, pool);
  for (std::size_t k = 0; k < relief.lattice.count(); ++k) {
    // Heights are stored in single precision: a slope errs by two roundings over two spacings.
    const float tolerance = 4.0F * 0.06F * std::numeric_limits<float>::epsilon() / 0.002F;
    EXPECT_NEAR(relief.slope[2 * k], 0.3F, tolerance);
    EXPECT_NEAR(relief.slope[2 * k + 1], -0.2F, tolerance);
  }
  EXPECT_NEAR(relief.height_at(5.0313, -2.9777), 7.0 + plane(0.0313, 0.0223), 1e-8);
  EXPECT_NEAR(relief.rms_slope, std::hypot(0.3, 0.2), 1e-4);
}

double channel(std::uint8_t v) {
  const double c = v / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

TEST(ColourMaps, LightnessAloneTellsTheOrderOfValues) {
  double before = -1.0;
  for (int k = 0; k <= 100; ++k) {
    const auto c = colour_of(ColourMap::sequential, k / 100.0);
    const double luminance = 0.2126 * channel(c[0]) + 0.7152 * channel(c[1]) + 0.0722 * channel(c[2]);
    EXPECT_GT(luminance, before) << "a grey print, or an eye without colours, must still read the map";
    before = luminance;
  }
}

TEST(ColourMaps, EndsStayApartWithoutRedOrGreenReceptors) {
  // Machado, Oliveira & Fernandes 2009, severity 1: protanopia, deuteranopia; linear RGB.
  const std::array<std::array<double, 9>, 2> deficits{
      {{0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998},
       {0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881}}};
  for (const auto& m : deficits) {
    const auto seen = [&](double t) {
      const auto c = colour_of(ColourMap::diverging, t);
      const std::array<double, 3> l{channel(c[0]), channel(c[1]), channel(c[2])};
      std::array<double, 3> out{};
      for (std::size_t r = 0; r < 3; ++r)
        out[r] = std::cbrt(std::max(0.0, m[3 * r] * l[0] + m[3 * r + 1] * l[1] + m[3 * r + 2] * l[2]));
      return out;
    };
    for (const double t : {0.0, 0.15, 0.3}) {
      const auto below = seen(t), above = seen(1.0 - t);
      const double distance = std::hypot(below[0] - above[0], below[1] - above[1], below[2] - above[2]);
      EXPECT_GT(distance, 0.15) << "below and above zero at " << t;
    }
  }
  EXPECT_EQ(colour_of(ColourMap::sequential, std::nan("")), (std::array<std::uint8_t, 3>{122, 122, 122}));
}

TEST(Camera, PixelsAndRaysAreInverse) {
  Camera camera;
  camera.target = {0.1, -0.2, 0.05};
  camera.turn_rad = 0.4;
  camera.tilt_rad = 0.7;
  camera.distance = 1.4;
  for (const double shift : {0.0, 0.05})
    for (const double field : {0.5, 0.0}) {
      camera.field_rad = field;
      const View view = make_view(camera, 900, 700, shift);
      const Eigen::Vector3d point(0.22, -0.11, 0.13);
      const auto pixel = view.to_pixel(point);
      ASSERT_TRUE(pixel);
      const View::Ray ray = view.ray(pixel->x(), pixel->y());
      EXPECT_LT((point - ray.origin).cross(ray.direction).norm(), 1e-9);
      const auto hit = view.on_plane(pixel->x(), pixel->y(), point.z());
      ASSERT_TRUE(hit);
      EXPECT_LT((*hit - point).norm(), 1e-9);
    }
}

TEST(Camera, NearPointsHaveCrossedParallaxAndTheTargetHasNone) {
  Camera camera;
  camera.distance = 1.5;
  camera.tilt_rad = 0.3;
  const View left = make_view(camera, 900, 700, -0.04), right = make_view(camera, 900, 700, 0.04);
  const auto parallax = [&](const Eigen::Vector3d& p) { return right.to_pixel(p)->x() - left.to_pixel(p)->x(); };
  EXPECT_NEAR(parallax(camera.target), 0.0, 1e-9);
  EXPECT_LT(parallax(camera.target + 0.2 * camera.axes().col(2)), -1.0) << "nearer: the right eye sees it further left";
  EXPECT_GT(parallax(camera.target - 0.2 * camera.axes().col(2)), 1.0);
  // Off-axis, not toe-in: no vertical parallax anywhere.
  const Eigen::Vector3d corner(0.3, 0.25, 0.1);
  EXPECT_NEAR(left.to_pixel(corner)->y(), right.to_pixel(corner)->y(), 1e-9);
}

constexpr double kWorkspace_m = 0.1;

TEST(Paint, OneDeepPitLeavesTheRangeOfTheSkyThatIsSeenToTheRest) {
  const auto drilled = [](double x_m, double y_m) {
    return lotus(x_m, y_m) - (std::hypot(x_m - 0.2, y_m - 0.2) < 0.01 ? 0.3 : 0.0);
  };
  ThreadPool pool(2);
  const auto low_of = [&](const auto& height) {
    const auto scene = scene_of(height, {101, 101, 0.004, 1});
    const ReliefData relief = prepare_relief(scene->read_level(0), 0, false, 0.0, pool);
    const Paint paint = paint_relief(relief, scene->description(), ColourMode::sky_view, kWorkspace_m);
    std::size_t below = 0;
    for (std::size_t k = 0; k < relief.lattice.count(); ++k)
      below += 100.0 * relief.tone[4 * k] / 255.0 < paint.legend.low ? 1 : 0;
    // Half a percent for the sample of nodes that the quantile is taken from.
    EXPECT_LT(static_cast<double>(below), 0.025 * static_cast<double>(relief.lattice.count()));
    return paint.legend.low;
  };
  const double plain = low_of(lotus);
  // The pit is 0.2 % of the nodes; what it darkens of its rim may cost half the range at most.
  EXPECT_GT(low_of(drilled), 100.0 - 1.5 * (100.0 - plain));
}

TEST(Paint, ModesFollowWhatTheSceneHas) {
  const auto scene = scene_of(lotus, {51, 51, 0.008, 1});
  EXPECT_EQ(next_mode(scene->description(), ColourMode::relief), ColourMode::height);
  EXPECT_EQ(next_mode(scene->description(), ColourMode::height), ColourMode::slope);
  EXPECT_FALSE(has_mode(scene->description(), ColourMode::friction));
  ThreadPool pool(1);
  const ReliefData relief = prepare_relief(scene->read_level(0), 0, false, 0.0, pool);
  const Paint paint = paint_relief(relief, scene->description(), ColourMode::height, kWorkspace_m);
  ASSERT_EQ(paint.rgba.size(), 4 * relief.lattice.count());
  EXPECT_NEAR(paint.legend.high, 1e3 * (scene->description().height_max_m - scene->description().height_min_m), 1e-9);
  EXPECT_TRUE(paint_relief(relief, scene->description(), ColourMode::relief, kWorkspace_m).rgba.empty());
}

}  // namespace
}  // namespace sparsha::viewer::test
