// Force against the closed form, on z = 0.05 sin(2 pi x) sin(2 pi y).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "haptics/contact/proxy.h"
#include "surfaces.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kDepth = 0.002;

struct Error {
  double mean = 0.0;
  double worst = 0.0;
};

/// Relative force error along the path, the hand `kDepth` under the true surface along its normal.
Error follow(int nodes, const SolverOptions& options) {
  const MongeSurface surface = make_sinusoid(nodes);
  ProxyState state;
  Error error;
  constexpr int kTicks = 20000;
  for (int k = 0; k < kTicks; ++k) {
    const double t = 0.001 * k;
    const double x = 0.5 + 0.37 * std::sin(0.9 * t + 0.3);
    const double y = 0.5 + 0.33 * std::sin(1.3 * t);
    const Vector3d foot(x, y, 0.05 * std::sin(kTurn * x) * std::sin(kTurn * y));
    const Vector3d normal = Vector3d(-0.05 * kTurn * std::cos(kTurn * x) * std::sin(kTurn * y),
                                     -0.05 * kTurn * std::sin(kTurn * x) * std::cos(kTurn * y), 1.0)
                                .normalized();
    const Vector3d hand = foot - kDepth * normal;
    if (k == 0) state = start_proxy(surface, hand);
    const ProxyUpdate update = update_exact(surface, hand, state, options);
    EXPECT_TRUE(update.contact);
    const double relative = (update.position - foot).norm() / kDepth;
    error.mean += relative / kTicks;
    error.worst = std::max(error.worst, relative);
  }
  return error;
}

}  // namespace

TEST(Accuracy, OfTheBilinearForceStaysInsideItsBoundAndBelowThreePerMilleAtEightHundredNodes) {
  // The largest principal curvature is that of the tops, 0.05 (2 pi)^2, in both directions.
  const double kappa = 0.05 * kTurn * kTurn;
  for (const int nodes : {100, 200, 400, 800}) {
    const double h = 1.0 / (nodes - 1);
    const Error error = follow(nodes, {});
    // h^2 kappa / 8 a direction is the height's error, h kappa / 2 the slope's; two directions.
    const double bound = 2.0 * (h * h * kappa / 8.0 + h * kappa / 2.0 * kDepth / (1.0 - kDepth * kappa)) / kDepth;
    std::printf("  %4d nodes: force error mean %.3f %%, worst %.3f %%, bound %.3f %%\n", nodes, 100 * error.mean,
                100 * error.worst, 100 * bound);
    EXPECT_LE(error.worst, bound);
    if (nodes == 800) {
      EXPECT_LE(error.mean, 0.003);
    }
  }
}

TEST(Accuracy, OfTheC1ForceIsAHundredTimesBetter) {
  SolverOptions c1;
  c1.c1_surface = true;
  EXPECT_LE(follow(200, c1).mean, 0.01 * follow(200, {}).mean);
}

}  // namespace sparsha::haptics::test
