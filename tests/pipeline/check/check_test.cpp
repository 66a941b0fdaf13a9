// The cross-check against brute force and dense sampling on small clouds.
#include "pipeline/check/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>

#include "base/numbers/hash.h"
#include "pipeline/check/nearest.h"
#include "pipeline/check/points.h"
#include "pipeline/check/statistics.h"
#include "pipeline/check/surface.h"
#include "scene/scene.h"
#include "tests/support/checked_cloud.h"

namespace sparsha::pipeline {
namespace {

using testing::cloud_of;
using testing::grid_of;
using testing::lattice_of;
using testing::projection_of;

/// Rough ground with a step, and spikes of `spike` here and there.
scene::DepthGrid rough_grid(const scene::Lattice& lattice, double spike, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  scene::DepthGrid grid = grid_of(lattice, [&](double x, double y) {
    const double s = lattice.spacing_m;
    return 2 * s * std::sin(x / s / 4) * std::cos(y / s / 5) + 0.3 * s * unit(random) + (x > 12 * s ? 5 * s : 0.0);
  });
  for (std::size_t n = 0; n < grid.height_m.size(); ++n) {
    if (random() % 40 == 0) grid.height_m[n] += static_cast<float>(spike);
    if (random() % 15 == 0) {
      grid.height_m[n] = scene::kUnknownHeight;
      grid.state[n] = scene::NodeState::unknown;
    }
  }
  return grid;
}

/// Distance to the densely sampled surface: `n` x `n` places in every known cell.
double sampled_distance(const scene::DepthGrid& grid, const Eigen::Vector3d& p, int n) {
  const scene::Lattice& l = grid.lattice;
  double best = std::numeric_limits<double>::infinity();
  for (int j = 0; j + 1 < l.ny; ++j)
    for (int i = 0; i + 1 < l.nx; ++i) {
      const double z00 = grid.height_m[l.index(i, j)], z10 = grid.height_m[l.index(i + 1, j)],
                   z01 = grid.height_m[l.index(i, j + 1)], z11 = grid.height_m[l.index(i + 1, j + 1)];
      if (std::isnan(z00 + z10 + z01 + z11)) continue;
      for (int b = 0; b <= n; ++b)
        for (int a = 0; a <= n; ++a) {
          const double u = static_cast<double>(a) / n, v = static_cast<double>(b) / n;
          const Eigen::Vector3d q((i + u) * l.spacing_m, (j + v) * l.spacing_m,
                                  z00 * (1 - u) * (1 - v) + z10 * u * (1 - v) + z01 * (1 - u) * v + z11 * u * v);
          best = std::min(best, (p - q).norm());
        }
    }
  return best;
}

TEST(SurfaceIndex, FindsTheNearestCellOfRoughGroundWithSpikes) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(-0.3, 1.3);
  for (const double spike : {0.0, 0.05, 3.0}) {
    const scene::DepthGrid grid = rough_grid(lattice_of(30, 22, 0.001), spike, 5);
    const SurfaceIndex surface(grid);
    for (int k = 0; k < 60; ++k) {
      const Eigen::Vector3d p(0.029 * unit(random), 0.021 * unit(random),
                              0.02 * unit(random) + (k % 5 == 0 ? spike / 2 : 0.0));
      const double found = surface.distance(p.x(), p.y(), p.z()).distance_m;
      const double oracle = sampled_distance(grid, p, 24);
      ASSERT_LE(found, oracle * (1 + 1e-9));
      // Half a sample's diagonal on the steepest cells is spike / 24; on the others the slack is far smaller.
      ASSERT_GE(found, oracle - (0.004 + spike) / 24) << p.transpose();
    }
  }
}

TEST(SurfaceIndex, AgreesWithTheWalkAcrossTheLattice) {
  const scene::DepthGrid grid = rough_grid(lattice_of(90, 70, 0.002), 0.004, 6);
  const SurfaceIndex surface(grid);
  std::mt19937 random(18);
  std::uniform_real_distribution<double> unit(-0.1, 1.1);
  for (int k = 0; k < 4000; ++k) {
    const double x = 0.178 * unit(random), y = 0.138 * unit(random), z = 0.06 * unit(random) - 0.01;
    const SurfaceDistance tree = surface.distance(x, y, z), walk = surface.distance_by_walking(x, y, z, 200);
    ASSERT_NEAR(tree.distance_m, walk.distance_m, 1e-9) << x << ' ' << y << ' ' << z;
  }
}

TEST(SurfaceIndex, SignsDistancesTowardsTheViewer) {
  const scene::DepthGrid grid = grid_of(lattice_of(10, 10, 0.01), [](double x, double) { return 2 * x; });
  const SurfaceIndex surface(grid);
  EXPECT_GT(surface.distance(0.05, 0.05, 0.12).signed_m, 0);
  EXPECT_LT(surface.distance(0.05, 0.05, 0.08).signed_m, 0);
}

TEST(SurfaceIndex, IsInfinitelyFarFromNoSurface) {
  const scene::DepthGrid grid(lattice_of(10, 10, 0.01));
  const SurfaceIndex surface(grid);
  EXPECT_TRUE(std::isinf(surface.distance(0, 0, 0).distance_m));
}

TEST(NearestPoint, AgreesWithBruteForceForDenseSparseAndDistantClouds) {
  std::mt19937 random(19);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const auto& [count, offset] : {std::pair{3000, 0.0}, {40, 0.0}, {1, 0.0}, {500, 0.9}}) {
    const scene::DepthGrid grid = rough_grid(lattice_of(120, 160, 0.01), 0.1, 7);
    std::vector<float> xyz;
    for (int k = 0; k < count; ++k) {
      xyz.push_back(static_cast<float>(1.2 * unit(random) + offset));
      xyz.push_back(static_cast<float>(1.6 * unit(random) * (offset > 0 ? 0.1 : 1)));
      xyz.push_back(static_cast<float>(0.05 * unit(random)));
    }
    std::vector<std::uint64_t> nodes;
    for (std::uint64_t n = 0; n < grid.lattice.count(); n += 1 + random() % 20)
      if (grid.state[n] == scene::NodeState::measured) nodes.push_back(n);
    ThreadPool pool(2);
    const BandedPoints points(
        grid.lattice, xyz.size() / 3,
        [&](std::size_t begin, std::size_t end, float* out) {
          std::copy(xyz.begin() + static_cast<std::ptrdiff_t>(3 * begin),
                    xyz.begin() + static_cast<std::ptrdiff_t>(3 * end), out);
          return end - begin;
        },
        pool);
    const std::vector<float> found = nearest_point_distances(grid, nodes, points.counted(), 0.01, pool);
    ASSERT_EQ(found.size(), nodes.size());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Eigen::Vector3d node(static_cast<double>(nodes[k] % 120) * 0.01, static_cast<double>(nodes[k] / 120) * 0.01,
                                 grid.height_m[nodes[k]]);
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t p = 0; p < xyz.size(); p += 3)
        best = std::min(best, (node - Eigen::Vector3d(xyz[p], xyz[p + 1], xyz[p + 2])).norm());
      ASSERT_NEAR(std::abs(found[k]), best, 1e-6) << count << " points, node " << nodes[k];
    }
  }
}

