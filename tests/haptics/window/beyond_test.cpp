// Where nothing was measured: small holes stay closed, beyond an outline a hand falls away and is not stopped. The hand
// of these tests is its own: a mass on a grip, integrated twenty times a tick.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/window.h"
#include "scene/ground/beyond.h"
#include "scene/ground/continuation.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kWidth_m = 0.1;
using Beyond = scene::HapticsConfig::Beyond;

struct Shape {
  const char* name;
  double size_m;  // of the scanned square
  sparsha::test::HeightFunction height_m;
  Eigen::Vector2d edge_m;     // a place of the outline
  Eigen::Vector2d outward{};  // unit
};

double bumps_m(double x, double y) { return 0.001 * std::sin(200.0 * x) * std::cos(170.0 * y); }

Shape ball(double degrees) {
  constexpr double kRadius_m = 0.08;
  const auto height_m = [](double x, double y) {
    const double left = kRadius_m * kRadius_m - (x - 0.1) * (x - 0.1) - (y - 0.1) * (y - 0.1);
    return left > 0.0 ? std::sqrt(left) : kNan;
  };
  const double angle = degrees * std::numbers::pi / 180.0;
  const Eigen::Vector2d outward(std::cos(angle), std::sin(angle));
  return {"ball", 0.2, height_m, Eigen::Vector2d(0.1, 0.1) + kRadius_m * outward, outward};
}

/// A slab with a carved face, 120 mm wide; over its left half it is 30 mm lower.
Shape slab(double y_m, Eigen::Vector2d outward) {
  const auto height_m = [](double x, double y) {
    const bool stone = x > 0.04 && x < 0.16 && y > 0.04 && y < 0.16;
    return stone ? bumps_m(x, y) - (y < 0.1 ? 0.03 : 0.0) : kNan;
  };
  return {"slab", 0.2, height_m, {0.16, y_m}, outward.normalized()};
}

/// A face whose occluded side, 70 mm wide, was not measured, with higher stone behind it.
Shape occlusion() {
  const auto height_m = [](double x, double y) { return x < 0.08 ? bumps_m(x, y) : x > 0.15 ? 0.03 : kNan; };
  return {"occlusion", 0.2, height_m, {0.08, 0.1}, {1.0, 0.0}};
}

struct Stroke {
  double force_n = 0.0;         // over the last millimetres of stone
  double beyond_n = 0.0;        // most from 10 mm beyond on
  double largest_drop_n = 0.0;  // in one tick, from 5 mm before the edge on
  double reached_m = -1.0;      // beyond the edge, device frame
};

/// Presses 15 mm inside, then goes outwards at 80 mm/s to 14 mm beyond the edge, device frame.
Stroke stroke_over(const scene::ScenePointer& scene, const Shape& shape, const ZoomStep& step, Beyond kind) {
  WindowPlan plan = plan_window(scene->description(), step, shape.edge_m, kWidth_m);
  plan.beyond = kind;
  HapticRenderer renderer(DeviceInfo{}, RendererOptions{}, load_window(*scene, plan, 1));
  const Eigen::Vector3d centre_m = renderer.window().surface->centre_m;
  const double scale = plan.scale;
  const auto surface_z = [&](double way_m) {  // device frame, of the stone
    const Eigen::Vector2d at = shape.edge_m + shape.outward * std::min(way_m / scale, -0.0006);
    const double z = shape.height_m(at.x(), at.y());
    return scale * (z - centre_m.z());
  };
  constexpr double kMass_kg = 0.15, kGrip = 300.0, kDamping = 2.0, kPress_n = 1.5, kSpeed = 0.08;
  const Eigen::Vector2d edge = scale * (shape.edge_m - centre_m.head<2>());
  const auto goal = [&](double way_m, double pressed) -> Eigen::Vector3d {
    const Eigen::Vector2d at = edge + shape.outward * way_m;
    const double stone = std::max(surface_z(std::min(way_m, 0.0)), surface_z(0.0));
    return {at.x(), at.y(), stone + 0.01 - pressed * (0.01 + kPress_n / kGrip + kPress_n / 800.0)};
  };
  constexpr double kStart_m = -0.015, kEnd_m = 0.014;
  Eigen::Vector3d hand = goal(kStart_m, 0.0), velocity = Eigen::Vector3d::Zero(), force = Eigen::Vector3d::Zero();
  Stroke result;
  double last_n = 0.0, edge_n = 0.0;
  int on_stone = 0;
  for (int tick = 0; tick < 1200; ++tick) {
    const double time_s = 0.001 * tick;
    const double pressed = std::clamp((time_s - 0.1) / 0.2, 0.0, 1.0);
    const double way = std::min(kStart_m + kSpeed * std::max(0.0, time_s - 0.4), kEnd_m);
    const Eigen::Vector3d wanted = goal(way, pressed);
    for (int part = 0; part < 20; ++part) {
      velocity += 5e-5 / kMass_kg * (kGrip * (wanted - hand) - kDamping * velocity + force);
      hand += 5e-5 * velocity;
    }
    renderer.update(sample_at(hand, time_s), 0.001);
    const auto& f = renderer.state().commanded_force_n;
    force = {f[0], f[1], f[2]};
    const double now_n = force.norm();
    const double beyond = (hand.head<2>() - edge).dot(shape.outward);
    if (time_s > 0.4 && beyond > -0.004 && beyond < -0.001) edge_n += now_n, ++on_stone;
    if (time_s > 0.4 && beyond > -0.005) result.largest_drop_n = std::max(result.largest_drop_n, last_n - now_n);
    if (beyond >= 0.01) result.beyond_n = std::max(result.beyond_n, now_n);
    result.reached_m = std::max(result.reached_m, beyond);
    last_n = now_n;
  }
  result.force_n = on_stone > 0 ? edge_n / on_stone : 0.0;
  return result;
}

