// Touching with a ball: the dilation against brute force and against surfaces whose offset is known.
#include "scene/fingertip.h"

#include <gtest/gtest.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "haptics/window/scene_window.h"
#include "tests/support/scenes.h"

namespace sparsha::haptics {
namespace {

using pipeline::touch_with_ball;

/// The same by looking at every place of every cell, `parts` a side.
std::vector<double> brute_force(const std::vector<float>& z, int nx, int ny, double spacing, double radius, int parts) {
  const auto node = [&](int i, int j) { return static_cast<double>(z[static_cast<std::size_t>(j * nx + i)]); };
  std::vector<double> result;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      double best = -1e300;
      for (int v = 0; v <= (ny - 1) * parts; ++v)
        for (int u = 0; u <= (nx - 1) * parts; ++u) {
          const double dx = (static_cast<double>(u) / parts - i) * spacing;
          const double dy = (static_cast<double>(v) / parts - j) * spacing;
          const double squared = radius * radius - dx * dx - dy * dy;
          if (squared < 0.0) continue;
          const int ci = std::min(u / parts, nx - 2);
          const int cj = std::min(v / parts, ny - 2);
          const double s = static_cast<double>(u) / parts - ci;
          const double t = static_cast<double>(v) / parts - cj;
          const double f = (1 - t) * ((1 - s) * node(ci, cj) + s * node(ci + 1, cj)) +
                           t * ((1 - s) * node(ci, cj + 1) + s * node(ci + 1, cj + 1));
          best = std::max(best, f + std::sqrt(squared));
        }
      result.push_back(best - radius);
    }
  return result;
}

TEST(Fingertip, IsTheDilationOfTheBilinearSurfaceByABall) {
  std::mt19937_64 random(3);
  for (const double radius : {0.2, 0.9, 1.0, 1.7, 3.3})
    for (const double rough : {0.1, 1.0, 6.0}) {
      constexpr int kNx = 9, kNy = 8, kParts = 48;
      std::uniform_real_distribution<float> height(0.0F, static_cast<float>(rough));
      std::vector<float> z(kNx * kNy);
      for (float& value : z) value = height(random);
      std::vector<float> ball = z;
      touch_with_ball(ball, kNx, kNy, 1.0, radius);
      const std::vector<double> sampled = brute_force(z, kNx, kNy, 1.0, radius, kParts);
      // Between the samples the top is higher by no more than the slopes and the ball's flank at its steepest allow.
      double most = 0.0;
      for (std::size_t k = 0; k < z.size(); ++k) {
        ASSERT_GE(ball[k], sampled[k] - 1e-6) << radius << ' ' << rough << ' ' << k;
        most = std::max(most, static_cast<double>(ball[k]) - sampled[k]);
      }
      EXPECT_LE(most, (2.0 * rough * 0.5 + std::sqrt(radius)) / kParts) << radius << ' ' << rough;
    }
}

TEST(Fingertip, LeavesLevelStoneWhereItIsAndLiftsASlopeByItsNormal) {
  for (const double slope : {0.0, 0.5, 2.0}) {
    std::vector<float> z;
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 20; ++i) z.push_back(static_cast<float>(slope * i * 0.5));
    std::vector<float> ball = z;
    touch_with_ball(ball, 20, 20, 0.5, 1.3);
    const double lift = 1.3 * (std::sqrt(1.0 + slope * slope) - 1.0);
    for (int j = 4; j < 16; ++j)
      for (int i = 4; i < 16; ++i)
        EXPECT_NEAR(ball[static_cast<std::size_t>(j * 20 + i)], z[static_cast<std::size_t>(j * 20 + i)] + lift, 2e-6);
  }
}

TEST(Fingertip, RidesAcrossAPitThatItCannotEnter) {
  std::vector<float> z(41 * 41, 0.0F);
  z[20 * 41 + 20] = -50.0F;
  touch_with_ball(z, 41, 41, 1.0, 5.0);
  // Deepest where the ball rests on the rim of the pit: its walls are one cell wide.
  EXPECT_GE(*std::min_element(z.begin(), z.end()), static_cast<float>(std::sqrt(25.0 - 2.0) - 5.0));
  EXPECT_LT(*std::min_element(z.begin(), z.end()), 0.0F);
}

