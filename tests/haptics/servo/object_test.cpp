// A hand on a whole object through the renderer: force on every side of a ball whose truth is a formula, turning,
// starting inside, faults, the end of a surface, and the cell that is recorded.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "haptics/around/object_surface.h"
#include "haptics/window/window.h"
#include "tests/support/driven_hand.h"
#include "tests/support/resting_hand.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::haptics {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using sparsha::test::Driven;
using sparsha::test::HandAtRest;
using sparsha::test::RestingHand;
using sparsha::test::turn;
using sparsha::test::turn_of;
using sparsha::test::vector;
using sparsha::test::window_of;

constexpr double kBall_m = 0.04;
constexpr double kDegree = 3.14159265358979323846 / 180.0;

scene::ScenePointer ball() {
  static const scene::ScenePointer scene = sparsha::test::whole_scene(sparsha::test::ball_charts(kBall_m));
  return scene;
}

TEST(ObjectTouch, EverySideOfABallPushesAlongItsRadiusHoweverItIsTurned) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Driven hand(window_of(ball()));
  hand.stay(2);
  for (int k = 0; k < 24; ++k) {
    const Quaterniond to = Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
    hand.go({0.0, 0.0, 0.03});
    turn(hand.renderer, to);
    hand.stay(200);
    ASSERT_LT((turn_of(hand.state()).coeffs() - to.coeffs()).norm(), 1e-12);
    EXPECT_EQ(hand.state().contact, 0U);
    // Down on the side that is before the hand now, then a quarter of the way around.
    const Vector3d middle = hand.to_device(Vector3d::Zero());
    const Vector3d first(normal(random), normal(random), 2.0 + std::abs(normal(random)));
    const double scale = hand.state().scale;
    Vector3d way = first.normalized();
    hand.go(middle + (scale * kBall_m + 0.01) * way);
    hand.go(middle + (scale * kBall_m - 0.0015) * way);
    for (int step = 0; step < 300; ++step) {
      way = (Eigen::AngleAxisd(0.3 * kDegree, Vector3d(0.2, 1.0, 0.1).normalized()) * way).normalized();
      hand.at(middle + (scale * kBall_m - 0.0015) * way);
      const State& s = hand.state();
      ASSERT_EQ(s.contact, 1U) << k << ", " << step;
      const Vector3d expected = s.stiffness_n_per_m * 0.0015 * way;
      ASSERT_LT((vector(s.force_n) - expected).norm(), 0.05 * expected.norm()) << k << ", " << step;
      ASSERT_LT((vector(s.normal) - turn_of(s).conjugate() * way).norm(), 0.05);
      ASSERT_NEAR(vector(s.proxy_m).norm(), kBall_m, 1e-4);
      ASSERT_LT((vector(s.hip_m) - hand.to_grid(middle + (scale * kBall_m - 0.0015) * way)).norm(), 1e-12);
      ASSERT_NE(s.flags & kFlagAround, 0U);
      ASSERT_NE(s.flags & kFlagArmed, 0U);
    }
    hand.go(middle + (scale * kBall_m + 0.02) * way);
    EXPECT_EQ(vector(hand.state().commanded_force_n).norm(), 0.0);
  }
}

