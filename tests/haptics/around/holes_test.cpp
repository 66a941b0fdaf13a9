// A hand about a hole of the scan: it falls in, whether it comes from above or along the surface, and nothing within
// holds it. Lengths are in mean point spacings, h.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "haptics/around/around_proxy.h"
#include "pipeline/charts/charts.h"
#include "tests/support/closed_objects.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

using Eigen::Vector3d;

constexpr double kHole = 8.0;  // radius

/// A cube whose upper face has a hole about its middle.
struct WithHole {
  double h = 0.0;
  double top_m = 0.6;
  std::shared_ptr<const haptics::ObjectSurface> surface;
};
WithHole cube_with_hole() {
  WithHole cube;
  ScanOptions options;
  options.points = 20'000;
  options.seed = 11;
  ObjectScan scan = scan_object(*make_box(Vector3d::Constant(cube.top_m), turned(0.0, 0.0)), options);
  cube.h = scan.spacing_m;
  std::erase_if(scan.points,
                [&](const auto& p) { return p[2] > 0.5 * cube.top_m && std::hypot(p[0], p[1]) < kHole * cube.h; });
  ThreadPool pool(2);
  Progress progress;
  scene::GridConfig grid;
  grid.spacing_m = cube.h;
  const auto made =
      pipeline::make_charts(make_cloud(scan.points), Eigen::Matrix4d::Identity(), grid, 0.0, {pool, progress});
  cube.surface = haptics::make_object_surface(made.charts);
  return cube;
}

class Hand {
 public:
  explicit Hand(const WithHole& cube) : cube_(cube) {}
  struct Felt {
    bool held = false;         ///< at the way's end
    double longest_arm = 0.0;  ///< of the proxy, in spacings
  };
  /// To (x, y, height above the upper face), in steps of so many spacings.
  Felt go(const Vector3d& to, double step = 0.1) {
    Felt felt;
    const Vector3d from = at_;
    const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / step)));
    for (int k = 1; k <= steps; ++k) {
      at_ = from + (to - from) * (static_cast<double>(k) / steps);
      const Vector3d hand_m = cube_.h * at_ + cube_.top_m * Vector3d::UnitZ() - cube_.surface->origin_m;
      const haptics::AroundUpdate found = update_around(*cube_.surface, hand_m, state_, {});
      felt.held = found.contact;
      if (found.contact) felt.longest_arm = std::max(felt.longest_arm, (found.position_m - hand_m).norm() / cube_.h);
    }
    return felt;
  }

 private:
  const WithHole& cube_;
  Vector3d at_ = Vector3d::Zero();
  haptics::AroundState state_;
};

TEST(AroundHoles, LetAHandThroughThatComesAlongTheSurface) {
  const WithHole cube = cube_with_hole();
  for (const double depth : {1.5, 3.0}) {
    for (const double towards : {0.0, 0.7, 1.9}) {
      const Vector3d way(std::cos(towards), std::sin(towards), 0.0);
      Hand hand(cube);
      hand.go(-20.0 * way + Vector3d(0.0, 0.0, 3.0));
      EXPECT_TRUE(hand.go(-20.0 * way - Vector3d(0.0, 0.0, depth)).held);
      EXPECT_TRUE(hand.go(-12.0 * way - Vector3d(0.0, 0.0, depth)).held);
      const Hand::Felt at_rim = hand.go(-Vector3d(0.0, 0.0, depth));
      EXPECT_FALSE(at_rim.held) << depth;
      EXPECT_LE(at_rim.longest_arm, depth + 3.0) << depth;
      EXPECT_FALSE(hand.go(15.0 * way - Vector3d(0.0, 0.0, depth)).held) << depth;
      EXPECT_FALSE(hand.go(15.0 * way + Vector3d(0.0, 0.0, 3.0)).held) << depth;
      EXPECT_TRUE(hand.go(15.0 * way - Vector3d(0.0, 0.0, depth)).held) << depth;
    }
  }
}

TEST(AroundHoles, HoldNoHandThatHasGoneInFromAbove) {
  const WithHole cube = cube_with_hole();
  for (const double depth : {0.7, 1.5, 4.0}) {
    for (const double step : {0.02, 0.4, 1.5}) {
      Hand hand(cube);
      hand.go({0.0, 0.0, 5.0});
      EXPECT_EQ(hand.go({0.0, 0.0, -depth}, step).longest_arm, 0.0) << depth << " " << step;
      for (const double beyond : {kHole + 2.0, kHole + 5.0, kHole + 12.0})
        EXPECT_EQ(hand.go({beyond, 0.0, -depth}, step).longest_arm, 0.0) << depth << " " << step << " " << beyond;
      EXPECT_EQ(hand.go({kHole + 12.0, 0.0, 3.0}, step).longest_arm, 0.0) << depth << " " << step;
      EXPECT_TRUE(hand.go({kHole + 12.0, 0.0, -1.0}, step).held);
    }
  }
}

}  // namespace
}  // namespace sparsha::test
