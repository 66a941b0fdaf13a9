#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "haptics/proxy/bicubic_patch.h"
#include "haptics/proxy/proxy.h"
#include "haptics/proxy/rest_residual.h"
#include "tests/support/surfaces.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

SolverOptions options_of(CellShape shape) {
  SolverOptions options;
  options.shape = shape;
  return options;
}
SolverOptions c1_options() { return options_of(CellShape::c1); }

struct Roughness {
  double jump = 0.0;        ///< largest change of force between ticks, beyond what the true surface gives, of the force
  double hysteresis = 0.0;  ///< largest difference between there and back at the same hand, of the force
};

/// Strokes over the dome of the sinusoid, there and back, at depth * kappa = 0.63 of its top.
Roughness stroke(const MongeSurface& surface, const SolverOptions& options) {
  constexpr double kCurvature = 0.05 * 4.0 * std::numbers::pi * std::numbers::pi;
  const double depth = 0.63 / kCurvature;
  constexpr int kTicks = 20000;
  std::vector<Vector3d> hands;
  for (int k = 0; k < kTicks; ++k) {
    const double x = 0.2 + 0.1 * k / kTicks;
    hands.push_back({x, 0.2371 + 0.31 * (x - 0.2), 0.05 - depth});
  }
  std::vector<Vector3d> there(hands.size());
  ProxyState state = start_proxy(surface, hands[0] + Vector3d(0, 0, 0.2));
  Vector3d last = Vector3d::Zero();
  Roughness rough;
  for (std::size_t k = 0; k < hands.size(); ++k) {
    there[k] = update_exact(surface, hands[k], state, options).position - hands[k];
    // The proxy of the true dome moves by at most 1 / (1 - 0.63) of the hand's step.
    if (k > 0) {
      const double smooth = 4.0 * (hands[k] - hands[k - 1]).norm();
      rough.jump = std::max(rough.jump, ((there[k] - last).norm() - smooth) / there[k].norm());
    }
    last = there[k];
  }
  for (std::size_t k = hands.size(); k-- > 0;) {
    const Vector3d back = update_exact(surface, hands[k], state, options).position - hands[k];
    rough.hysteresis = std::max(rough.hysteresis, (back - there[k]).norm() / back.norm());
  }
  return rough;
}

}  // namespace

TEST(C1Surface, PassesThroughTheNodesWithContinuousSlopes) {
  std::mt19937_64 random(41);
  const MongeSurface rough = make_rough_surface(12, 0.5, 1.0, random);
  const C1Surface surface(rough);
  constexpr double kRounding = 1e-13;
  for (int j = 0; j + 1 < 12; ++j)
    for (int i = 0; i + 1 < 12; ++i) {
      const BicubicPatch patch = surface.patch(i, j);
      EXPECT_NEAR(patch.height(0, 0), surface.height_at(i, j), kRounding);
      EXPECT_NEAR(patch.height(1, 1), surface.height_at(i + 1, j + 1), kRounding);
      if (i + 2 >= 12 || j + 2 >= 12) continue;
      const BicubicPatch right = surface.patch(i + 1, j);
      const BicubicPatch above = surface.patch(i, j + 1);
      for (const double u : {0.0, 0.3, 0.7}) {
        EXPECT_NEAR(patch.slope_s(1, u), right.slope_s(0, u), kRounding);
        EXPECT_NEAR(patch.slope_t(1, u), right.slope_t(0, u), kRounding);
        EXPECT_NEAR(patch.slope_s(u, 1), above.slope_s(u, 0), kRounding);
        EXPECT_NEAR(patch.slope_t(u, 1), above.slope_t(u, 0), kRounding);
      }
    }
}

TEST(C1Surface, DerivativesAreThoseOfItsHeights) {
  std::mt19937_64 random(42);
  const MongeSurface rough = make_rough_surface(8, 1.0, 2.0, random);
  const BicubicPatch patch = C1Surface(rough).patch(3, 4);
  constexpr double kStep = 1e-5;
  for (const double s : {0.1, 0.5, 0.9})
    for (const double t : {0.2, 0.6}) {
      EXPECT_NEAR(patch.slope_s(s, t), (patch.height(s + kStep, t) - patch.height(s - kStep, t)) / (2 * kStep), 1e-8);
      EXPECT_NEAR(patch.slope_t(s, t), (patch.height(s, t + kStep) - patch.height(s, t - kStep)) / (2 * kStep), 1e-8);
      EXPECT_NEAR(patch.second_ss(s, t), (patch.slope_s(s + kStep, t) - patch.slope_s(s - kStep, t)) / (2 * kStep),
                  1e-7);
      EXPECT_NEAR(patch.second_tt(s, t), (patch.slope_t(s, t + kStep) - patch.slope_t(s, t - kStep)) / (2 * kStep),
                  1e-7);
      EXPECT_NEAR(patch.second_st(s, t), (patch.slope_s(s, t + kStep) - patch.slope_s(s, t - kStep)) / (2 * kStep),
                  1e-7);
    }
}