TEST(NearestPoint, OfManyPointsToANodeAreThoseOfBruteForceInAnyOrder) {
  constexpr int kNx = 7, kNy = 61;
  const scene::DepthGrid grid = rough_grid(lattice_of(kNx, kNy, 0.01), 0.1, 7);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(0, 1);
  // Where there are none, at the far end, the nearest is many rows away.
  std::vector<std::array<float, 3>> cloud;
  for (int k = 0; k < 12 * kNx * kNy; ++k)
    cloud.push_back({static_cast<float>(0.06 * unit(random)), static_cast<float>(0.25 * unit(random) - 0.02),
                     static_cast<float>(0.05 * unit(random))});
  std::vector<std::uint64_t> nodes;
  for (std::uint64_t n = 0; n < grid.lattice.count(); ++n)
    if (grid.state[n] == scene::NodeState::measured) nodes.push_back(n);
  ThreadPool pool(2);
  const auto distances = [&] {
    const BandedPoints points(
        grid.lattice, cloud.size(),
        [&](std::size_t begin, std::size_t end, float* out) {
          std::copy_n(cloud[begin].data(), 3 * (end - begin), out);
          return end - begin;
        },
        pool);
    return nearest_point_distances(grid, nodes, points.counted(), 0.001, pool);
  };
  const std::vector<float> found = distances();
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Eigen::Vector3d node(static_cast<double>(nodes[k] % kNx) * 0.01, static_cast<double>(nodes[k] / kNx) * 0.01,
                               grid.height_m[nodes[k]]);
    double best = std::numeric_limits<double>::infinity();
    for (const std::array<float, 3>& p : cloud)
      best = std::min(best, (node - Eigen::Vector3d(p[0], p[1], p[2])).norm());
    ASSERT_NEAR(std::abs(found[k]), best, 1e-7) << "node " << nodes[k];
  }
  std::shuffle(cloud.begin(), cloud.end(), random);
  EXPECT_EQ(distances(), found);
}

