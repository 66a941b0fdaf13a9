#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "haptics/proxy/proxy.h"
#include "tests/support/rest_oracle.h"
#include "tests/support/surfaces.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

/// An inclined plane of 60 x 60 nodes with its unit normal; float heights of these slopes are exact.
struct Incline {
  double h;
  double gx;
  double gy;
  MongeSurface surface;
  Vector3d normal;

  Incline(double spacing_m, double slope_x, double slope_y, double mu_static, double mu_dynamic)
      : h(spacing_m),
        gx(slope_x),
        gy(slope_y),
        surface(make_surface_of(60, 60, h, [&](double x, double y) { return gx * x + gy * y; })),
        normal(Vector3d(-gx, -gy, 1.0).normalized()) {
    set_friction(surface, mu_static, mu_dynamic);
  }
  [[nodiscard]] Vector3d at(double x, double y) const { return {x, y, gx * x + gy * y}; }
};

}  // namespace

TEST(FrictionAtContact, LagsByMuTimesDepthOnPlanes) {
  for (const auto& [gx, gy] : {std::pair{0.0, 0.0}, {0.5, 0.0}, {-0.25, 1.5}, {2.0, -3.0}})
    for (const double mu : {0.01, 0.2, 0.9}) {
      const Incline plane(0.0078125, gx, gy, mu, mu);
      const double mu_exact = static_cast<double>(static_cast<float>(mu));
      const double depth = 1.5 * plane.h;
      const Vector3d start = plane.at(10 * plane.h, 12 * plane.h);
      const Vector3d end = plane.at(48 * plane.h, 43.7 * plane.h);
      const Vector3d direction = (end - start).normalized();
      ProxyState state = start_proxy(plane.surface, start + 0.1 * plane.h * plane.normal);
      ProxyUpdate update;
      const double length = (end - start).norm();
      for (double along = 0.0; along < length; along += 0.21 * plane.h) {
        const Vector3d foot = start + along * direction;
        update = update_exact(plane.surface, foot - depth * plane.normal, state, {});
        if (along < 3.0 * plane.h + mu * depth) continue;
        const Vector3d lag = foot - update.position;
        EXPECT_NEAR(lag.dot(direction) / plane.h, mu_exact * depth / plane.h, 1e-9);
        EXPECT_LE((lag - lag.dot(direction) * direction).norm() / plane.h, 1e-9);
        EXPECT_FALSE(update.sticking);
      }
    }
}

TEST(FrictionAtContact, YieldsAboveMuStaticAndSticksAgainBelowNineTenthsOfMuDynamic) {
  const Incline plane(0.01, 0.0, 0.0, 0.6, 0.3);
  const double depth = 0.01;
  const auto hand = [&](double x) { return Vector3d(x, 0.3, -depth); };
  ProxyState state = start_proxy(plane.surface, hand(0.2));
  const auto at = [&](double x) { return update_exact(plane.surface, hand(x), state, {}); };
  EXPECT_TRUE(at(0.2).sticking);
  ProxyUpdate update = at(0.2 + 0.5999 * depth);
  EXPECT_TRUE(update.sticking);
  EXPECT_EQ(update.position.x(), 0.2);
  update = at(0.2 + 0.6001 * depth);
  EXPECT_FALSE(update.sticking);
  EXPECT_NEAR(update.position.x(), 0.2 + 0.3001 * depth, 1e-9);
  const double slid = update.position.x();
  // Back a little: held by less than mu_d, still slipping; further back: sticks and needs mu_s again.
  update = at(slid + 0.28 * depth);
  EXPECT_FALSE(update.sticking);
  EXPECT_EQ(update.position.x(), slid);
  update = at(slid + 0.2699 * depth);
  EXPECT_TRUE(update.sticking);
  update = at(slid + 0.59 * depth);
  EXPECT_TRUE(update.sticking);
  EXPECT_EQ(update.position.x(), slid);
}

TEST(FrictionAtContact, OfThePapersSolverYieldsAtMuStaticAndSlidesWithMuDynamic) {
  const Incline plane(0.01, 0.0, 0.0, 0.8, 0.3);
  const double depth = 0.01;
  const auto hand = [&](double x) { return Vector3d(x, 0.3, -depth); };
  SolverOptions options;
  options.paper_iterations = 2000;
  ProxyState state = start_proxy(plane.surface, hand(0.2));
  const auto at = [&](double x) { return update_paper(plane.surface, hand(x), state, options); };
  EXPECT_TRUE(at(0.2).sticking);
  // The hand goes on slowly: nothing gives before 0.8 of the press.
  ProxyUpdate update;
  double x = 0.2;
  for (; x < 0.2 + 0.7999 * depth; x += 0.01 * depth) {
    update = at(x);
    ASSERT_TRUE(update.sticking) << x;
    ASSERT_EQ(update.position.x(), 0.2);
  }
  update = at(0.2 + 0.8001 * depth);
  EXPECT_FALSE(update.sticking);
  EXPECT_NEAR(update.position.x(), 0.2 + (0.8001 - 0.3) * depth, 1e-6 * depth);
  // It slides on with 0.3, and needs 0.8 again only once it was held by clearly less.
  update = at(0.2 + 1.2 * depth);
  EXPECT_NEAR(update.position.x(), 0.2 + 0.9 * depth, 1e-6 * depth);
  const double slid = update.position.x();
  EXPECT_TRUE(at(slid + 0.2699 * depth).sticking);
  update = at(slid + 0.79 * depth);
  EXPECT_TRUE(update.sticking);
  EXPECT_EQ(update.position.x(), slid);
}

