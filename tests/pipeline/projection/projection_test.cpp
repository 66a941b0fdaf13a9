// What a projection promises whatever the cloud: lattice, classes, independence of order and threads, refusals.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "base/error.h"
#include "pipeline/projection/lattice.h"
#include "pipeline/projection/projector.h"
#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

using pipeline::PointClass;
using scene::NodeState;

scene::GridConfig nodes(int size) {
  scene::GridConfig config;
  config.size = size;
  return config;
}

Points small_scan(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Points points;
  sample_surface(points, relief_m, 60000, {0.0002, 0.005}, random);
  sample_surface(
      points, [](double, double) { return -0.07; }, 20000, {0.001, 0.0}, random);
  return points;
}

void expect_same_bytes(const pipeline::Projection& a, const pipeline::Projection& b) {
  ASSERT_EQ(a.grid.lattice.nx, b.grid.lattice.nx);
  ASSERT_EQ(a.grid.lattice.ny, b.grid.lattice.ny);
  EXPECT_EQ(a.grid.lattice.spacing_m, b.grid.lattice.spacing_m);
  EXPECT_EQ(a.grid.lattice.origin_m, b.grid.lattice.origin_m);
  EXPECT_EQ(a.noise_m, b.noise_m);
  EXPECT_EQ(a.point_spacing_m, b.point_spacing_m);
  EXPECT_EQ(0, std::memcmp(a.grid.height_m.data(), b.grid.height_m.data(), a.grid.height_m.size() * sizeof(float)));
  EXPECT_EQ(a.grid.state, b.grid.state);
}

TEST(Projection, GivesTheSameBytesWithAnyNumberOfThreads) {
  const pipeline::Cloud cloud = make_cloud(small_scan(1));
  const pipeline::Projection one = project_cloud(cloud, {}, Eigen::Matrix4d::Identity(), 1);
  for (const unsigned threads : {2U, 3U, 7U}) {
    const pipeline::Projection many = project_cloud(cloud, {}, Eigen::Matrix4d::Identity(), threads);
    expect_same_bytes(one, many);
    EXPECT_EQ(one.point_class, many.point_class);
  }
}

TEST(Projection, GivesTheSameBytesFromAProjectorThatHasLookedFromOtherSides) {
  // Enough for large buffers, which the projector keeps.
  std::mt19937_64 random(13);
  Points points;
  sample_surface(points, relief_m, 1200000, {0.0002, 0.005}, random);
  const pipeline::Cloud cloud = make_cloud(points);
  ThreadPool pool(2);
  Progress progress;
  pipeline::Projector projector(cloud, pool);
  for (const auto& [angle, size] : {std::pair{0.0, 400}, std::pair{0.4, 150}, std::pair{0.0, 400}}) {
    Eigen::Matrix4d turned = Eigen::Matrix4d::Identity();
    turned.topLeftCorner<3, 3>() << std::cos(angle), 0.0, std::sin(angle), 0.0, 1.0, 0.0, -std::sin(angle), 0.0,
        std::cos(angle);
    const pipeline::Projection once = project_cloud(cloud, nodes(size), turned);
    const pipeline::Projection again = projector.project(turned, nodes(size), 0.00005, {pool, progress});
    expect_same_bytes(once, again);
    EXPECT_EQ(once.point_class, again.point_class);
  }
}

TEST(Projection, GivesTheSameBytesForAnyOrderOfThePoints) {
  Points points = small_scan(2);
  // Duplicates and equal heights must not depend on the order either.
  for (std::size_t k = 0; k < 5000; ++k) points.push_back(points[k]);
  for (std::size_t k = 0; k < 5000; ++k) points.push_back({points[k][0], points[k][1], points[0][2]});
  const pipeline::Projection sorted = project_cloud(make_cloud(points), nodes(200));
  std::mt19937_64 random(3);
  for (int round = 0; round < 3; ++round) {
    std::shuffle(points.begin(), points.end(), random);
    const pipeline::Projection shuffled = project_cloud(make_cloud(points), nodes(200));
    expect_same_bytes(sorted, shuffled);
    EXPECT_EQ(sorted.used, shuffled.used);
    EXPECT_EQ(sorted.occluded, shuffled.occluded);
    EXPECT_EQ(sorted.outlier, shuffled.outlier);
    EXPECT_EQ(sorted.outside, shuffled.outside);
  }
}

