// A floor under an object, seen from its front, is no evidence against the surface; scattered points are.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "pipeline/projection/edge_on.h"
#include "pipeline/projection/projector.h"
#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

using pipeline::PointClass;

constexpr double kApart_m = 0.004;
constexpr double kNoise_m = 0.0004;

scene::GridConfig spacing(double spacing_m) {
  scene::GridConfig config;
  config.spacing_m = spacing_m;
  return config;
}

/// A dome towards the viewer (+z) on a panel, over a floor (y = 0) and beside a wall (x = -0.3), and scattered points.
struct Room {
  Points points;
  std::size_t object = 0, planes = 0, scattered = 0;  // in this order
};

Room room(double floor_apart_m, std::size_t scattered, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, kNoise_m);
  Room room;
  const auto count = [](double area_m2, double apart_m) {
    return static_cast<std::size_t>(area_m2 / (apart_m * apart_m));
  };
  room.object = count(0.6 * 0.5, kApart_m);
  for (std::size_t k = 0; k < room.object; ++k) {
    const double x = 0.6 * unit(random) - 0.3;
    const double y = 0.5 * unit(random) + 0.02;
    const double r2 = x * x + (y - 0.25) * (y - 0.25);
    room.points.push_back({x, y, 0.1 * std::exp(-r2 / 0.01) + noise(random)});
  }
  const std::size_t floor = count(0.6 * 0.8, floor_apart_m);
  for (std::size_t k = 0; k < floor; ++k)
    room.points.push_back({0.6 * unit(random) - 0.3, noise(random) - 0.05, 0.8 * unit(random) - 0.2});
  const std::size_t wall = count(0.5 * 0.8, floor_apart_m) / 2;
  for (std::size_t k = 0; k < wall; ++k)
    room.points.push_back({-0.35 + noise(random), 0.5 * unit(random), 0.8 * unit(random) - 0.2});
  room.planes = floor + wall;
  room.scattered = scattered;
  for (std::size_t k = 0; k < scattered; ++k)
    room.points.push_back({0.7 * unit(random) - 0.35, 0.6 * unit(random) - 0.05, 0.8 * unit(random) - 0.2});
  return room;
}

struct Classes {
  double planes_as_outliers = 0.0;  // of all points on them
  double scattered_kept = 0.0;      // of the scattered ones before the surface, those that still count as outliers
};

Classes classes_of(const Room& room, const pipeline::Projection& projection) {
  Classes shares;
  for (std::size_t k = 0; k < room.planes; ++k)
    shares.planes_as_outliers += projection.point_class[room.object + k] == PointClass::outlier ? 1.0 : 0.0;
  shares.planes_as_outliers /= static_cast<double>(std::max<std::size_t>(1, room.planes));
  std::size_t before = 0;
  for (std::size_t k = room.object + room.planes; k < room.points.size(); ++k) {
    const auto& p = room.points[k];
    // Well away from all planes and in front of the dome.
    if (p[2] < 0.15 || p[1] < 0.0 || p[0] < -0.3) continue;
    ++before;
    shares.scattered_kept += projection.point_class[k] == PointClass::outlier ? 1.0 : 0.0;
  }
  if (before > 0) shares.scattered_kept /= static_cast<double>(before);
  return shares;
}

