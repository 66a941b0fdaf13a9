// A mesh is judged by its triangles: their tree against brute force, and the cross-check of surfaces whose distance
// from a mesh is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

#include "pipeline/check/check.h"
#include "pipeline/check/triangle_tree.h"
#include "tests/support/checked_cloud.h"

namespace sparsha::pipeline {
namespace {

using testing::cloud_of;
using testing::grid_of;
using testing::lattice_of;
using testing::projection_of;
using Against = CheckResult::Against;
using Faces = std::vector<std::array<std::uint32_t, 3>>;

constexpr double kFloat = std::numeric_limits<float>::epsilon();

struct Soup {
  std::vector<Eigen::Vector3d> corners;
  Faces faces;

  void add(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const auto first = static_cast<std::uint32_t>(corners.size());
    corners.insert(corners.end(), {a, b, c});
    faces.push_back({first, first + 1, first + 2});
  }
  [[nodiscard]] std::vector<float> xyz() const {
    std::vector<float> values;
    for (const Eigen::Vector3d& p : corners)
      for (const double v : p) values.push_back(static_cast<float>(v));
    return values;
  }
};

/// Triangles from a tenth of a millimetre to ten metres, slivers, points and segments among them.
Soup soup_of_all_sizes(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto direction = [&] { return Eigen::Vector3d(unit(random), unit(random), unit(random)); };
  Soup soup;
  for (int k = 0; k < count; ++k) {
    const double size = std::pow(10.0, 2.5 * unit(random) - 1.5);
    const Eigen::Vector3d a = direction();
    const Eigen::Vector3d b = k % 50 == 7 ? a : Eigen::Vector3d(a + size * direction());
    const Eigen::Vector3d c =
        k % 20 == 3 ? Eigen::Vector3d(0.3 * a + 0.7 * b) : Eigen::Vector3d(a + size * direction());
    const auto round = [](const Eigen::Vector3d& p) { return Eigen::Vector3d(p.cast<float>().cast<double>()); };
    soup.add(round(a), round(b), round(c));
  }
  return soup;
}

/// Nearest point of a triangle as the convex combination of least distance: inside by the normal equations, else on an
/// edge by ternary search.
double oracle_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                       const Eigen::Vector3d& c) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) {
    double low = 0.0;
    double high = 1.0;
    const auto at = [&, from = from, to = to](double t) { return (from + t * (to - from) - p).norm(); };
    for (int step = 0; step < 100; ++step) {
      const double one = low + (high - low) / 3;
      const double two = high - (high - low) / 3;
      at(one) < at(two) ? high = two : low = one;
    }
    best = std::min({best, at(low), at(0.0), at(1.0)});
  }
  Eigen::Matrix<double, 3, 2> edges;
  edges << b - a, c - a;
  const Eigen::Vector2d w = edges.colPivHouseholderQr().solve(p - a);
  if (w.minCoeff() >= 0.0 && w.sum() <= 1.0) best = std::min(best, (a + edges * w - p).norm());
  return best;
}

TEST(TriangleTree, FindsTheNearestOfTrianglesOfAllSizesAsBruteForceDoes) {
  const Soup soup = soup_of_all_sizes(700, 3);
  ThreadPool pool(2);
  const TriangleTree tree(soup.xyz(), soup.faces, pool);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1.5, 1.5);
  for (int k = 0; k < 400; ++k) {
    const Eigen::Vector3d p(unit(random), unit(random), unit(random) * (k % 4 == 0 ? 20.0 : 1.0));
    double best = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : soup.faces)
      best = std::min(best, oracle_distance(p, soup.corners[a], soup.corners[b], soup.corners[c]));
    ASSERT_NEAR(std::abs(tree.signed_distance(p.x(), p.y(), p.z())), best, 1e-7 * (1.0 + best)) << k;
  }
}

TEST(TriangleTree, FindsTheHighestTriangleOverAPlace) {
  const Soup soup = soup_of_all_sizes(500, 5);
  ThreadPool pool(2);
  const TriangleTree tree(soup.xyz(), soup.faces, pool);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(-2, 2);
  int found = 0;
  for (int k = 0; k < 1000; ++k) {
    const double x = unit(random);
    const double y = unit(random);
    double best = -std::numeric_limits<double>::infinity();
    for (const auto& [i, j, l] : soup.faces) {
      const Eigen::Vector3d &a = soup.corners[i], &b = soup.corners[j], &c = soup.corners[l];
      Eigen::Matrix2d edges;
      edges << (b - a).head<2>(), (c - a).head<2>();
      if (std::abs(edges.determinant()) < 1e-12) continue;
      const Eigen::Vector2d w = edges.inverse() * (Eigen::Vector2d(x, y) - a.head<2>());
      if (w.minCoeff() >= 0.0 && w.sum() <= 1.0)
        best = std::max(best, a.z() + w.x() * (b - a).z() + w.y() * (c - a).z());
    }
    const std::optional<double> highest = tree.highest(x, y);
    ASSERT_EQ(highest.has_value(), std::isfinite(best)) << k;
    if (!highest) continue;
    ++found;
    ASSERT_NEAR(*highest, best, 1e-9 * (1.0 + std::abs(best)));
  }
  EXPECT_GT(found, 300);
}

