// The bilinear surface with rounded creases (uniform cubic B-spline): what a hand feels by default. Oracles: the
// sphere's and the groove's own geometry, energy along closed ways, and sums of basis functions written out here.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "haptics/proxy/bicubic_patch.h"
#include "haptics/proxy/proxy.h"
#include "tests/support/surfaces.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kSpacing_m = 0.0009;

SolverOptions options_of(CellShape shape) {
  SolverOptions options;
  options.shape = shape;
  return options;
}

/// The uniform cubic B-spline's basis function, by its textbook pieces.
double b_spline(double x) {
  x = std::abs(x);
  if (x >= 2.0) return 0.0;
  return x < 1.0 ? 2.0 / 3.0 - x * x + 0.5 * x * x * x : std::pow(2.0 - x, 3) / 6.0;
}

/// A ball's top of 10 mm radius on the sample relief's spacing.
constexpr double kRadius_m = 0.010;
constexpr int kNodes = 41;
Vector3d ball_centre() {
  return {0.5 * (kNodes - 1) * kSpacing_m + 0.00013, 0.5 * (kNodes - 1) * kSpacing_m - 0.0002, 0.0};
}
MongeSurface ball() {
  return make_surface_of(kNodes, kNodes, kSpacing_m, [](double x, double y) {
    const double r2 = (Eigen::Vector2d(x, y) - ball_centre().head<2>()).squaredNorm();
    return std::sqrt(std::max(kRadius_m * kRadius_m - r2, 1e-6));
  });
}

/// The largest change of the force between two places of the hand 5 um apart, of the force, on great circles of the
/// true ball `depth` under its surface.
double largest_jump(const MongeSurface& surface, double depth_m, CellShape shape) {
  double worst = 0.0;
  for (int way = 0; way < 12; ++way) {
    const double angle = way * kPi / 6.0 + 0.1;
    const Vector3d along(std::cos(angle), std::sin(angle), 0.0);
    const double radius = kRadius_m - depth_m;
    const Vector3d side = 0.0002 * (way % 5) * Vector3d(-along.y(), along.x(), 0.0);
    ProxyState state;
    Vector3d last = Vector3d::Zero();
    bool first = true;
    for (double phi = -0.5; phi <= 0.5; phi += 5e-6 / radius, first = false) {
      const Vector3d hand = ball_centre() + side + radius * (std::sin(phi) * along + std::cos(phi) * Vector3d::UnitZ());
      if (first) state = start_proxy(surface, hand + Vector3d(0, 0, 0.01));
      const Vector3d force = update_exact(surface, hand, state, options_of(shape)).position - hand;
      if (!first) worst = std::max(worst, (force - last).norm() / force.norm());
      last = force;
    }
  }
  return worst;
}

/// Drag over press along the bottom of a groove with walls of 22.5 degrees, `heading` from the grid's x.
struct Drag {
  double low = 1e9;
  double high = -1e9;
};
Drag drag_in_groove(double heading, double depth_m, double mu, double beside, CellShape shape) {
  const Vector3d along(std::cos(heading), std::sin(heading), 0.0);
  const double middle = 0.5 * (kNodes - 1) * kSpacing_m;
  MongeSurface surface = make_surface_of(kNodes, kNodes, kSpacing_m, [&](double x, double y) {
    return std::tan(kPi / 8) * std::abs(-(x - middle) * along.y() + (y - middle - beside * kSpacing_m) * along.x());
  });
  surface.mu_dynamic.assign(surface.lattice.count(), static_cast<float>(mu));
  surface.mu_static = surface.mu_dynamic;
  Drag drag;
  ProxyState state;
  for (int k = 0; k <= 160; ++k) {
    const double way = -0.008 + 0.0001 * k;
    const Vector3d hand =
        Vector3d(middle, middle + beside * kSpacing_m / std::max(0.1, along.x()) * along.x(), -depth_m) + way * along;
    if (k == 0) state = start_proxy(surface, hand + Vector3d(0, 0, 0.01));
    const Vector3d force = update_exact(surface, hand, state, options_of(shape)).position - hand;
    if (k < 60) continue;  // until friction drags the whole way behind
    drag.low = std::min(drag.low, -force.dot(along) / force.z());
    drag.high = std::max(drag.high, -force.dot(along) / force.z());
  }
  return drag;
}

}  // namespace

TEST(RoundedSurface, IsTheSumOfTheBasisFunctionsOverTheNodes) {
  std::mt19937_64 random(71);
  const MongeSurface rough = make_rough_surface(14, 0.5, 1.0, random);
  const RoundedSurface surface(rough);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int k = 0; k < 300; ++k) {
    const int i = 1 + k % 11;
    const int j = 1 + (k / 11) % 11;
    const double s = uniform(random);
    const double t = uniform(random);
    double expected = 0.0;
    for (int b = j - 1; b <= j + 2; ++b)
      for (int a = i - 1; a <= i + 2; ++a)
        expected += b_spline(i + s - a) * b_spline(j + t - b) * surface.height_at(a, b);
    EXPECT_NEAR(surface.patch(i, j).height(s, t), expected, 1e-13);
    EXPECT_NEAR(touched_height(rough, (i + s) * 0.5, (j + t) * 0.5, CellShape::rounded), 0.5 * expected, 1e-12);
  }
}

