// Force against the closed form, on z = 0.05 sin(2 pi x) sin(2 pi y).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "haptics/proxy/proxy.h"
#include "tests/support/surfaces.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kDepth = 0.002;
constexpr double kHeight = 0.05;
// The largest principal curvature: that of the tops, in both directions alike.
constexpr double kKappa = kHeight * kTurn * kTurn;

struct Error {
  double mean = 0.0;
  double worst = 0.0;
  double worst_normal = 0.0;   ///< the part along the true normal: the force's magnitude
  double worst_tangent = 0.0;  ///< the part across it: the force's direction
};

/// Relative error of the force vector along the path, the hand `kDepth` under the true surface along its normal.
/// `curved_in_y`: the sinusoid in x and y; otherwise in x alone.
Error follow(int nodes, const SolverOptions& options, bool curved_in_y = true) {
  const auto along_y = [&](double y) { return curved_in_y ? std::sin(kTurn * y) : 1.0; };
  const auto slope_y = [&](double y) { return curved_in_y ? kTurn * std::cos(kTurn * y) : 0.0; };
  const MongeSurface surface = make_surface_of(
      nodes, nodes, 1.0 / (nodes - 1), [&](double x, double y) { return kHeight * std::sin(kTurn * x) * along_y(y); });
  ProxyState state;
  Error error;
  constexpr int kTicks = 20000;
  for (int k = 0; k < kTicks; ++k) {
    const double t = 0.001 * k;
    const double x = 0.5 + 0.37 * std::sin(0.9 * t + 0.3);
    const double y = 0.5 + 0.33 * std::sin(1.3 * t);
    const Vector3d foot(x, y, kHeight * std::sin(kTurn * x) * along_y(y));
    const Vector3d normal =
        Vector3d(-kHeight * kTurn * std::cos(kTurn * x) * along_y(y), -kHeight * std::sin(kTurn * x) * slope_y(y), 1.0)
            .normalized();
    const Vector3d hand = foot - kDepth * normal;
    if (k == 0) state = start_proxy(surface, hand);
    const ProxyUpdate update = update_exact(surface, hand, state, options);
    EXPECT_TRUE(update.contact);
    const Vector3d off = (update.position - foot) / kDepth;
    const double along = off.dot(normal);
    error.mean += off.norm() / kTicks;
    error.worst = std::max(error.worst, off.norm());
    error.worst_normal = std::max(error.worst_normal, std::abs(along));
    error.worst_tangent = std::max(error.worst_tangent, (off - along * normal).norm());
  }
  return error;
}

/// Parts of the bound of docs/touch.md for a surface curved by kappa in one direction, relative to the force.
struct Bound {
  double normal;   ///< h^2 kappa / 8
  double tangent;  ///< (h kappa / 2) depth / (1 - depth kappa)
};
Bound one_direction(int nodes) {
  const double h = 1.0 / (nodes - 1);
  return {h * h * kKappa / 8.0 / kDepth, h * kKappa / 2.0 / (1.0 - kDepth * kKappa)};
}

// Heights are floats: half an ulp of the tops.
constexpr double kRounding = 0.5 * std::numeric_limits<float>::epsilon() * kHeight / kDepth;

}  // namespace

TEST(Accuracy, OfTheBilinearForceStaysInsideItsBoundAndBelowThreePerMilleAtEightHundredNodes) {
  for (const int nodes : {100, 150, 200, 400, 800, 1600}) {
    const Error error = follow(nodes, {});
    // Two directions, equally curved: the height's errors add up, the slope's are the legs of a right angle, and where
    // one is largest the other is nothing.
    const Bound one = one_direction(nodes);
    const double normal = 2.0 * one.normal + kRounding;
    const double tangent = std::numbers::sqrt2 * one.tangent;
    std::printf("  %4d nodes: force error mean %.4f %%, worst %.4f %%, bound %.4f %%\n", nodes, 100 * error.mean,
                100 * error.worst, 100 * std::max(normal, tangent));
    EXPECT_LE(error.worst_normal, normal);
    EXPECT_LE(error.worst_tangent, tangent);
    EXPECT_LE(error.worst, std::max(normal, tangent));
    EXPECT_GE(error.worst, 0.9 * std::max(normal, tangent)) << "the bound is sharp";
    if (nodes == 800) {
      EXPECT_LE(error.mean, 0.003);
    }
  }
}

TEST(Accuracy, OnASurfaceCurvedInOneDirectionStaysInsideTheSumOfItsTwoParts) {
  for (const int nodes : {100, 200, 400, 800}) {
    const Error error = follow(nodes, {}, false);
    const Bound one = one_direction(nodes);
    EXPECT_LE(error.worst_normal, one.normal + kRounding);
    EXPECT_LE(error.worst_tangent, one.tangent + kRounding);
    EXPECT_LE(error.worst, one.normal + one.tangent);
  }
}

TEST(Accuracy, WhereASurfaceCurvesBothWaysNoBilinearForceKeepsToTheBoundOfOneDirection) {
  // Near the tops, where both principal curvatures are kappa, h^2 kappa / 8 + (h kappa / 2) depth / (1 - depth kappa)
  // is passed on coarse grids by the heights and on fine ones by the slopes.
  for (const int nodes : {101, 801}) {
    const Bound one = one_direction(nodes);
    EXPECT_GT(follow(nodes, {}).worst, 1.05 * (one.normal + one.tangent));
  }
}

TEST(Accuracy, OfTheC1ForceIsAHundredTimesBetter) {
  SolverOptions c1;
  c1.shape = CellShape::c1;
  EXPECT_LE(follow(200, c1).mean, 0.01 * follow(200, {}).mean);
}

}  // namespace sparsha::haptics::test