TEST(Statistics, AreThoseOfAHandCountedSample) {
  const DistanceStatistics s = statistics_of({1, -2, 3, -4, 10}, 5);
  EXPECT_EQ(s.samples, 5U);
  EXPECT_DOUBLE_EQ(s.mean_m, 4);
  EXPECT_DOUBLE_EQ(s.rms_m, std::sqrt(130.0 / 5));
  EXPECT_DOUBLE_EQ(s.median_m, 3);
  EXPECT_DOUBLE_EQ(s.mad_m, 1);
  EXPECT_DOUBLE_EQ(s.p95_m, 10);
  EXPECT_DOUBLE_EQ(s.max_m, 10);
  EXPECT_DOUBLE_EQ(s.signed_mean_m, 1.6);
  EXPECT_EQ(s.mean_ci95_m, 0);
  EXPECT_EQ(statistics_of({}, 0).samples, 0U);
}

TEST(Statistics, ConfidenceIntervalsHoldTheTrueMeanNineteenTimesInTwenty) {
  std::mt19937 random(20);
  std::exponential_distribution<float> draw(1000.0F);
  std::vector<float> population(20000);
  double mean = 0;
  for (float& v : population) mean += (v = draw(random)) / 20000.0;
  int held = 0;
  constexpr int kRounds = 600;
  for (int round = 0; round < kRounds; ++round) {
    std::shuffle(population.begin(), population.end(), random);
    const DistanceStatistics s = statistics_of({population.begin(), population.begin() + 2000}, 20000);
    held += std::abs(s.mean_m - mean) <= s.mean_ci95_m ? 1 : 0;
  }
  const double sigma = std::sqrt(0.95 * 0.05 * kRounds);
  EXPECT_NEAR(held, 0.95 * kRounds, 4 * sigma);
}

TEST(Statistics, SamplesHaveTheSizeThatWasAskedFor) {
  const auto size_of = [](std::size_t population, std::uint64_t wanted, const auto& key) {
    return choose_sample(population, wanted,
                         [&](const auto& offer) {
                           for (std::size_t n = 0; n < population; ++n) offer(key(n), n);
                         })
        .size();
  };
  const auto size = [&](std::uint64_t wanted) { return size_of(10000, wanted, hash_word); };
  for (const std::uint64_t wanted : {1U, 2U, 50U, 5000U, 9999U}) EXPECT_EQ(size(wanted), wanted);
  EXPECT_EQ(size(0), 10000U);
  EXPECT_EQ(size(20000), 10000U);
  EXPECT_EQ(size_of(100, 10, [](std::size_t) { return std::uint64_t{42}; }), 10U);
}

TEST(Statistics, SamplesNameItemsBeyondFourThousandMillion) {
  // Numbers that 32 bits would cut to others, or to the same.
  constexpr std::uint64_t kFirst = (std::uint64_t{1} << 32U) - 3, kCount = 1000;
  const std::vector<std::uint64_t> sample = choose_sample(kCount, 50, [&](const auto& offer) {
    for (std::uint64_t n = kFirst; n < kFirst + kCount; ++n) offer(hash_word(n), n);
  });
  ASSERT_EQ(sample.size(), 50U);
  std::vector<std::uint64_t> expected(kCount);
  std::iota(expected.begin(), expected.end(), kFirst);
  std::sort(expected.begin(), expected.end(),
            [](std::uint64_t a, std::uint64_t b) { return hash_word(a) < hash_word(b); });
  expected.resize(50);
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(sample, expected);
}

/// A noisy plane with outliers, seen through a turned scan frame with a large origin.
struct Scene {
  Eigen::Matrix4d scan_to_grid = Eigen::Matrix4d::Identity();
  std::vector<Eigen::Vector3d> in_grid, in_scan;
  std::vector<PointClass> point_class;
  scene::DepthGrid grid;
  Eigen::Vector3d origin{1000, -500, 200};

