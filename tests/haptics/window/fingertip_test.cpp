// Touching with a ball: the dilation against brute force and against surfaces whose offset is known.
#include "scene/ground/fingertip.h"

#include <gtest/gtest.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "base/error.h"
#include "base/threads/progress.h"
#include "haptics/window/window.h"
#include "tests/support/scenes.h"

namespace sparsha::haptics {
namespace {

using scene::touch_with_ball;

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

TEST(Fingertip, OfManyNodesIsNoLowerThanAnyNodeUnderItWithItsCap) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const double radius : {6.2, 9.0, 12.7})
    for (const double rough : {0.0, 0.02, 0.5, 6.0})
      for (const double slope : {0.0, 0.6, -2.0}) {
        constexpr int kNx = 27, kNy = 24;
        std::vector<float> z;
        for (int j = 0; j < kNy; ++j)
          for (int i = 0; i < kNx; ++i)
            z.push_back(static_cast<float>(rough * share(random) + slope * i - 0.3 * slope * j));
        std::vector<float> ball = z;
        touch_with_ball(ball, kNx, kNy, 1.0, radius);
        for (int j = 0; j < kNy; ++j)
          for (int i = 0; i < kNx; ++i) {
            const auto here = static_cast<std::size_t>(j * kNx + i);
            double highest = -1e300;
            for (int y = 0; y < kNy; ++y)
              for (int x = 0; x < kNx; ++x)
                if (const double left = radius * radius - static_cast<double>((x - i) * (x - i) + (y - j) * (y - j));
                    left >= 0.0)
                  highest = std::max(highest,
                                     static_cast<double>(z[static_cast<std::size_t>(y * kNx + x)]) + std::sqrt(left));
            ASSERT_GE(ball[here], static_cast<float>(highest - radius)) << radius << ' ' << rough << ' ' << slope;
          }
      }
}

TEST(Fingertip, OfALargeWindowIsGivenUpWhenNobodyWaitsForIt) {
  std::vector<float> z(300UL * 300UL, 0.0F);
  Progress progress;
  EXPECT_NO_THROW(touch_with_ball(z, 300, 300, 1.0, 2.0, &progress));
  progress.cancel();
  EXPECT_THROW(touch_with_ball(z, 300, 300, 1.0, 2.0, &progress), Cancelled);
}

/// The same at the middle of nine nodes: every cell sampled, the best places refined by a
/// pattern search whose steps halve.
double searched(const std::vector<float>& z, double radius) {
  constexpr int kSide = 3, kParts = 12;
  constexpr double kFinest = 1e-6, kGain = 1e-9;
  const auto node = [&](int i, int j) { return static_cast<double>(z[static_cast<std::size_t>(j * kSide + i)]); };
  const auto value = [&](double u, double v) {
    if (u < 0.0 || v < 0.0 || u > kSide - 1 || v > kSide - 1) return -1e300;
    const double squared = radius * radius - (u - 1) * (u - 1) - (v - 1) * (v - 1);
    if (squared < 0.0) return -1e300;
    const int i = std::min(static_cast<int>(u), kSide - 2);
    const int j = std::min(static_cast<int>(v), kSide - 2);
    const double s = u - i, t = v - j;
    return (1 - t) * ((1 - s) * node(i, j) + s * node(i + 1, j)) +
           t * ((1 - s) * node(i, j + 1) + s * node(i + 1, j + 1)) + std::sqrt(squared);
  };
  double best = -1e300;
  for (int k = 0; k <= (kSide - 1) * kParts; ++k)
    for (int l = 0; l <= (kSide - 1) * kParts; ++l) {
      double u = static_cast<double>(k) / kParts, v = static_cast<double>(l) / kParts;
      double here = value(u, v);
      // Only what is highest among its neighbours is worth the search.
      double around = -1e300;
      for (int dk = -1; dk <= 1; ++dk)
        for (int dl = -1; dl <= 1; ++dl)
          around = std::max(around, value(u + static_cast<double>(dk) / kParts, v + static_cast<double>(dl) / kParts));
      if (here < around || here < -1e299) continue;
      for (double step = 1.0 / kParts; step > kFinest; step *= 0.5)
        for (bool higher = true; higher;) {
          higher = false;
          for (int way = 0; way < 8; ++way) {
            const double a = 0.25 * std::numbers::pi * way;
            const double next = value(u + step * std::cos(a), v + step * std::sin(a));
            if (!(next > here + kGain)) continue;
            here = next;
            u += step * std::cos(a);
            v += step * std::sin(a);
            higher = true;
          }
        }
      best = std::max(best, here);
    }
  return best - radius;
}

TEST(Fingertip, FindsTheHighestTopOnSaddlesThatAreSharperThanTheBall) {
  constexpr int kGrids = 4000;
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int touched_inside = 0;
  for (int grid = 0; grid < kGrids; ++grid) {
    const double radius = 0.15 * std::pow(6.5, share(random));
    const double rough = 0.1 * std::pow(80.0, share(random));
    const double slope = 3.0 * (share(random) - 0.5);
    std::vector<float> z;
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) z.push_back(static_cast<float>(rough * share(random) + slope * i));
    const double expected = searched(z, radius);
    std::vector<float> ball = z;
    touch_with_ball(ball, 3, 3, 1.0, radius);
    if (static_cast<double>(ball[4]) > static_cast<double>(z[4]) + 1e-3) ++touched_inside;
    // No place that was looked at is higher; the search itself may end on a steep edge a little below its highest
    // place.
    ASSERT_GE(ball[4], expected - 1e-6 * (1.0 + std::abs(expected))) << grid << " radius " << radius;
    ASSERT_LE(ball[4], expected + 0.01 * (1.0 + rough)) << grid << " radius " << radius;
  }
  EXPECT_GT(touched_inside, kGrids / 2);
}

TEST(Fingertip, OfABallThatIsFarLargerThanTheStoneLiesOnItsHighestPlaces) {
  // Squares of its radius in spacings are beyond a 32-bit number, and a table of its cap beyond any memory.
  std::vector<float> height(7 * 5, 0.0F);
  height[2 * 7 + 3] = 0.25F;
  touch_with_ball(height, 7, 5, 1e-9, 1e-3);
  for (const float z : height) EXPECT_NEAR(z, 0.25, 1e-6);
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

scene::ScenePointer grained_scene() {
  return sparsha::test::scene_of(
      [](double x, double y) {
        return sparsha::test::hills_m(x, y) + 0.0004 * std::sin(2100.0 * x) * std::sin(1700.0 * y);
      },
      801, 0.1, 101, Eigen::Vector3d(2.0, -1.0, 0.3),
      [](scene::SceneDescription& d) { d.config.haptics.tip_radius_m = 0.0007; });
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
      [](scene::SceneDescription& d) {
        d.config.friction = scene::FrictionConfig{};
        d.config.friction->law = scene::FrictionConfig::Law::constant;
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