TEST(TriangleTree, OfNoTriangleIsInfinitelyFarAndOneOfManyThreadsIsThatOfOne) {
  ThreadPool one(1);
  ThreadPool three(3);
  EXPECT_TRUE(std::isinf(TriangleTree({}, {}, one).signed_distance(0, 0, 0)));
  EXPECT_FALSE(TriangleTree({}, {}, one).highest(0, 0));
  const Soup soup = soup_of_all_sizes(20000, 8);
  const TriangleTree a(soup.xyz(), soup.faces, one);
  const TriangleTree b(soup.xyz(), soup.faces, three);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 500; ++k) {
    const Eigen::Vector3d p(unit(random), unit(random), unit(random));
    EXPECT_EQ(a.signed_distance(p.x(), p.y(), p.z()), b.signed_distance(p.x(), p.y(), p.z()));
    EXPECT_EQ(a.highest(p.x(), p.y()), b.highest(p.x(), p.y()));
  }
}

CheckResult run(const Cloud& cloud, const Projection& projection, std::int64_t samples = 0, unsigned threads = 2) {
  ThreadPool pool(threads);
  Progress progress;
  progress.begin("check");
  return cross_check(cloud, Eigen::Matrix4d::Identity(), projection, {}, {samples}, {pool, progress});
}

/// z = slope_x x + slope_y y over the unit square, cut into triangles of very different sizes: a fine left border, two
/// triangles for all the rest.
Cloud tilted_plane(double slope_x, double slope_y) {
  const auto at = [&](double x, double y) { return Eigen::Vector3d(x, y, slope_x * x + slope_y * y); };
  Soup soup;
  constexpr int kRows = 200;
  constexpr double kBorder = 0.01;
  for (int j = 0; j < kRows; ++j) {
    const double y0 = j / static_cast<double>(kRows);
    const double y1 = (j + 1) / static_cast<double>(kRows);
    soup.add(at(0, y0), at(kBorder, y0), at(0, y1));
    soup.add(at(kBorder, y0), at(kBorder, y1), at(0, y1));
  }
  soup.add(at(kBorder, 0), at(1, 0), at(kBorder, 1));
  soup.add(at(1, 0), at(1, 1), at(kBorder, 1));
  Cloud cloud = cloud_of(soup.corners);
  cloud.faces = soup.faces;
  return cloud;
}

Projection projection_over(scene::DepthGrid grid, const Cloud& cloud) {
  Projection projection = projection_of(std::move(grid), cloud.size());
  projection.only_mesh = true;
  projection.gap_m = 0.05;
  return projection;
}

TEST(CrossCheck, AnExactMeshIsCompleteAndNothingIsFarFromIt) {
  const Cloud cloud = tilted_plane(0.3, -0.2);
  const scene::DepthGrid grid =
      grid_of(lattice_of(101, 101, 0.01), [](double x, double y) { return 0.3 * x - 0.2 * y; });
  const CheckResult result = run(cloud, projection_over(grid, cloud));
  EXPECT_EQ(result.against, Against::mesh);
  EXPECT_GT(result.cloud_to_surface.samples, 9900U) << "a place in nearly every node's square, not the 1206 corners";
  EXPECT_LT(result.cloud_to_surface.max_m, 2 * kFloat);
  EXPECT_EQ(result.surface_to_cloud.samples, 101U * 101U);
  EXPECT_LT(result.surface_to_cloud.max_m, 2 * kFloat);
  EXPECT_DOUBLE_EQ(*result.completeness, 1.0);
  EXPECT_GT(result.second_method_samples, 1000U);
}

TEST(CrossCheck, ASurfaceShiftedOffItsMeshIsThatFarFromItBothWays) {
  const double off = 0.002;
  const Cloud cloud = tilted_plane(0.0, 0.0);
  const scene::DepthGrid grid = grid_of(lattice_of(101, 101, 0.01), [&](double, double) { return off; });
  const CheckResult result = run(cloud, projection_over(grid, cloud), 3000);
  EXPECT_EQ(result.cloud_to_surface.samples, 3000U);
  EXPECT_NEAR(result.cloud_to_surface.median_m, off, kFloat);
  EXPECT_NEAR(result.cloud_to_surface.signed_mean_m, -off, kFloat) << "the mesh lies behind";
  EXPECT_NEAR(result.surface_to_cloud.max_m, off, kFloat);
  EXPECT_NEAR(result.surface_to_cloud.signed_mean_m, -off, kFloat);
  EXPECT_GE(result.cloud_to_surface.mean_ci95_m, 0.0);
}