  explicit Scene(int count, unsigned seed) {
    const Eigen::Vector3d corner(3, 4, 5);
    scan_to_grid.topLeftCorner<3, 3>() =
        Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    scan_to_grid.topRightCorner<3, 1>() = corner - scan_to_grid.topLeftCorner<3, 3>() * origin;
    grid = grid_of(lattice_of(80, 60, 0.005, corner), [](double x, double y) { return 0.1 * x + 0.2 * y; });
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> noise(0, 0.0005);
    for (int k = 0; k < count; ++k) {
      const double x = 0.39 * unit(random), y = 0.29 * unit(random);
      point_class.push_back(k % 50 == 0 ? PointClass::outlier : k % 31 == 0 ? PointClass::occluded : PointClass::used);
      const double dz = k % 50 == 0 ? 0.03 : k % 31 == 0 ? -0.1 : noise(random);
      in_grid.push_back(corner + Eigen::Vector3d(x, y, 0.1 * x + 0.2 * y + dz));
      in_scan.push_back((scan_to_grid.inverse() * in_grid.back().homogeneous()).head<3>());
    }
  }
  [[nodiscard]] Projection projection() const {
    Projection result = projection_of(grid, in_scan.size());
    result.point_class = point_class;
    result.noise_m = 0.0005;
    return result;
  }
};

CheckResult run(const Scene& scene, std::int64_t samples, unsigned threads,
                const std::optional<scene::FillConfig>& fill = {}) {
  ThreadPool pool(threads);
  Progress progress;
  progress.begin("check");
  return cross_check(cloud_of(scene.in_scan, scene.origin), scene.scan_to_grid, scene.projection(), fill, {samples},
                     {pool, progress});
}

TEST(CrossCheck, MeasuresEveryPointThatCountsOutliersIncluded) {
  const Scene scene(6000, 1);
  const CheckResult result = run(scene, 0, 2);
  // On a plane the distance of a point is that along the normal; the lattice's border is farther than any point's.
  const double norm = std::sqrt(1 + 0.1 * 0.1 + 0.2 * 0.2);
  std::vector<double> oracle;
  double signed_sum = 0;
  for (std::size_t k = 0; k < scene.in_grid.size(); ++k) {
    if (scene.point_class[k] == PointClass::occluded) continue;
    const Eigen::Vector3d p = scene.in_grid[k] - Eigen::Vector3d(3, 4, 5);
    const double distance = (p.z() - 0.1 * p.x() - 0.2 * p.y()) / norm;
    oracle.push_back(std::abs(distance));
    signed_sum += distance;
  }
  const double n = static_cast<double>(oracle.size());
  // Points and heights are floats relative to origins some 0.4 m away.
  const double rounding = 2e-7;
  EXPECT_EQ(result.cloud_to_surface.samples, oracle.size());
  EXPECT_NEAR(result.cloud_to_surface.mean_m, std::accumulate(oracle.begin(), oracle.end(), 0.0) / n, rounding);
  EXPECT_NEAR(result.cloud_to_surface.signed_mean_m, signed_sum / n, rounding);
  std::sort(oracle.begin(), oracle.end());
  EXPECT_NEAR(result.cloud_to_surface.max_m, oracle.back(), rounding);
  EXPECT_NEAR(result.cloud_to_surface.median_m, oracle[oracle.size() / 2], 1e-6);
  EXPECT_EQ(result.cloud_to_surface.mean_ci95_m, 0);
  EXPECT_GT(result.second_method_samples, 1000U);
  EXPECT_LT(result.second_method_max_difference_m, 1e-9);
  EXPECT_EQ(result.surface_to_cloud.samples, 80U * 60U);
  ASSERT_FALSE(result.node_errors.node.empty());
  EXPECT_EQ(result.node_errors.node.size(), result.node_errors.error_m.size());
  EXPECT_TRUE(std::is_sorted(result.node_errors.node.begin(), result.node_errors.node.end()));
  EXPECT_LT(result.node_errors.node.back(), 80U * 60U);
}

TEST(CrossCheck, SamplesAsManyAsAskedForAndStatesTheirConfidence) {
  const Scene scene(20000, 2);
  const CheckResult all = run(scene, 0, 1), some = run(scene, 2000, 1);
  EXPECT_EQ(some.cloud_to_surface.samples, 2000U);
  EXPECT_EQ(some.surface_to_cloud.samples, 2000U);
  EXPECT_GT(some.cloud_to_surface.mean_ci95_m, 0);
  EXPECT_NEAR(some.cloud_to_surface.mean_m, all.cloud_to_surface.mean_m, 2 * some.cloud_to_surface.mean_ci95_m);
}

