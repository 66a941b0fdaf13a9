// Force where a hand passes from one sheet of a whole object to the next. Lengths are in mean point spacings, h.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "haptics/around/around_proxy.h"
#include "tests/support/wandering_hand.h"

namespace sparsha::test {
namespace {

using Eigen::Vector3d;
using haptics::AroundState;
using haptics::AroundUpdate;

/// Changes of the force in a tick: of its magnitude, and of its direction in degrees.
struct Changes {
  std::vector<double> jumps, turns_deg;

  void add(const Vector3d& arm, const Vector3d& last) {
    jumps.push_back(std::abs(arm.norm() - last.norm()) / last.norm());
    turns_deg.push_back(std::atan2(arm.cross(last).norm(), arm.dot(last)) * 180.0 / M_PI);
  }
  [[nodiscard]] static double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  }
};

/// A direction across the border between the two sides that a place faces most; zero where it faces one clearly more.
Vector3d across_border(const SurfacePoint& at) {
  int first = 0, last = 0;
  at.normal.cwiseAbs().maxCoeff(&first);
  at.normal.cwiseAbs().minCoeff(&last);
  const int second = 3 - first - last;
  if (std::abs(at.normal[first]) - std::abs(at.normal[second]) > 0.1) return Vector3d::Zero();
  const Vector3d way = std::copysign(1.0, at.normal[second]) * Vector3d::Unit(second) -
                       std::copysign(1.0, at.normal[first]) * Vector3d::Unit(first);
  return (way - way.dot(at.normal) * at.normal).normalized();
}

/// There and back across the border by 0.05 h a tick, 2 h deep.
void cross(const Touched& on, const SurfacePoint& at, const Vector3d& way, Changes& within, Changes& at_seams) {
  const GodObject judge(*on.object, on.h, at.position_m);
  const auto hand_at = [&](double along, double depth) {
    Vector3d place = at.position_m + along * on.h * way;
    for (int k = 0; k < 5; ++k) place -= on.object->distance_m(place) * judge.normal(place);
    return Vector3d(place - depth * on.h * judge.normal(place) - on.surface->origin_m);
  };
  const haptics::SolverOptions options{.shape = haptics::CellShape::rounded};
  AroundState state;
  for (double depth = -2.0; depth < 2.0; depth += 0.25)
    (void)update_around(*on.surface, hand_at(-6.0, depth), state, options);
  Vector3d last = Vector3d::Zero();
  for (const double sign : {1.0, -1.0}) {
    for (double along = -6.0; along <= 6.0; along += 0.05) {
      const Vector3d hip = hand_at(sign * along, 2.0);
      const AroundUpdate found = update_around(*on.surface, hip, state, options);
      const Vector3d arm = found.position_m - hip;
      if (found.contact && !last.isZero()) (found.hand_overs > 0 ? at_seams : within).add(arm, last);
      last = found.contact ? arm : Vector3d::Zero();
    }
  }
}

TEST(AroundSeams, AreNotFelt) {
  const bool nightly = std::getenv("SPARSHA_NIGHTLY") != nullptr;
  for (const Touched& on : {touched("torus", make_torus()), touched("two spheres", make_two_spheres())}) {
    std::mt19937_64 random(21);
    Changes within, at_seams;
    for (int strokes = 0; strokes < (nightly ? 10'000 : 60);) {
      const SurfacePoint at = on.object->sample(random);
      const Vector3d way = across_border(at);
      if (way.isZero()) continue;
      cross(on, at, way, within, at_seams);
      ++strokes;
    }
    const double jump = Changes::quantile(at_seams.jumps, 0.99);
    const double turn = Changes::quantile(at_seams.turns_deg, 0.99);
    const double turn_within = Changes::quantile(within.turns_deg, 0.99);
    const std::string all = on.name + ": " + std::to_string(at_seams.jumps.size()) + " seams, force jumps by " +
                            std::to_string(jump) + " and turns by " + std::to_string(turn) + " degrees, within by " +
                            std::to_string(turn_within);
    if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
    EXPECT_GT(at_seams.jumps.size(), 20U) << all;
    EXPECT_LE(jump, 0.01) << all;
    EXPECT_LE(turn, turn_within + 2.0) << all;
  }
}

/// Where a proxy goes over from one sheet to the next, what they differ by has faded two spacings further on.
TEST(AroundSeams, FadeAsTheProxyGoesOn) {
  const Touched on = touched("torus", make_torus());
  AroundState state;
  std::mt19937_64 random(4);
  SurfacePoint at = on.object->sample(random);
  while (at.normal.cwiseAbs().maxCoeff() < 0.95) at = on.object->sample(random);  // where no sheet is left
  (void)update_around(*on.surface, at.position_m + 2.0 * on.h * at.normal - on.surface->origin_m, state, {});
  const Vector3d hip = at.position_m - 2.0 * on.h * at.normal - on.surface->origin_m;
  const AroundUpdate before = update_around(*on.surface, hip, state, {});
  ASSERT_TRUE(before.contact);
  state.seam = {0.2 * on.h * Vector3d::UnitX(), 2.0 * on.h, 2.0};
  const AroundUpdate resting = update_around(*on.surface, hip, state, {});
  EXPECT_NEAR((resting.position_m - before.position_m).norm(), 0.2 * on.h, 0.02 * on.h);
  const Vector3d side = at.normal.unitOrthogonal();
  AroundUpdate found;
  for (int k = 1; k <= 40; ++k) found = update_around(*on.surface, hip + 0.1 * k * on.h * side, state, {});
  ASSERT_TRUE(found.contact);
  EXPECT_EQ(found.position_m, state.position_m);
}

}  // namespace
}  // namespace sparsha::test