TEST(CrossCheck, WhatTheViewDoesNotShowOfAMeshIsNotCounted) {
  // A box: its top at 0.5 is seen, its walls edge-on, its bottom not at all.
  Soup soup;
  const auto quad = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                        const Eigen::Vector3d& d) {
    soup.add(a, b, c);
    soup.add(a, c, d);
  };
  for (const double z : {0.0, 0.5}) quad({0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z});
  for (const double x : {0.0, 1.0}) quad({x, 0, 0}, {x, 1, 0}, {x, 1, 0.5}, {x, 0, 0.5});
  for (const double y : {0.0, 1.0}) quad({0, y, 0}, {1, y, 0}, {1, y, 0.5}, {0, y, 0.5});
  Cloud cloud = cloud_of(soup.corners);
  cloud.faces = soup.faces;
  const scene::DepthGrid grid = grid_of(lattice_of(51, 51, 0.02), [](double, double) { return 0.5; });
  const CheckResult result = run(cloud, projection_over(grid, cloud));
  EXPECT_LT(result.cloud_to_surface.max_m, kFloat);
  EXPECT_LT(result.surface_to_cloud.max_m, kFloat);
}

TEST(CrossCheck, WhatASurfaceLacksOfItsMeshIsFarAndWhatItInventsIsIncomplete) {
  const Cloud cloud = tilted_plane(0.0, 0.0);
  // Known up to x = 0.5 only.
  scene::DepthGrid half = grid_of(lattice_of(101, 101, 0.01), [](double, double) { return 0.0; });
  for (int j = 0; j < 101; ++j)
    for (int i = 51; i < 101; ++i) {
      half.height_m[half.lattice.index(i, j)] = scene::kUnknownHeight;
      half.state[half.lattice.index(i, j)] = scene::NodeState::unknown;
    }
  const CheckResult lacking = run(cloud, projection_over(half, cloud));
  // Half of the places are 0 to 0.5 away, evenly.
  EXPECT_NEAR(lacking.cloud_to_surface.mean_m, 0.125, 0.005);
  EXPECT_DOUBLE_EQ(*lacking.completeness, 1.0);
  // 201 columns, of which the mesh reaches 101 and the tolerance, a spacing, one more.
  const scene::DepthGrid twice = grid_of(lattice_of(201, 101, 0.01), [](double, double) { return 0.0; });
  const CheckResult invented = run(cloud, projection_over(twice, cloud));
  EXPECT_LT(invented.cloud_to_surface.max_m, kFloat);
  EXPECT_NEAR(*invented.completeness, 101.5 / 201, 0.6 / 201);
  EXPECT_NEAR(invented.surface_to_cloud.max_m, 1.0, 1e-6);
}

TEST(CrossCheck, AMeshAndPointsTogetherAreJudgedEachByWhatItIs) {
  // The mesh's left half lies behind points, which are the surface there.
  Cloud cloud = tilted_plane(0.0, 0.0);
  const std::size_t corners = cloud.size();
  const std::size_t added = 40 * 100;
  cloud.resize_points(corners + added);
  for (std::size_t k = 0; k < added; ++k) {
    float* const p = cloud.xyz1() + 4 * (corners + k);
    p[0] = static_cast<float>(0.005 + 0.01 * static_cast<double>(k % 40));
    p[1] = static_cast<float>(0.005 + 0.01 * static_cast<double>(k / 40));
    p[2] = 0.2F;
  }
  const scene::DepthGrid grid =
      grid_of(lattice_of(101, 101, 0.01), [](double x, double) { return x < 0.405 ? 0.2 : 0.0; });
  Projection projection = projection_over(grid, cloud);
  projection.only_mesh = false;
  const CheckResult result = run(cloud, projection);
  EXPECT_EQ(result.against, Against::mesh_and_points);
  EXPECT_GT(result.cloud_to_surface.samples, added + 5900U);
  EXPECT_LT(result.cloud_to_surface.p99_m, kFloat) << "the mesh behind the points is not shown";
  EXPECT_LT(result.surface_to_cloud.p95_m, 0.008) << "half a diagonal of the points";
  EXPECT_DOUBLE_EQ(*result.completeness, 1.0);
}

TEST(CrossCheck, OfAMeshDependsNotOnThreads) {
  const Cloud cloud = tilted_plane(0.4, 0.1);
  const scene::DepthGrid grid =
      grid_of(lattice_of(301, 301, 1.0 / 300), [](double x, double y) { return 0.4 * x + 0.11 * y; });
  const Projection projection = projection_over(grid, cloud);
  const CheckResult one = run(cloud, projection, 5000, 1);
  const CheckResult three = run(cloud, projection, 5000, 3);
  EXPECT_EQ(std::memcmp(&one.cloud_to_surface, &three.cloud_to_surface, sizeof one.cloud_to_surface), 0);
  EXPECT_EQ(std::memcmp(&one.surface_to_cloud, &three.surface_to_cloud, sizeof one.surface_to_cloud), 0);
  EXPECT_EQ(one.completeness, three.completeness);
}

}  // namespace
}  // namespace sparsha::pipeline