TEST(FrictionAtContact, ABlockOnASpringSticksAndSlipsWithThePeriodOfTheClosedForm) {
  // A block of mass m is dragged over a plane by a spring k whose end goes at v: the hand is the block, the proxy is
  // where friction holds it. While it sticks the spring loads by k v t; at mu_s N it slips as an oscillator about
  // mu_d N: x(t) = -(d/k) cos(w t) + ..., d = (mu_s - mu_d) N, until it is at rest on the ground again. The tick is
  // fine, so that the period is the law's and not the clock's.
  const Incline plane(0.01, 0.0, 0.0, 0.8, 0.4);
  const double press_m = 0.0001;           // of the hand into the plane
  const double contact_n_per_m = 80000.0;  // stiff against the spring: the ground hardly gives
  const double normal_n = contact_n_per_m * press_m;
  const double spring_n_per_m = 400.0;
  const double mass_kg = 0.5;
  const double pull_m_per_s = 0.05;
  const double dt = 2e-6;
  double x = 0.2;
  double speed = 0.0;
  double drawn = x;
  ProxyState state = start_proxy(plane.surface, {x, 0.3, -press_m});
  std::vector<double> slips;
  bool stuck = true;
  for (int k = 0; k < 2'000'000 && slips.size() < 7; ++k) {
    drawn += pull_m_per_s * dt;
    const Vector3d hand(x, 0.3, -press_m);
    const ProxyUpdate update = update_exact(plane.surface, hand, state, {});
    const double force = contact_n_per_m * (update.position.x() - x) + spring_n_per_m * (drawn - x);
    // Contact damping stands for the block's own: it decides how fast the ground's spring settles, not the period.
    const double damping = update.sticking ? 2.0 * std::sqrt(contact_n_per_m * mass_kg) : 0.0;
    speed += dt * (force - damping * speed) / mass_kg;
    x += dt * speed;
    if (stuck && !update.sticking) slips.push_back(k * dt);
    stuck = update.sticking;
  }
  ASSERT_EQ(slips.size(), 7U);
  const double mean = (slips.back() - slips[2]) / 4.0;
  // While it slips: u = spring stretch - mu_d N / k starts at d / k with rate v, swings at w and sticks when the block
  // has the plane's speed again; then the spring loads from there at v.
  const double w = std::sqrt(spring_n_per_m / mass_kg);
  const double d = (0.8 - 0.4) * normal_n / spring_n_per_m;
  const double slipping = (2.0 * std::numbers::pi - 2.0 * std::atan2(d * w, pull_m_per_s)) / w;
  const double sticking = 2.0 * d / pull_m_per_s;
  std::printf("  stick-slip period %.4f s, closed form %.4f s\n", mean, slipping + sticking);
  EXPECT_NEAR(mean, slipping + sticking, 0.05 * (slipping + sticking));
}

TEST(FrictionAtContact, SlipHoldsTheConeAndOpposesTheMotionOnCurvedSurfaces) {
  std::mt19937_64 random(31);
  MongeSurface surface = make_sinusoid(150);
  set_random_friction(surface, 0.5, random);
  const double h = surface.lattice.spacing_m;
  Vector3d hand(0.5, 0.5, surface.height(0.5, 0.5) - 0.004);
  ProxyState state = start_proxy(surface, hand);
  int slips = 0;
  double worst = 0.0;
  for (int k = 0; k < 50000; ++k) {
    const double t = 0.001 * k;
    const double x = 0.5 + 0.37 * std::sin(0.9 * t + 0.3);
    const double y = 0.5 + 0.33 * std::sin(1.3 * t);
    hand = {x, y, surface.height(x, y) - 0.004};
    const Vector3d before = state.position;
    const ProxyUpdate update = update_exact(surface, hand, state, {});
    const Judgement verdict =
        judge(surface, update.position, hand, coefficient_at(surface, surface.mu_dynamic, update.position));
    if (update.sticking || update.position == before) continue;
    ++slips;
    const Vector3d moved = update.position - before;
    EXPECT_GT((hand - update.position).dot(moved), 0.0) << "friction pushed the proxy on";
    const double s = update.position.x() / h;
    const double v = update.position.y() / h;
    const bool crease = std::abs(s - std::round(s)) < 1e-12 || std::abs(v - std::round(v)) < 1e-12;
    if (!crease) worst = std::max(worst, std::abs(verdict.excess_cells));
  }
  EXPECT_GT(slips, 10000);
  EXPECT_LE(worst, 1e-9 + 8.0 * std::numeric_limits<double>::epsilon() * 150.0);
}