TEST(ObjectTouch, TurningReleasesAPressedHandWithoutAStepAndLeavesItInTheAirBeforeTheObject) {
  for (const double press_n : {0.5, 1.5, 3.0})
    for (const double degrees : {15.0, 90.0, 180.0}) {
      HandAtRest hand(RestingHand{}, window_of(ball()));
      hand.put_down(0.01, -0.006, press_n);
      ASSERT_EQ(hand.renderer().state().contact, 1U);
      const Vector3d middle = -hand.renderer().state().scale * vector(hand.renderer().state().centre_m);
      turn(hand.renderer(), Quaterniond(Eigen::AngleAxisd(degrees * kDegree, Vector3d::UnitY())));
      Vector3d last = hand.force();
      double step_n = 0.0, zero_s = 1.0;
      hand.run(0.5, [&](double t) {
        step_n = std::max(step_n, (hand.force() - last).norm());
        last = hand.force();
        if (t < 0.01) return;
        if (hand.force().norm() < 0.05) zero_s = std::min(zero_s, t);
      });
      const State& s = hand.renderer().state();
      EXPECT_LE(step_n, 0.05) << press_n << " N, " << degrees;
      EXPECT_NEAR(std::abs(turn_of(s).w()), std::cos(0.5 * degrees * kDegree), 1e-12);
      const Vector3d now = s.scale * (turn_of(s) * -vector(s.centre_m));
      EXPECT_LT((now - middle).head<2>().norm(), 1e-9) << "the middle stays where it was across the view";
    }
}

TEST(ObjectTouch, AHandThatStartsInsideGetsNoForceAndIsPutBeforeTheObject) {
  for (const Vector3d& inside :
       {Vector3d(0.0, 0.0, -0.03), Vector3d(0.01, 0.005, -0.001), Vector3d(-0.02, 0.0, -0.05)}) {
    Driven hand(window_of(ball()));
    double most_n = 0.0;
    for (int k = 0; k < 300; ++k) {
      hand.at(inside);
      most_n = std::max(most_n, vector(hand.state().commanded_force_n).norm());
    }
    EXPECT_EQ(most_n, 0.0);
    EXPECT_EQ(hand.state().contact, 0U);
    EXPECT_GT(vector(hand.state().hip_m).norm(), kBall_m);
    EXPECT_LT(vector(hand.state().hip_m).norm(), 2.0 * kBall_m);
    hand.go(inside + Vector3d(0.0, 0.0, 0.005));
    hand.go(inside - Vector3d(0.0, 0.0, 0.003));
    EXPECT_EQ(hand.state().contact, 1U) << "it is touched from outside";
    EXPECT_GT(vector(hand.state().commanded_force_n).z(), 0.1);
  }
}

TEST(ObjectTouch, FaultsEndInZeroForceUntilTheHandHasBeenInTheAir) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int kind = 0; kind < 4; ++kind) {
    Driven hand(window_of(ball()));
    hand.stay(2);
    hand.go({0.0, 0.0, -0.002});
    hand.stay(50);
    ASSERT_GT(vector(hand.state().commanded_force_n).z(), 0.5);
    DeviceSample sample = sample_at({0.0, 0.0, -0.002}, hand.state().time_s + 0.001);
    if (kind == 0) sample.position_m.y() = nan;
    if (kind == 1) sample.connected = false;
    if (kind == 2) sample.homed = false;
    if (kind == 3) sample.time_s += 0.5;
    hand.renderer.update(sample, 0.001);
    EXPECT_EQ(vector(hand.state().commanded_force_n).norm(), 0.0) << kind;
    for (int k = 0; k < 100; ++k) {
      hand.renderer.update(sample_at({0.0, 0.0, -0.002}, sample.time_s + 0.001 * (k + 1)), 0.001);
      ASSERT_EQ(vector(hand.state().commanded_force_n).norm(), 0.0) << kind;
    }
  }
  Driven hand(window_of(ball()));
  hand.stay(2);
  hand.go({0.0, 0.0, -0.002});
  for (int k = 0; k < 200; ++k) {
    DeviceSample stale = sample_at({0.0, 0.0, -0.002}, hand.state().time_s + 0.001);
    stale.fresh = false;
    hand.renderer.update(stale, 0.001);
  }
  EXPECT_EQ(vector(hand.state().commanded_force_n).norm(), 0.0) << "stale data";
}

