// The same way of the hand at 1 kHz and at 100 kHz: friction knows the way and not the clock.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "haptics/proxy/proxy.h"
#include "tests/support/surfaces.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

constexpr double kDepth_m = 0.0015;
constexpr int kFiner = 100;  // samples of the fine clock per tick

struct Difference {
  double worst = 0.0;   // of the forces, of the depth
  double beyond = 0.0;  // share of the common instants where it is more than 1 %
};

/// Bumps 0.4 mm from top to bottom and 6 mm long, mu_s 0.5, mu_d 0.3, nodes 0.5 mm apart.
MongeSurface bumps() {
  const double wave = 2.0 * std::numbers::pi / 0.006;
  MongeSurface surface = make_surface_of(
      241, 241, 0.0005, [wave](double x, double y) { return 0.0002 * std::sin(wave * x) * std::sin(wave * y); });
  set_friction(surface, 0.5, 0.3);
  return surface;
}

/// A circle, or a line that turns back again and again.
Vector3d hand_at(double way_m, bool circle) {
  const double x = circle ? 0.045 * std::cos(way_m / 0.045) : 0.04 * std::sin(way_m / 0.04);
  const double y = circle ? 0.045 * std::sin(way_m / 0.045) : 0.03 * std::sin(0.731 * way_m / 0.04 + 0.4);
  return {0.06 + x, 0.06 + y, -kDepth_m};
}

Difference compare(const MongeSurface& surface, CellShape shape, double speed_m_per_s, bool circle) {
  const SolverOptions options{.shape = shape};
  const auto hand = [&](double t_s) { return hand_at(speed_m_per_s * t_s, circle); };
  ProxyState coarse = start_proxy(surface, hand(0.0));
  ProxyState fine = coarse;
  Difference result;
  constexpr int kTicks = 3000;
  constexpr int kSettled = 20;
  int beyond = 0;
  for (int tick = 1; tick <= kTicks; ++tick) {
    ProxyUpdate other;
    for (int k = 1; k <= kFiner; ++k)
      other = update_exact(surface, hand(1e-3 * (tick - 1 + static_cast<double>(k) / kFiner)), fine, options);
    const ProxyUpdate found = update_exact(surface, hand(1e-3 * tick), coarse, options);
    if (tick < kSettled) continue;
    const double off = (found.position - other.position).norm() / kDepth_m;
    result.worst = std::max(result.worst, off);
    if (off > 0.01) ++beyond;
  }
  result.beyond = static_cast<double>(beyond) / (kTicks - kSettled);
  return result;
}

}  // namespace

TEST(FrictionWithoutAClock, OneKilohertzGivesTheForcesOfAHundredOnBumps) {
  const MongeSurface surface = bumps();
  for (const CellShape shape : {CellShape::rounded, CellShape::c1, CellShape::bilinear})
    for (const double speed_m_per_s : {0.02, 0.05, 0.1, 0.2})
      for (const bool circle : {true, false}) {
        const Difference off = compare(surface, shape, speed_m_per_s, circle);
        const char* name = shape == CellShape::rounded ? "rounded" : shape == CellShape::c1 ? "c1" : "sharp";
        std::printf("  %-7s %3.0f mm/s %-6s worst %.2f %%, beyond 1 %% in %.2f %% of ticks\n", name,
                    1e3 * speed_m_per_s, circle ? "circle" : "line", 100.0 * off.worst, 100.0 * off.beyond);
        if (shape == CellShape::bilinear) continue;  // what its creases hold depends on the clock
        EXPECT_LE(off.beyond, 0.001) << name << ' ' << speed_m_per_s;
        EXPECT_LE(off.worst, 0.0125) << name << ' ' << speed_m_per_s;
      }
}

TEST(FrictionWithoutAClock, AProxyThatWasMovedForgetsTheHandsWay) {
  const MongeSurface surface = bumps();
  const SolverOptions options{.shape = CellShape::rounded};
  ProxyState state = start_proxy(surface, hand_at(0.0, true));
  for (int tick = 1; tick < 200; ++tick)
    static_cast<void>(update_exact(surface, hand_at(2e-4 * tick, true), state, options));
  const Vector3d place(0.03, 0.04, surface.height(0.03, 0.04));
  ProxyState moved = state;
  moved.position = place;
  ProxyState anew;
  anew.position = place;
  anew.contact = true;
  anew.sticking = moved.sticking;
  const Vector3d hand(0.0305, 0.0402, -kDepth_m);
  EXPECT_EQ(update_exact(surface, hand, moved, options).position, update_exact(surface, hand, anew, options).position);
}

}  // namespace sparsha::haptics::test
