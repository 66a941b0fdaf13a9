// The source paper's iteration where its one projection per step would carry the proxy away: cliffs, spikes and steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "haptics/proxy/proxy.h"
#include "tests/support/surfaces.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

constexpr double kCell_m = 0.001;
constexpr int kNodes = 101;
constexpr double kMiddle_m = 0.05;
constexpr double kTick_m = 1e-4;  // 100 mm/s at a kilohertz

struct Stroke {
  double longest_move_m = 0.0;
  double beyond_m = 0.0;  ///< of any move over what its tick allows
  int unfinished = 0;
  int ticks = 0;
  double highest_m = 0.0;  ///< of the proxy
  Vector3d end_m = Vector3d::Zero();
};

/// The hand goes along x from 0.02 to 0.08 m at one depth below z = 0; what is counted is the proxy's.
Stroke stroke(const MongeSurface& surface, double depth_m, const SolverOptions& options, double tick_m = kTick_m) {
  Vector3d hand_m(0.02, kMiddle_m, -depth_m);
  ProxyState state = start_proxy(surface, hand_m);
  Stroke found;
  while (hand_m.x() < 0.08) {
    hand_m.x() += tick_m;
    const Vector3d before_m = state.position;
    const ProxyUpdate update = update_paper(surface, hand_m, state, options);
    EXPECT_TRUE(update.position.allFinite());
    const double move_m = (update.position - before_m).norm();
    found.longest_move_m = std::max(found.longest_move_m, move_m);
    found.beyond_m = std::max(found.beyond_m, move_m - 2.0 * (hand_m - before_m).norm() - kCell_m);
    found.unfinished += update.unfinished ? 1 : 0;
    found.highest_m = std::max(found.highest_m, update.position.z());
    ++found.ticks;
  }
  found.end_m = state.position;
  return found;
}

MongeSurface cliff(double height_m) {
  return make_surface_of(kNodes, kNodes, kCell_m,
                         [=](double x, double) { return x < kMiddle_m + 0.5 * kCell_m ? 0.0 : height_m; });
}
MongeSurface spike(double height_m) {
  return make_surface_of(kNodes, kNodes, kCell_m, [=](double x, double y) {
    return std::hypot(x - kMiddle_m, y - kMiddle_m) < 0.5 * kCell_m ? height_m : 0.0;
  });
}

constexpr double kRounding_m = 1e-12;

}  // namespace

TEST(Paper, ATickMovesTheProxyByNoMoreThanTwiceItsDistanceFromTheHandAndACell) {
  for (const double height_m : {0.01, 0.1, 1.0, 10.0, 1000.0, -0.1, -10.0})
    for (const double depth_m : {0.0005, 0.002, 0.01})
      for (const double friction : {0.0, 0.3})
        for (const int iterations : {1, 10, 100})
          for (const double rho : {0.1, 0.5, 1.0})
            for (const bool steep : {false, true}) {
              MongeSurface surface = steep ? cliff(height_m) : spike(height_m);
              if (friction > 0.0) set_friction(surface, friction, friction);
              SolverOptions options;
              options.paper_iterations = iterations;
              options.paper_rho = rho;
              const Stroke found = stroke(surface, depth_m, options);
              const std::string where = (steep ? "cliff " : "spike ") + std::to_string(height_m) + " m, depth " +
                                        std::to_string(depth_m) + ", friction " + std::to_string(friction) + ", rho " +
                                        std::to_string(rho) + ", " + std::to_string(iterations) + " iterations";
              EXPECT_LE(found.beyond_m, kRounding_m) << where;
              // The hand is at most its way into the cliff and its depth away: 30 mm.
              EXPECT_LE(found.longest_move_m, 0.07) << where;
            }
}

TEST(Paper, AHandThatRunsIntoACliffLeavesTheProxyAtItsFootAndEveryTickThereIsUnfinished) {
  for (const double height_m : {0.1, 1.0, 10.0}) {
    const Stroke found = stroke(cliff(height_m), 0.002, {});
    EXPECT_NEAR(found.end_m.x(), kMiddle_m, 2.0 * kCell_m) << height_m;
    // A step upwards is a tenth of the cliff at most, and falls back as the hand goes on.
    EXPECT_LE(found.highest_m, 0.03 + kCell_m) << height_m;
    EXPECT_GE(found.unfinished, static_cast<int>(0.9 * (0.08 - kMiddle_m) / kTick_m)) << height_m;
    EXPECT_LT(found.unfinished, found.ticks) << height_m << ": the flat ground before it is none";
  }
}

TEST(Paper, AHandThatJumpsIsNoExceptionToTheBound) {
  for (const double tick_m : {0.001, 0.01, 0.03}) {
    EXPECT_LE(stroke(cliff(10.0), 0.002, {}, tick_m).beyond_m, kRounding_m) << tick_m;
    EXPECT_LE(stroke(spike(1.0), 0.002, {}, tick_m).beyond_m, kRounding_m) << tick_m;
  }
}

TEST(Paper, OnSmoothGroundNoStepIsShortened) {
  // A shortened step would leave its tick unfinished; without friction the iteration creeps in flat places.
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> turn(-0.1, 0.1);
  MongeSurface surface = make_sinusoid(200);
  set_friction(surface, 0.5, 0.3);
  Vector3d hand_m(0.5, 0.5, surface.height(0.5, 0.5) - 0.002);
  ProxyState state = start_proxy(surface, hand_m);
  double heading = 0.0;
  for (int k = 0; k < 50'000; ++k) {
    heading += turn(random);
    if (hand_m.head<2>().cwiseAbs().maxCoeff() > 0.9 || hand_m.head<2>().minCoeff() < 0.1)
      heading = std::atan2(0.5 - hand_m.y(), 0.5 - hand_m.x());
    hand_m.head<2>() += 0.001 * Eigen::Vector2d(std::cos(heading), std::sin(heading));
    hand_m.z() = surface.height(hand_m.x(), hand_m.y()) - 0.002 * (0.5 + 0.5 * std::sin(0.01 * k));
    ASSERT_FALSE(update_paper(surface, hand_m, state, {}).unfinished) << k;
  }
}

}  // namespace sparsha::haptics::test