TEST(Projection, OneFarOutlierDoesNotStretchTheGrid) {
  Points points = small_scan(4);
  const pipeline::Projection plain = project_cloud(make_cloud(points), nodes(200));
  points.push_back({1000.0, 1000.0, 1000.0});
  points.push_back({-1e6, 0.5, 0.0});
  points.push_back({0.5, 3e4, -1e5});
  const pipeline::Projection far = project_cloud(make_cloud(points), nodes(200));
  EXPECT_NEAR(far.grid.lattice.spacing_m, plain.grid.lattice.spacing_m, 0.01 * plain.grid.lattice.spacing_m);
  EXPECT_GE(far.outside, 3U);
}

TEST(Projection, AutomaticSpacingIsTheFrontsOrTheResolution) {
  std::mt19937_64 random(5);
  Points points;
  sample_surface(points, smooth_forms_m, 40000, {0.0001, 0.0}, random);
  sample_surface(
      points, [](double, double) { return -0.3; }, 40000, {0.0001, 0.0}, random);
  const pipeline::Cloud cloud = make_cloud(points);
  const double spacing = 1.0 / std::sqrt(40000.0);
  EXPECT_NEAR(project_cloud(cloud, {}).grid.lattice.spacing_m, spacing, 0.1 * spacing);
  ThreadPool pool(1);
  Progress progress;
  const pipeline::Projection coarse =
      pipeline::project(cloud, Eigen::Matrix4d::Identity(), {}, 3.0 * spacing, {pool, progress});
  EXPECT_DOUBLE_EQ(coarse.grid.lattice.spacing_m, 3.0 * spacing);
}

TEST(Projection, BoundsPlaceNodeZeroAndCropPoints) {
  scene::GridConfig config;
  config.bounds_m = {0.2, 0.3, 0.6, 0.5};
  config.spacing_m = 0.01;
  const pipeline::Projection p = project_cloud(make_cloud(small_scan(6)), config);
  EXPECT_EQ(p.grid.lattice.nx, 41);
  EXPECT_EQ(p.grid.lattice.ny, 21);
  EXPECT_DOUBLE_EQ(p.grid.lattice.x_m(0), 0.2);
  EXPECT_DOUBLE_EQ(p.grid.lattice.y_m(0), 0.3);
  EXPECT_GT(p.outside, 60000U);
  EXPECT_EQ(std::count(p.grid.state.begin(), p.grid.state.end(), NodeState::unknown), 0);
}

TEST(Projection, EveryPointHasAFateAndTheyAddUp) {
  const Points points = small_scan(7);
  const pipeline::Projection p = project_cloud(make_cloud(points), nodes(150));
  ASSERT_EQ(p.point_class.size(), points.size());
  EXPECT_EQ(p.used + p.occluded + p.outlier + p.outside, points.size());
  std::size_t hidden = 0;
  for (std::size_t k = 60000; k < points.size(); ++k) hidden += p.point_class[k] == PointClass::occluded ? 1 : 0;
  EXPECT_GE(hidden, 19500U);
  EXPECT_GE(p.used, 59000U);
  EXPECT_LE(p.used, 60000U);
}

TEST(Projection, HeightsAreNotANumberExactlyWhereTheyAreUnknown) {
  Points points;
  std::mt19937_64 random(8);
  for (const Points::value_type& p : small_scan(8)) {
    if (std::hypot(p[0] - 0.5, p[1] - 0.5) > 0.15) points.push_back(p);
  }
  const pipeline::Projection p = project_cloud(make_cloud(points), nodes(200));
  std::size_t unknown = 0;
  for (int j = 0; j < p.grid.lattice.ny; ++j) {
    for (int i = 0; i < p.grid.lattice.nx; ++i) {
      const std::size_t node = p.grid.lattice.index(i, j);
      EXPECT_EQ(std::isnan(p.grid.height_m[node]), p.grid.state[node] == NodeState::unknown);
      if (std::hypot(p.grid.lattice.x_m(i) - 0.5, p.grid.lattice.y_m(j) - 0.5) < 0.13) {
        EXPECT_EQ(p.grid.state[node], NodeState::unknown) << "a hole must not be measured";
        ++unknown;
      }
    }
  }
  EXPECT_GT(unknown, 1000U);
}