TEST(FrictionAtContact, DoesNotDriftInTenMinutesOfStick) {
  std::mt19937_64 random(32);
  std::normal_distribution<double> tremor(0.0, 1e-5);
  MongeSurface surface = make_fractal_surface(129, 5e-4, 2e-3, random);
  set_friction(surface, 0.8, 0.5);
  const Vector3d foot(0.031, 0.029, surface.height(0.031, 0.029));
  ProxyState state = start_proxy(surface, foot - Vector3d(0, 0, 0.002));
  ProxyUpdate update = update_exact(surface, foot - Vector3d(0, 0, 0.002), state, {});
  // Settle on a spot that holds, then tremble on it for 600 000 ticks.
  Vector3d hand = update.position - 0.002 * update.normal;
  for (int k = 0; k < 10; ++k) update = update_exact(surface, hand, state, {});
  hand = update.position - 0.002 * update.normal;
  update = update_exact(surface, hand, state, {});
  ASSERT_TRUE(update.sticking);
  const Vector3d held = update.position;
  for (int k = 0; k < 600'000; ++k) {
    update = update_exact(surface, hand + Vector3d(tremor(random), tremor(random), tremor(random)), state, {});
    ASSERT_EQ(update.position, held) << "tick " << k;
  }
}

TEST(FrictionAtContact, IdenticalSamplesGiveIdenticalBits) {
  std::mt19937_64 random(33);
  for (int run = 0; run < 300; ++run) {
    MongeSurface surface = make_rough_surface(25, 1e-3, 2e-3, random);
    set_random_friction(surface, 0.9, random);
    std::uniform_real_distribution<double> uniform(0.0, 0.024);
    ProxyState state = start_proxy(surface, {0.01, 0.01, 0.0});
    for (int k = 0; k < 20; ++k) {
      const Vector3d hand(uniform(random), uniform(random), -0.2 * uniform(random));
      const ProxyUpdate first = update_exact(surface, hand, state, {});
      for (int again = 0; again < 3; ++again) {
        const ProxyUpdate same = update_exact(surface, hand, state, {});
        EXPECT_EQ(std::memcmp(first.position.data(), same.position.data(), 3 * sizeof(double)), 0);
        EXPECT_EQ(same.segments, 0) << "rest is rest";
      }
    }
  }
}

TEST(FrictionAtContact, TheSamePathGivesTheSameBitsTwice) {
  std::mt19937_64 random(34);
  MongeSurface surface = make_fractal_surface(129, 1e-3, 5e-3, random);
  set_random_friction(surface, 0.9, random);
  std::uniform_real_distribution<double> uniform(0.0, 0.128);
  std::vector<Vector3d> path;
  for (int k = 0; k < 3000; ++k) path.push_back({uniform(random), uniform(random), 0.1 * (uniform(random) - 0.1)});
  std::vector<Vector3d> proxies[2];
  for (auto& run : proxies) {
    ProxyState state = start_proxy(surface, path[0]);
    for (const Vector3d& hand : path) run.push_back(update_exact(surface, hand, state, {}).position);
  }
  EXPECT_EQ(proxies[0], proxies[1]);
}

TEST(FrictionAtContact, ForceJumpsFromTheFrictionMapAreBoundedByItsContrast) {
  // On a plane with a checkered map the force may jump in a tick by no more than the cone's change plus the motion.
  MongeSurface surface = make_surface_of(60, 60, 0.01, [](double, double) { return 0.0; });
  set_friction(surface, 0.2, 0.2);
  for (std::size_t k = 0; k < surface.mu_dynamic.size(); ++k)
    if ((k / 5) % 2 == 0) surface.mu_dynamic[k] = surface.mu_static[k] = 0.6F;
  const double depth = 0.004;
  const double tick = 1e-4;
  ProxyState state = start_proxy(surface, {0.1, 0.2, -depth});
  Vector3d last = Vector3d::Zero();
  int jumps = 0;
  for (double x = 0.1; x < 0.5; x += tick) {
    const Vector3d hand(x, 0.2 + 0.3 * (x - 0.1), -depth);
    const Vector3d force = update_exact(surface, hand, state, {}).position - hand;
    if (x > 0.11) {
      EXPECT_LE((force - last).norm(), (0.6 - 0.2) * depth + 2.0 * tick);
      if ((force - last).norm() > 2.0 * tick) ++jumps;
    }
    last = force;
  }
  EXPECT_LE(jumps, 20);
}

}  // namespace sparsha::haptics::test