TEST(CrossCheck, DependsNeitherOnThreadsNorOnTheOrderOfPoints) {
  Scene scene(20000, 3);
  const CheckResult one = run(scene, 3000, 1), three = run(scene, 3000, 3);
  std::vector<std::size_t> order(scene.in_scan.size());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(4);
  std::shuffle(order.begin(), order.end(), random);
  Scene shuffled = scene;
  for (std::size_t k = 0; k < order.size(); ++k) {
    shuffled.in_scan[k] = scene.in_scan[order[k]];
    shuffled.point_class[k] = scene.point_class[order[k]];
  }
  const CheckResult mixed = run(shuffled, 3000, 2);
  for (const CheckResult* other : {&three, &mixed}) {
    for (const auto& [a, b] : {std::pair{&one.cloud_to_surface, &other->cloud_to_surface},
                               std::pair{&one.surface_to_cloud, &other->surface_to_cloud}})
      EXPECT_EQ(std::memcmp(a, b, sizeof *a), 0);
    EXPECT_EQ(one.completeness, other->completeness);
    EXPECT_EQ(one.cloud_histogram, other->cloud_histogram);
  }
}

TEST(CrossCheck, CompletenessCountsMeasuredNodesWithAPointInsideTheOutline) {
  // A plane of 40 x 40 measured nodes with a hole of 10 x 10; the points of the right half are missing.
  scene::DepthGrid grid = grid_of(lattice_of(40, 40, 0.01), [](double, double) { return 0; });
  for (int j = 15; j < 25; ++j)
    for (int i = 5; i < 15; ++i) {
      grid.height_m[grid.lattice.index(i, j)] = scene::kUnknownHeight;
      grid.state[grid.lattice.index(i, j)] = scene::NodeState::unknown;
    }
  std::vector<Eigen::Vector3d> points;
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 20; ++i) points.emplace_back(0.01 * i, 0.01 * j, 0.002);
  ThreadPool pool(1);
  Progress progress;
  progress.begin("check");
  const CheckResult result = cross_check(cloud_of(points), Eigen::Matrix4d::Identity(),
                                         projection_of(grid, points.size()), {}, {0}, {pool, progress});
  EXPECT_DOUBLE_EQ(result.tolerance_m, 0.01);
  // Inside the outline lie all 1600 nodes. Column 20 is 10.2 mm from the last point, so only 800 - 100 have one.
  EXPECT_DOUBLE_EQ(*result.completeness, 700.0 / 1600);
}

TEST(CrossCheck, ANoiseOfMoreThanHalfThePointSpacingDoesNotWidenTheTolerance) {
  const Scene scene(2000, 5);
  ThreadPool pool(1);
  Progress progress;
  progress.begin("check");
  Projection projection = scene.projection();
  const double spacing_m = projection.grid.lattice.spacing_m;
  projection.point_spacing_m = 4.0 * spacing_m;
  const auto tolerance = [&](double noise_m) {
    projection.noise_m = noise_m;
    return cross_check(cloud_of(scene.in_scan, scene.origin), scene.scan_to_grid, projection, {}, {}, {pool, progress})
        .tolerance_m;
  };
  EXPECT_DOUBLE_EQ(tolerance(0.1 * spacing_m), spacing_m);
  EXPECT_DOUBLE_EQ(tolerance(1.0 * spacing_m), 3.0 * spacing_m);
  for (const double noise : {2.0, 20.0, 2000.0}) EXPECT_DOUBLE_EQ(tolerance(noise * spacing_m), 6.0 * spacing_m);
}

TEST(CrossCheck, SaysNothingWhereThereIsNothing) {
  Cloud cloud;
  ThreadPool pool(1);
  Progress progress;
  progress.begin("check");
  const CheckResult result =
      cross_check(cloud, Eigen::Matrix4d::Identity(), projection_of(scene::DepthGrid(lattice_of(5, 5, 1)), 0), {}, {},
                  {pool, progress});
  EXPECT_EQ(result.cloud_to_surface.samples, 0U);
  EXPECT_EQ(result.surface_to_cloud.samples, 0U);
  EXPECT_FALSE(result.completeness.has_value());
  EXPECT_TRUE(result.node_errors.node.empty());
}

TEST(CrossCheck, CanBeCancelled) {
  const Scene scene(2000, 5);
  ThreadPool pool(1);
  Progress progress;
  progress.begin("check");
  progress.cancel();
  EXPECT_THROW((void)cross_check(cloud_of(scene.in_scan, scene.origin), scene.scan_to_grid, scene.projection(), {}, {},
                                 {pool, progress}),
               Cancelled);
}

}  // namespace
}  // namespace sparsha::pipeline