TEST(Projection, AnImpulseComesOutAtItsOwnNode) {
  // A 20 mm pillar of 3 x 3 nodes on a plane, dense; mirrored, swapped or half-cell-shifted axes would move it.
  const auto pillar = [](double x, double y) {
    return std::abs(x - 0.30) < 0.0105 && std::abs(y - 0.80) < 0.0105 ? 0.02 : 0.0;
  };
  std::mt19937_64 random(9);
  Points points;
  sample_surface(points, pillar, 600000, {0.0, 0.0}, random);
  scene::GridConfig config;
  config.bounds_m = {0.0, 0.0, 1.0, 1.0};
  config.spacing_m = 0.005;
  const pipeline::Projection p = project_cloud(make_cloud(points), config);
  double weight = 0.0;
  double x = 0.0;
  double y = 0.0;
  for (int j = 0; j < p.grid.lattice.ny; ++j) {
    for (int i = 0; i < p.grid.lattice.nx; ++i) {
      const std::size_t node = p.grid.lattice.index(i, j);
      if (p.grid.state[node] != NodeState::measured) continue;
      const double h = static_cast<double>(p.grid.height_m[node]) + p.grid.lattice.origin_m.z();
      weight += h;
      x += h * p.grid.lattice.x_m(i);
      y += h * p.grid.lattice.y_m(j);
    }
  }
  // A node on the pillar's rim may fall on either side; half a cell may not.
  EXPECT_NEAR(x / weight, 0.30, 0.2 * config.spacing_m);
  EXPECT_NEAR(y / weight, 0.80, 0.2 * config.spacing_m);
}

TEST(Projection, AffineWithScaleAndShearIsApplied) {
  std::mt19937_64 random(10);
  Points points;
  sample_surface(points, smooth_forms_m, 100000, {0.0, 0.0}, random);
  Eigen::Matrix4d affine;
  affine << 2.0, 0.5, 0.0, 10.0, 0.0, 2.0, 0.0, -3.0, 0.0, 0.3, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0;
  const pipeline::Projection p = project_cloud(make_cloud(points), nodes(100), affine);
  const Eigen::Matrix4d back = affine.inverse();
  double worst = 0.0;
  std::size_t measured = 0;
  for (int j = 5; j < p.grid.lattice.ny - 5; ++j) {
    for (int i = 5; i < p.grid.lattice.nx - 5; ++i) {
      const std::size_t node = p.grid.lattice.index(i, j);
      if (p.grid.state[node] != NodeState::measured) continue;
      const double z = static_cast<double>(p.grid.height_m[node]) + p.grid.lattice.origin_m.z();
      const Eigen::Vector4d scan = back * Eigen::Vector4d(p.grid.lattice.x_m(i), p.grid.lattice.y_m(j), z, 1.0);
      worst = std::max(worst, std::abs(scan.z() - smooth_forms_m(scan.x(), scan.y())));
      ++measured;
    }
  }
  EXPECT_GT(measured, 3000U);
  EXPECT_LE(worst, 0.1 * p.grid.lattice.spacing_m);
}

TEST(Projection, RefusesCloudsThatMeasureNoNode) {
  const auto refuses = [](const Points& points) {
    try {
      static_cast<void>(project_cloud(make_cloud(points), {}));
    } catch (const Error& error) {
      return error.kind() == ErrorKind::input;
    }
    return false;
  };
  EXPECT_TRUE(refuses({}));
  EXPECT_TRUE(refuses({{0.1, 0.2, 0.3}}));
  EXPECT_TRUE(refuses({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}));
}

TEST(Projection, SurvivesDegenerateClouds) {
  Points line;
  Points same;
  Points vertical;
  for (int k = 0; k < 500; ++k) {
    line.push_back({0.001 * k, 0.002 * k, 0.0005 * k});
    same.push_back({0.25, 0.5, 0.75});
    vertical.push_back({0.001 * (k % 2), 0.0, 0.001 * k});
  }
  for (const Points* points : {&line, &same, &vertical}) {
    try {
      const pipeline::Projection p = project_cloud(make_cloud(*points), nodes(50));
      for (std::size_t node = 0; node < p.grid.height_m.size(); ++node) {
        EXPECT_EQ(std::isnan(p.grid.height_m[node]), p.grid.state[node] == NodeState::unknown);
      }
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
    }
  }
}