TEST(C1Surface, BringsForceJumpAndHysteresisUnderHalfAPercent) {
  const MongeSurface surface = make_sinusoid(200);
  const Roughness bilinear = stroke(surface, {});
  const Roughness smooth = stroke(surface, c1_options());
  std::printf(
      "  depth * kappa 0.63, 200 nodes: bilinear jump %.2f %% hysteresis %.2f %%, C1 jump %.3f %% hysteresis %.3f %%\n",
      100 * bilinear.jump, 100 * bilinear.hysteresis, 100 * smooth.jump, 100 * smooth.hysteresis);
  EXPECT_GT(bilinear.jump, 0.005) << "otherwise this proves nothing";
  EXPECT_LT(smooth.jump, 0.005);
  EXPECT_LT(smooth.hysteresis, 0.005);
}

class SmoothSurface : public ::testing::TestWithParam<CellShape> {};

TEST_P(SmoothSurface, RestsAndStaysAboveAtRandomMovesOnSmoothAndRoughGround) {
  std::mt19937_64 random(43);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::uint64_t unfinished = 0;
  std::uint64_t moves = 0;
  for (int run = 0; run < 24; ++run) {
    MongeSurface surface = run % 3 == 0   ? make_sinusoid(60)
                           : run % 3 == 1 ? make_fractal_surface(65, 1.0 / 64, 0.1, random)
                                          : make_rough_surface(50, 1.0 / 49, 0.06 * uniform(random), random);
    if (run % 2 == 0) set_random_friction(surface, 0.8, random);
    ProxyState state = start_proxy(surface, {0.5, 0.5, 0.0});
    double x = 0.5;
    double y = 0.5;
    for (int k = 0; k < 1000; ++k, ++moves) {
      // Leaps, and every other run strokes of a fraction of a cell, which the fast path takes.
      if (run % 4 < 2 || k % 100 == 0) {
        x = 1.2 * uniform(random) - 0.1;
        y = 1.2 * uniform(random) - 0.1;
      } else {
        x += 0.01 * (uniform(random) - 0.5);
        y += 0.01 * (uniform(random) - 0.5);
      }
      const Vector3d hand(x, y, surface.height(x, y) + 0.03 * (uniform(random) - 0.8));
      const ProxyUpdate update = update_exact(surface, hand, state, options_of(GetParam()));
      ASSERT_TRUE(update.position.allFinite());
      if (update.unfinished) {
        ++unfinished;
        continue;
      }
      if (!update.contact) {
        ASSERT_EQ(update.position, hand);
        continue;
      }
      const RestResidual residual = rest_residual(surface, update, hand, GetParam());
      ASSERT_LE(residual.excess_cells, 1.1e-9) << "run " << run << " move " << k;
      ASSERT_EQ(residual.below_cells, 0.0) << "run " << run << " move " << k;
    }
  }
  EXPECT_LE(unfinished, moves / 1000);
}

INSTANTIATE_TEST_SUITE_P(Shapes, SmoothSurface, ::testing::Values(CellShape::c1, CellShape::rounded),
                         [](const auto& shape) { return shape.param == CellShape::c1 ? "C1" : "Rounded"; });

TEST(C1Surface, APlaneStaysAPlaneUpToTheBorder) {
  const MongeSurface plane = make_surface_of(20, 20, 0.0625, [](double x, double y) { return 0.5 * x - 0.25 * y; });
  const Vector3d normal = Vector3d(-0.5, 0.25, 1.0).normalized();
  ProxyState state = start_proxy(plane, {0.1, 0.1, 1.0});
  for (double x = 0.08; x < 1.1; x += 0.013) {
    const Vector3d foot(x, 0.3, 0.5 * x - 0.075);
    const ProxyUpdate update = update_exact(plane, foot - 0.01 * normal, state, c1_options());
    EXPECT_LE((update.position - foot).norm(), 1e-12);
  }
}

}  // namespace sparsha::haptics::test
