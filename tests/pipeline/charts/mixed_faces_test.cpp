// Walls whose two faces are nearer to each other than the points of one: said, and of thicker ones nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "pipeline/charts/charts.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

/// Of the charts of an object that is scanned by so many points.
double mixed_share(const ClosedObject& object, std::size_t points, double noise, unsigned threads = 2) {
  ScanOptions options;
  options.points = points;
  options.noise_spacings = noise;
  options.seed = 5;
  const ObjectScan scan = scan_object(object, options);
  ThreadPool pool(threads);
  Progress progress;
  scene::GridConfig grid;
  grid.spacing_m = scan.spacing_m;
  return pipeline::make_charts(make_cloud(scan.points), Eigen::Matrix4d::Identity(), grid, 0.0, {pool, progress})
      .mixed_share;
}

constexpr double kVaseWall_m = 0.06;

/// So many points that a wall of the vase is so many of their spacings thick.
std::size_t points_of_wall(const ClosedObject& vase, double spacings) {
  const double spacing_m = kVaseWall_m / spacings;
  return static_cast<std::size_t>(vase.area_m2() / (spacing_m * spacing_m));
}

TEST(MixedFaces, OfAThinVesselAreSaidAtAnyDensity) {
  const ObjectPtr vase = make_vase(turned(48.0, 0.0));
  for (const double wall : {0.4, 0.6, 0.8, 1.0, 1.4}) {
    const double share = mixed_share(*vase, points_of_wall(*vase, wall), 0.1);
    EXPECT_GT(share, 0.2) << "a wall of " << wall << " spacings";
    EXPECT_EQ(share, mixed_share(*vase, points_of_wall(*vase, wall), 0.1, 1)) << "whatever the threads";
  }
  for (const double wall : {0.8, 1.0, 1.4})
    EXPECT_GT(mixed_share(*vase, points_of_wall(*vase, wall), 0.25), 0.2) << "noisy, a wall of " << wall << " spacings";
}

TEST(MixedFaces, OfThickObjectsAreNone) {
  const ObjectPtr vase = make_vase(turned(48.0, 0.0));
  for (const double wall : {3.0, 5.0})
    EXPECT_EQ(mixed_share(*vase, points_of_wall(*vase, wall), 0.1), 0.0) << "a wall of " << wall << " spacings";
  const std::vector<NamedObject> objects{{"torus", make_torus()},
                                         {"two spheres", make_two_spheres()},
                                         {"knot", make_knot()},
                                         {"cube", make_box({0.6, 0.6, 0.6}, Eigen::Matrix3d::Identity())},
                                         {"cube on a corner", make_box({0.6, 0.6, 0.6}, turned(35.3, 45.0))},
                                         {"bevelled", make_bevelled_cube(0.6, 0.1, turned(35.3, 45.0))}};
  for (const NamedObject& named : objects) {
    for (const std::size_t points : {std::size_t{2'000}, std::size_t{6'000}}) {
      for (const double noise : {0.0, 0.3})
        EXPECT_EQ(mixed_share(*named.object, points, noise), 0.0) << named.name << ", " << points << ", " << noise;
    }
  }
}

}  // namespace
}  // namespace sparsha::test