TEST(Fingertip, OfNoSizeChangesNotABit) {
  std::vector<float> z = {0.1F, 3.0F, -2.0F, 0.7F};
  const std::vector<float> before = z;
  touch_with_ball(z, 2, 2, 0.01, 0.0);
  EXPECT_EQ(z, before);
}

pipeline::ScenePointer grained_scene() {
  return sparsha::test::scene_of(
      [](double x, double y) {
        return sparsha::test::hills_m(x, y) + 0.0004 * std::sin(2100.0 * x) * std::sin(1700.0 * y);
      },
      801, 0.1, 101, Eigen::Vector3d(2.0, -1.0, 0.3),
      [](pipeline::SceneDescription& d) { d.config.haptics.tip_radius_m = 0.0007; });
}

TEST(Fingertip, OfAWindowIsTheConfigurationsAndTheSameAcrossTheBordersOfWindows) {
  const auto scene = grained_scene();
  const double tip_m = 0.0007;
  const WindowPlan left = plan_window(scene->description(), 0, {2.03, -0.95}, 0.1);
  const WindowPlan right = plan_window(scene->description(), 0, {2.035, -0.947}, 0.1);
  EXPECT_EQ(left.tip_radius_m, tip_m);
  const auto a = load_window(*scene, left, 1).surface;
  const auto b = load_window(*scene, right, 2).surface;
  EXPECT_EQ(a->tip_radius_m, tip_m);
  WindowPlan point = left;
  point.tip_radius_m = 0.0;
  const auto bare = load_window(*scene, point, 3).surface;
  const int di = right.i0 - left.i0;
  const int dj = right.j0 - left.j0;
  ASSERT_GT(di, 10);
  std::size_t lifted = 0;
  for (int j = dj; j < left.ny; ++j)
    for (int i = di; i < left.nx; ++i) {
      const std::size_t here = a->lattice.index(i, j);
      ASSERT_EQ(a->height_m[here], b->height_m[b->lattice.index(i - di, j - dj)]) << i << ' ' << j;
      ASSERT_GE(a->height_m[here], bare->height_m[here] - 1e-9F) << "the ball never dips below the stone";
      if (a->height_m[here] > bare->height_m[here] + 1e-6F) ++lifted;
    }
  EXPECT_GT(lifted, 1000U);
}

TEST(Fingertip, KeepsFrictionFlagsAndUnknownNodesOfItsWindow) {
  sparsha::test::SceneOptions options{201, 201, 0.0005};
  const auto scene = sparsha::test::scene_of(
      [](double x, double y) {
        return std::hypot(x - 0.05, y - 0.05) < 0.004 ? std::nan("") : 0.0002 * std::sin(3e3 * x);
      },
      options,
      [](pipeline::SceneDescription& d) {
        d.config.friction = pipeline::FrictionConfig{};
        d.config.friction->law = pipeline::FrictionConfig::Law::constant;
      });
  WindowPlan plan = plan_window(scene->description(), 0, {0.05, 0.05}, 0.1);
  plan.tip_radius_m = 0.0005;
  const auto ball = load_window(*scene, plan, 1).surface;
  plan.tip_radius_m = 0.0;
  const auto bare = load_window(*scene, plan, 1).surface;
  EXPECT_EQ(ball->cell_flags, bare->cell_flags);
  EXPECT_EQ(ball->mu_dynamic, bare->mu_dynamic);
  EXPECT_EQ(ball->mu_static, bare->mu_static);
  EXPECT_EQ(ball->lattice.origin_m, bare->lattice.origin_m);
  EXPECT_TRUE(std::all_of(ball->height_m.begin(), ball->height_m.end(), [](float z) { return std::isfinite(z); }));
}

}  // namespace
}  // namespace sparsha::haptics