TEST(Beyond, AHandFallsOffEveryEdgeAtEveryZoomAndIsNotStopped) {
  std::vector<Shape> shapes{occlusion(), slab(0.12, {1.0, 0.0}), slab(0.08, {1.0, 0.3}), slab(0.107, {1.0, 0.0}),
                            slab(0.09, {1.0, -0.2})};
  for (const double degrees : {0.0, 27.0, 130.0, 250.0}) shapes.push_back(ball(degrees));
  int felt_beyond = 0, continued_felt = 0, strokes = 0;
  for (const Shape& shape : shapes) {
    sparsha::test::SceneOptions options;
    options.spacing_m = 0.0005;
    options.nx = options.ny = 401;
    options.levels = 3;
    const scene::ScenePointer scene = sparsha::test::scene_of(shape.height_m, options);
    for (const ZoomStep& step : zoom_steps(scene->description(), kWidth_m)) {
      SCOPED_TRACE(testing::Message() << shape.name << " outward " << shape.outward.transpose() << " level "
                                      << step.level << " nodes " << step.nodes);
      const Stroke stroke = stroke_over(scene, shape, step, Beyond::falls);
      EXPECT_GT(stroke.reached_m, 0.010) << "not stopped";
      EXPECT_LT(stroke.largest_drop_n, 1.0);
      if (stroke.beyond_n > 0.1 * stroke.force_n) ++felt_beyond;
      const Stroke before = stroke_over(scene, shape, step, Beyond::continued);
      if (before.reached_m < 0.010 || before.beyond_n > 0.1 * before.force_n) ++continued_felt;
      ++strokes;
    }
  }
  EXPECT_LE(50 * felt_beyond, strokes) << "at most 2 %";
  EXPECT_GT(2 * continued_felt, strokes) << "what is continued is felt: the hand can tell";
}

}  // namespace

TEST(Beyond, SmallHolesStayClosedToTheLastBitAndKnownNodesAsTheyAre) {
  constexpr int kNodes = 60;
  std::vector<float> heights(kNodes * kNodes);
  for (int j = 0; j < kNodes; ++j)
    for (int i = 0; i < kNodes; ++i)
      heights[static_cast<std::size_t>(j * kNodes + i)] = static_cast<float>(bumps_m(0.001 * i, 0.001 * j));
  const auto forget = [&](int i, int j) {
    heights[static_cast<std::size_t>(j * kNodes + i)] = std::numeric_limits<float>::quiet_NaN();
  };
  for (int k = 10; k < 50; ++k) forget(k, 20), forget(k, 21);  // a slit two nodes wide
  forget(40, 40);
  const scene::BeyondOptions options{0.001, 1.0, 0.0};
  std::vector<float> continued = heights;
  scene::continue_heights(continued, kNodes, kNodes);
  std::vector<float> closed = heights;
  scene::continue_beyond(closed, kNodes, kNodes, options);
  EXPECT_EQ(closed, continued);

  for (int j = 25; j < 38; ++j)
    for (int i = 5; i < 30; ++i) forget(i, j);  // no hole
  std::vector<float> fallen = heights;
  scene::continue_beyond(fallen, kNodes, kNodes, options);
  for (std::size_t node = 0; node < heights.size(); ++node)
    if (std::isfinite(heights[node])) {
      EXPECT_EQ(fallen[node], heights[node]);
    }
  EXPECT_LT(fallen[31 * kNodes + 15], -0.008F);
}

TEST(Beyond, NothingRisesAwayFromAnOutline) {
  constexpr int kNodes = 100;
  std::vector<float> heights(kNodes * kNodes, std::numeric_limits<float>::quiet_NaN());
  for (int j = 30; j < 70; ++j)
    for (int i = 0; i < 40; ++i)  // steps along the outline
      heights[static_cast<std::size_t>(j * kNodes + i)] = static_cast<float>(0.02 * ((j / 10) % 2));
  scene::continue_beyond(heights, kNodes, kNodes, {0.0005, 1.0, 0.0});
  for (int j = 30; j < 70; ++j)
    for (int i = 39; i < 60; ++i) {
      const std::size_t node = static_cast<std::size_t>(j * kNodes + i);
      EXPECT_LE(heights[node + 1], heights[node] + 1e-7F) << i << ' ' << j;
    }
}

}  // namespace sparsha::haptics