TEST(Projection, ManyCopiesOfAPointLeaveItsNeighboursAsTheyAre) {
  std::mt19937_64 random(15);
  Points points;
  sample_surface(points, smooth_forms_m, 40'000, {0.0002, 0.0}, random);
  const pipeline::Projection plain = project_cloud(make_cloud(points), nodes(128));
  points.insert(points.end(), 200'000, {0.5, 0.5, smooth_forms_m(0.5, 0.5) + 0.2});
  const pipeline::Projection p = project_cloud(make_cloud(points), nodes(128));
  ASSERT_EQ(p.grid.height_m.size(), plain.grid.height_m.size());
  std::size_t far = 0;
  for (std::size_t node = 0; node < p.grid.height_m.size(); ++node) {
    const double change = static_cast<double>(p.grid.height_m[node]) - static_cast<double>(plain.grid.height_m[node]);
    if (!(std::abs(change) < 0.005)) ++far;
  }
  EXPECT_LE(far, 49U) << "a node's window has seven nodes per side at most where points are dense";
}

TEST(Projection, AReliefWhosePointsAreToldSeveralTimesIsMeasuredAsIfTheyWereToldOnce) {
  std::mt19937_64 random(16);
  Points points;
  sample_surface(points, smooth_forms_m, 40'000, {0.0002, 0.0}, random);
  const Points once = points;
  const auto everywhere = [](double, double) { return true; };
  for (const int count : {100, 201, 401}) {
    const Errors plain = judge(project_cloud(make_cloud(once), nodes(count)).grid, smooth_forms_m, everywhere);
    points = once;
    for (const int copies : {2, 5}) {
      while (points.size() < static_cast<std::size_t>(copies) * once.size()) {
        points.insert(points.end(), once.begin(), once.end());
      }
      const Errors often = judge(project_cloud(make_cloud(points), nodes(count)).grid, smooth_forms_m, everywhere);
      EXPECT_GE(often.measured, plain.measured - 0.001) << count << " nodes, " << copies << " copies";
      // Blocks of the statistics are laid out anew, which moves the noise, and weights with it, a little.
      EXPECT_LE(often.rms_m, 1.2 * plain.rms_m) << count << " nodes, " << copies << " copies";
    }
  }
}

TEST(Projection, RefusesGridsThatCannotFit) {
  const pipeline::Cloud cloud = make_cloud(small_scan(11));
  for (const double spacing : {1e-9, 1e-5, 3e-5}) {
    scene::GridConfig config;
    config.spacing_m = spacing;
    config.bounds_m = {0.0, 0.0, 10.0, 10.0};
    try {
      static_cast<void>(project_cloud(cloud, config));
      ADD_FAILURE() << "spacing " << spacing << " was not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
    }
  }
}

TEST(Projection, AutomaticBoundsLeaveNoRowOfRegularDataOutside) {
  for (const double spacing_m : {0.001, 0.0007, 1.0 / 3.0}) {
    for (const double asked : {0.0, 0.93, 1.0, 1.02, 1.3}) {  // times the points' own
      Points points;
      for (int j = 0; j < 60; ++j) {
        for (int i = 0; i < 60; ++i) points.push_back({i * spacing_m, j * spacing_m, 0.0});
      }
      scene::GridConfig config;
      config.spacing_m = asked * spacing_m;
      const pipeline::Projection p = project_cloud(make_cloud(points), config);
      EXPECT_EQ(p.outside, 0U) << spacing_m << ' ' << asked;
      if (asked == 1.0) {
        EXPECT_EQ(p.grid.lattice.count(), 3600U) << spacing_m;
      }
    }
  }
}

TEST(Projection, AnAutomaticGridOfUnevenPointsHasAtMostSixteenNodesAPoint) {
  // Most points stand close together, the object is a thousand times as large.
  Points points;
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 40; ++i) {
      points.push_back({i * 0.001, j * 0.001, 0.0});
      if (i % 2 == 0 && j % 2 == 0) points.push_back({i * 1.0, j * 1.0, 0.0});
    }
  }
  const pipeline::Projection p = project_cloud(make_cloud(points), {});
  EXPECT_LE(p.grid.lattice.count(), 16U * points.size());
}

TEST(Lattice, BoundsThatAreItsOwnNodesGiveItAgainWhereverItLies) {
  for (const double x0_m : {0.0, -0.3, 412345.678, 5312345.123, -7.1e6})
    for (const double spacing_m : {1e-4, 0.002, 0.01, 0.05, 0.25})
      for (int nx = 2; nx < 200; ++nx) {
        scene::Lattice own;
        own.nx = nx;
        own.ny = 7 + nx % 5;
        own.spacing_m = spacing_m;
        own.origin_m = {x0_m, 0.9 * x0_m, 0.0};
        scene::GridConfig config;
        config.spacing_m = spacing_m;
        config.bounds_m = {own.x_m(0), own.y_m(0), own.x_m(own.nx - 1), own.y_m(own.ny - 1)};
        const scene::Lattice again = pipeline::choose_lattice(config, {}, Eigen::Vector3d::Zero(), spacing_m, 0.0);
        ASSERT_EQ(again.nx, own.nx) << x0_m << ", " << spacing_m;
        ASSERT_EQ(again.ny, own.ny) << x0_m << ", " << spacing_m;
      }
}

}  // namespace
}  // namespace sparsha::test