template <CubicBasis kBasis>
void expect_bands_are_the_patch(std::mt19937_64& random) {
  const MongeSurface rough = make_rough_surface(9, 0.25, 1.0, random);
  const BicubicSurface<kBasis> surface(rough);
  for (int j = 1; j < 7; ++j)
    for (int i = 1; i < 7; ++i) {
      ASSERT_TRUE(surface.is_deep(i, j));
      const BicubicPatch patch = surface.patch(i, j);
      const auto bands = surface.bands(i, j);
      double top = -1e9;
      for (const double s : {0.0, 0.13, 0.5, 0.99})
        for (const double t : {0.0, 0.31, 0.77, 1.0}) {
          const PatchDerivatives at = bands.at(s, t);
          EXPECT_NEAR(at.z, patch.height(s, t), 1e-12);
          EXPECT_NEAR(at.fs, patch.slope_s(s, t), 1e-12);
          EXPECT_NEAR(at.ft, patch.slope_t(s, t), 1e-12);
          EXPECT_NEAR(at.fss, patch.second_ss(s, t), 1e-12);
          EXPECT_NEAR(at.fst, patch.second_st(s, t), 1e-12);
          EXPECT_NEAR(at.ftt, patch.second_tt(s, t), 1e-12);
          top = std::max(top, at.z);
        }
      EXPECT_FALSE(surface.is_below(i, j, top)) << "what is not clear may not be flown through";
      EXPECT_TRUE(surface.is_below(i, j, 30.0));
    }
  EXPECT_FALSE(surface.is_deep(0, 3));
  EXPECT_FALSE(surface.is_deep(7, 3));
}

TEST(SmoothPatches, OfTheFastPathAreThoseOfTheGeneralSteps) {
  std::mt19937_64 random(72);
  expect_bands_are_the_patch<CubicBasis::b_spline>(random);
  expect_bands_are_the_patch<CubicBasis::catmull_rom>(random);
}

TEST(RoundedSurface, GivesNoJumpsOfForceOnABallWhereSharpCreasesJumpByATenth) {
  const MongeSurface surface = ball();
  for (const double depth_m : {0.0005, 0.002, 0.005}) {
    const double sharp = largest_jump(surface, depth_m, CellShape::bilinear);
    const double rounded = largest_jump(surface, depth_m, CellShape::rounded);
    std::printf("  ball of 10 mm, nodes 0.9 mm apart, %.1f mm deep: largest jump %.2f %% sharp, %.3f %% rounded\n",
                1e3 * depth_m, 100.0 * sharp, 100.0 * rounded);
    EXPECT_GT(sharp, 0.05) << "otherwise this proves nothing";
    EXPECT_LT(rounded, 0.01);
  }
}

TEST(RoundedSurface, DragsAlikeInAGrooveAtAnyHeading) {
  constexpr double kMu = 0.3;
  double sharp = 0.0;
  double worst = 0.0;
  for (int heading = 0; heading <= 12; ++heading)
    for (const double depth_m : {0.0005, 0.002})
      for (const double beside : {0.0, 0.5}) {
        const double angle = heading * kPi / 24.0;
        const Drag rounded = drag_in_groove(angle, depth_m, kMu, beside, CellShape::rounded);
        const Drag bilinear = drag_in_groove(angle, depth_m, kMu, beside, CellShape::bilinear);
        worst = std::max({worst, rounded.high - kMu, kMu - rounded.low});
        sharp = std::max({sharp, bilinear.high - kMu, kMu - bilinear.low});
        EXPECT_LE(rounded.high, kMu + 0.06) << 7.5 * heading << " degrees, depth " << depth_m << ", " << beside;
        EXPECT_GE(rounded.low, kMu - 0.06) << 7.5 * heading << " degrees, depth " << depth_m << ", " << beside;
      }
  std::printf("  drag over press in a groove, mu 0.3, off by at most %.2f sharp, %.3f rounded\n", sharp, worst);
  EXPECT_GT(sharp, 0.3) << "otherwise this proves nothing";
}

TEST(RoundedSurface, GivesBackOnAClosedWayWhatItTook) {
  // Rough ground and a way that comes and goes at different depths: any force that is no potential's gains or loses.
  std::mt19937_64 random(73);
  const MongeSurface surface = make_rough_surface(31, kSpacing_m, 0.0002, random);
  const Vector3d middle(15.3 * kSpacing_m, 14.6 * kSpacing_m, -0.0015);
  const auto work_of = [&](CellShape shape) {
    ProxyState state;
    double work = 0.0;
    Vector3d last_hand = Vector3d::Zero();
    Vector3d last_force = Vector3d::Zero();
    constexpr int kTurn = 200000;
    for (int k = 0; k <= kTurn + kTurn / 10; ++k) {
      const double a = 2.0 * kPi * k / kTurn;
      const Vector3d hand =
          middle + Vector3d(0.004 * std::cos(a), 0.003 * std::sin(a), 0.0005 * std::sin(2.0 * a + 0.4));
      if (k == 0) state = start_proxy(surface, hand + Vector3d(0, 0, 0.01));
      const Vector3d force = update_exact(surface, hand, state, options_of(shape)).position - hand;
      if (k > kTurn / 10) work += 0.5 * (force + last_force).dot(hand - last_hand);
      last_hand = hand;
      last_force = force;
    }
    return work;
  };
  const double energy = 0.5 * 0.0015 * 0.0015;  // of a spring of 1 N/m at that depth
  EXPECT_LT(std::abs(work_of(CellShape::rounded)), 1e-4 * energy);
}

}  // namespace sparsha::haptics::test