TEST(EdgeOn, ARoundWallHasNoPlaneThatCouldBeTakenAway) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, kNoise_m);
  const auto projected = [&](bool round) {
    Points points;
    for (int k = 0; k < 15'000; ++k)
      points.push_back({0.6 * unit(random) - 0.3, 0.6 * unit(random) - 0.3, noise(random)});
    for (int k = 0; k < 15'000; ++k) {
      const double turn = 2.0 * std::numbers::pi * unit(random), r = 0.25 + noise(random);
      const double along = 0.5 * unit(random) - 0.25;
      points.push_back({round ? r * std::cos(turn) : along, round ? r * std::sin(turn) : r, 0.5 * unit(random)});
    }
    return project_cloud(make_cloud(points), spacing(kApart_m));
  };
  const pipeline::Projection pit = projected(true), step = projected(false);
  EXPECT_GT(pit.edge_on, 5'000U);
  EXPECT_TRUE(pit.edge_on_normal.isZero()) << pit.edge_on_normal.transpose();
  EXPECT_GT(step.edge_on, 1'000U);
  EXPECT_GT(std::abs(step.edge_on_normal.y()), 0.99) << step.edge_on_normal.transpose();
}

TEST(EdgeOn, FloorAndWallAreNoOutliersAndScatteredPointsAre) {
  for (const double floor_apart_m : {kApart_m, 0.6 * kApart_m, 1.8 * kApart_m}) {
    const Room here = room(floor_apart_m, 3000, 5);
    const pipeline::Projection projection = project_cloud(make_cloud(here.points), spacing(kApart_m));
    const Classes shares = classes_of(here, projection);
    // However many points lie on the planes.
    EXPECT_NEAR(projection.noise_m, kNoise_m, 0.1 * kNoise_m) << floor_apart_m;
    EXPECT_NEAR(projection.point_spacing_m, kApart_m, 0.1 * kApart_m) << floor_apart_m;
    EXPECT_LE(shares.planes_as_outliers, floor_apart_m > kApart_m ? 0.06 : 0.03) << floor_apart_m;
    EXPECT_GE(shares.scattered_kept, 0.95) << floor_apart_m;
    EXPECT_GT(projection.edge_on, here.planes / 10) << floor_apart_m;
    EXPECT_EQ(projection.used + projection.occluded + projection.outlier + projection.outside, here.points.size());
    // The floor is the larger, and the object stands on it.
    EXPECT_GT(projection.edge_on_normal.y(), 0.99) << projection.edge_on_normal.transpose();
  }
}

TEST(EdgeOn, ScatteredPointsAloneAreNoSurface) {
  for (const std::size_t scattered : {3000U, 20000U}) {
    Room here = room(kApart_m, scattered, 6);
    here.points.erase(here.points.begin() + static_cast<std::ptrdiff_t>(here.object),
                      here.points.begin() + static_cast<std::ptrdiff_t>(here.object + here.planes));
    here.planes = 0;
    const pipeline::Projection projection = project_cloud(make_cloud(here.points), spacing(kApart_m));
    EXPECT_LE(static_cast<double>(projection.edge_on), 0.01 * static_cast<double>(scattered));
  }
}

TEST(EdgeOn, ASurfaceThatFacesTheViewerCounts) {
  // A plate that no node shows: what is taken out must be along the line of sight.
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-0.05, 0.05);
  for (const double tilt_deg : {0.0, 20.0, 45.0, 60.0, 85.0, 90.0}) {
    const double tilt = tilt_deg * std::numbers::pi / 180.0;
    Points plate;
    for (int k = 0; k < 4000; ++k) {
      const double u = unit(random);
      const double v = unit(random);
      plate.push_back({u, v * std::cos(tilt), v * std::sin(tilt)});
    }
    const pipeline::Cloud cloud = make_cloud(plate);
    pipeline::BinLattice lattice;
    lattice.nx = lattice.ny = 100;
    lattice.spacing_m = 0.002;
    lattice.x0_m = lattice.y0_m = -0.1;
    ThreadPool pool(2);
    const pipeline::OrientedPoints points = pipeline::orient_points(
        pipeline::raw_points(cloud), cloud.origin_m, Eigen::Matrix4d::Identity(), Eigen::Vector3d::Zero(), pool);
    std::vector<PointClass> classes(points.count, PointClass::outlier);
    pipeline::EdgeOnSurfaces surfaces(lattice, 0.0016);
    surfaces.add(points, classes.data());
    const auto share =
        static_cast<double>(surfaces.take_out(points, classes.data(), pool)) / static_cast<double>(points.count);
    if (tilt_deg > 80.0) {
      EXPECT_GE(share, 0.99) << tilt_deg;
    } else {
      EXPECT_EQ(share, 0.0) << tilt_deg;
    }
  }
}

TEST(EdgeOn, NeitherOrderNorThreadsChangeAClass) {
  Room here = room(kApart_m, 3000, 8);
  const pipeline::Projection one =
      project_cloud(make_cloud(here.points), spacing(kApart_m), Eigen::Matrix4d::Identity(), 1);
  std::mt19937_64 random(9);
  std::shuffle(here.points.begin(), here.points.end(), random);
  const pipeline::Projection other =
      project_cloud(make_cloud(here.points), spacing(kApart_m), Eigen::Matrix4d::Identity(), 3);
  EXPECT_EQ(one.edge_on, other.edge_on);
  EXPECT_EQ(one.outlier, other.outlier);
  EXPECT_EQ(one.edge_on_normal, other.edge_on_normal);
}

}  // namespace
}  // namespace sparsha::test