TEST(ObjectTouch, WhereTheScanEndsUnderAPressedHandTheForceFadesAndDoesNotDrop) {
  // Half a ball without its back: the hand is pressed in deep and pulled over the border.
  const scene::ScenePointer open = sparsha::test::whole_scene(sparsha::test::charts_of(
      [](scene::Side side, double u, double v) -> std::optional<sparsha::test::SeenSurface> {
        if (side != scene::Side::front || u > 0.01) return std::nullopt;
        const double w = std::sqrt(std::max(0.0, kBall_m * kBall_m - u * u - v * v));
        if (w < 0.4 * kBall_m) return std::nullopt;
        return sparsha::test::SeenSurface{w, -u / w, -v / w};
      },
      42, 0.001));
  for (const double depth_m : {0.001, 0.003, 0.008}) {
    Driven hand(window_of(open));
    hand.stay(2);
    hand.go({0.0135, 0.0, 0.01});  // the device's origin is before the middle of what was scanned
    hand.go({0.0135, 0.0, -depth_m});
    hand.stay(50);
    Vector3d last = vector(hand.state().commanded_force_n);
    ASSERT_GT(last.norm(), 0.4);
    double worst_n = 0.0;
    bool let_go = false;
    for (double x = 0.0135; x < 0.035; x += 0.00002) {
      hand.at({x, 0.0, -depth_m});
      const Vector3d now = vector(hand.state().commanded_force_n);
      worst_n = std::max(worst_n, (now - last).norm());
      last = now;
      let_go = let_go || hand.state().contact == 0;
    }
    hand.stay(500);
    EXPECT_TRUE(let_go);
    EXPECT_EQ(vector(hand.state().commanded_force_n).norm(), 0.0);
    // 20 um a tick at 800 N/m explain 0.016 N.
    EXPECT_LE(worst_n, 0.066) << depth_m;
  }
}

TEST(ObjectTouch, ANearerViewKeepsTheTouchedPlaceUnderTheHand) {
  Driven hand(window_of(ball()));
  hand.stay(2);
  turn(hand.renderer, Quaterniond(Eigen::AngleAxisd(70.0 * kDegree, Vector3d(0.3, 1.0, 0.2).normalized())));
  hand.stay(2);
  hand.go({0.004, 0.003, -0.001});
  hand.stay(20);
  ASSERT_EQ(hand.state().contact, 1U);
  const Vector3d touched = vector(hand.state().proxy_m);
  const Vector3d under = hand.to_device(touched);
  Command swap;
  swap.kind = Command::Kind::swap;
  swap.window = window_of(ball(), 2, 0.2);
  static_cast<void>(hand.renderer.apply(swap));
  hand.stay(1);
  EXPECT_NEAR(hand.state().scale, 2.0, 0.05);
  EXPECT_LT((hand.to_device(touched) - under).norm(), 1e-9);
  EXPECT_EQ(hand.state().contact, 1U);
  EXPECT_LT((vector(hand.state().proxy_m) - touched).norm(), 1e-4);
  EXPECT_EQ(hand.state().flags & kFlagPlaced, 0U);
}

TEST(ObjectTouch, ItGoesToOneViewAndBackWithoutForceForAHandAtRest) {
  const scene::ScenePointer flat = sparsha::test::flat_scene();
  HandAtRest hand(RestingHand{}, window_of(ball()));
  hand.put_down(0.0, 0.0, 1.5);
  Vector3d last = hand.force();
  double step_n = 0.0;
  const auto watch = [&](double) {
    step_n = std::max(step_n, (hand.force() - last).norm());
    last = hand.force();
  };
  for (int k = 0; k < 4; ++k) {
    Command swap;
    swap.kind = Command::Kind::swap;
    swap.window = k % 2 == 0 ? window_of(flat, static_cast<std::uint64_t>(k) + 2)
                             : window_of(ball(), static_cast<std::uint64_t>(k) + 2);
    static_cast<void>(hand.renderer().apply(swap));
    hand.run(0.4, watch);
    EXPECT_TRUE(vector(hand.renderer().state().proxy_m).allFinite());
  }
  EXPECT_LE(step_n, 0.05);
}

TEST(ObjectTouch, ItsTextureGoesAndComesWithoutAStepForAHandAtRest) {
  scene::Charts charts = sparsha::test::ball_charts(kBall_m);
  for (scene::Sheet& sheet : charts.sheets) sheet.texture_m.assign(sheet.count(), 0.0006F);
  const scene::ScenePointer scene = sparsha::test::whole_scene(std::move(charts));
  const auto window = [&](bool texture, std::uint64_t id) {
    const scene::SceneDescription& description = scene->description();
    WindowPlan plan = plan_window(description, overview_level(description), Eigen::Vector2d::Zero(), 0.1);
    plan.effects.texture = texture;
    return load_window(*scene, plan, id);
  };
  HandAtRest hand(RestingHand{}, window(true, 1));
  hand.put_down(0.0, 0.0, 1.5);
  Vector3d last = hand.force();
  const double began_m = hand.renderer().state().device_m[2];
  double step_n = 0.0, sunk_m = 0.0;
  for (std::uint64_t k = 0; k < 4; ++k) {
    Command swap;
    swap.kind = Command::Kind::swap;
    swap.window = window(k % 2 == 1, k + 2);
    static_cast<void>(hand.renderer().apply(swap));
    hand.run(0.5, [&](double) {
      step_n = std::max(step_n, (hand.force() - last).norm());
      last = hand.force();
    });
    sunk_m = std::max(sunk_m, began_m - hand.renderer().state().device_m[2]);
  }
  EXPECT_LE(step_n, 0.05);
  EXPECT_GT(sunk_m, 0.0002) << "the texture has gone meanwhile";
}

TEST(ObjectTouch, AHandThatRestsBesideASeamDoesNotSlip) {
  // Two sides that are apart by a tenth of a millimetre where they meet.
  const auto seen = [](scene::Side side, double u, double v) -> std::optional<sparsha::test::SeenSurface> {
    const double radius_m = side == scene::Side::right ? kBall_m + 0.0001 : kBall_m;
    const double w = std::sqrt(std::max(0.0, radius_m * radius_m - u * u - v * v));
    if (w < 0.4 * radius_m) return std::nullopt;
    return sparsha::test::SeenSurface{w, -u / w, -v / w};
  };
  const scene::ScenePointer scene = sparsha::test::whole_scene(sparsha::test::charts_of(seen, 42, 0.001));
  Driven hand(window_of(scene));
  hand.stay(2);
  const Vector3d middle = hand.to_device(Vector3d::Zero());
  const double scale = hand.state().scale;
  const auto at = [&](double degrees, double over_m) {
    return Vector3d(middle + (scale * kBall_m + over_m) *
                                 Vector3d(std::sin(degrees * kDegree), 0.0, std::cos(degrees * kDegree)));
  };
  hand.go(at(20.0, 0.01));
  hand.stay(60);
  hand.go(at(20.0, -0.001));
  double slips_m_per_s = 0.0;
  for (double degrees = 20.0; degrees < 70.0; degrees += 0.5) {
    hand.go(at(degrees, -0.001));
    hand.stay(100);
    ASSERT_EQ(hand.state().contact, 1U) << degrees;
    slips_m_per_s = std::max(slips_m_per_s, hand.state().slip_speed_m_per_s);
  }
  EXPECT_LT(slips_m_per_s, 0.001);
}

TEST(ObjectTouch, TurnsThatAreNoRotationChangeNothing) {
  Driven hand(window_of(ball()));
  hand.stay(2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Quaterniond& bad : {Quaterniond(nan, 0.0, 0.0, 1.0), Quaterniond(0.0, 0.0, 0.0, 0.0)}) {
    turn(hand.renderer, bad);
    hand.stay(2);
    EXPECT_EQ(hand.state().turn, (std::array<double, 4>{0.0, 0.0, 0.0, 1.0}));
  }
}

}  // namespace
}  // namespace sparsha::haptics
