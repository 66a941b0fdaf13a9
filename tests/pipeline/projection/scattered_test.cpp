// Points scattered evenly in an object's box belong to no surface: they make none, nor do they make its surface sparse.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

#include "pipeline/projection/count_scattered.h"
#include "tests/pipeline/projection/front_only.h"

namespace sparsha::test {
namespace {

/// With a share more of points, scattered evenly in the scan's box.
ObjectScan in_a_cloud(const ObjectScan& scan, double share) {
  ObjectScan both = scan;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  for (const auto& p : scan.points) {
    low = low.cwiseMin(Eigen::Vector3d(p[0], p[1], p[2]));
    high = high.cwiseMax(Eigen::Vector3d(p[0], p[1], p[2]));
  }
  std::mt19937_64 random(71);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto more = static_cast<std::size_t>(share * static_cast<double>(scan.points.size()));
  for (std::size_t n = 0; n < more; ++n) {
    const Eigen::Vector3d at(uniform(random), uniform(random), uniform(random));
    const Eigen::Vector3d p = low + at.cwiseProduct(high - low);
    both.points.push_back({p.x(), p.y(), p.z()});
  }
  return both;
}

TEST(ScatteredPoints, GrowNoSurfaceBesideAnObject) {
  for (const std::size_t k : {0U, 4U}) {
    const NamedObject& named = objects()[k];
    const ObjectScan scan = scan_object(*named.object, cloud_of(60'000));
    const pipeline::Projection found = project_scan(in_a_cloud(scan, 0.1));
    ASSERT_TRUE(found.closed) << named.name << ": discs decide";
    const Judgement f = judge_object(found.grid, *named.object, scan);
    EXPECT_LE(f.beyond, 0.02) << named.name;
    EXPECT_LE(f.wrong_smooth, 0.002) << named.name;
  }
}

// A scanner's false ranges lie along its rays: in a space much larger than the object, and the nearer the denser. The
// station of each point is the one of six all round that looks at it most directly, about.
ObjectScan with_false_ranges(const ObjectScan& scan, double share, double sizes_away) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  for (const auto& p : scan.points) {
    low = low.cwiseMin(Eigen::Vector3d(p[0], p[1], p[2]));
    high = high.cwiseMax(Eigen::Vector3d(p[0], p[1], p[2]));
  }
  const Eigen::Vector3d middle = 0.5 * (low + high);
  const double away = sizes_away * (high - low).maxCoeff();
  ObjectScan both = scan;
  std::mt19937_64 random(71);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::size_t n = 0; n < scan.points.size(); ++n) {
    if (uniform(random) > share) continue;
    const auto& at = scan.points[n];
    const Eigen::Vector3d p(at[0], at[1], at[2]);
    const double angle = std::round(std::atan2(p.x() - middle.x(), p.z() - middle.z()) * 3.0 / std::numbers::pi) *
                         std::numbers::pi / 3.0;
    const Eigen::Vector3d station = middle + away * Eigen::Vector3d(std::sin(angle), 0.1, std::cos(angle));
    const Eigen::Vector3d q = station + (0.3 + 0.9 * uniform(random)) * (p - station);
    both.points.push_back({q.x(), q.y(), q.z()});
  }
  return both;
}

TEST(ScatteredPoints, GrowNoSurfaceAlongTheRaysOfStations) {
  constexpr double kShare = 0.1;
  for (const std::size_t k : {0U, 4U}) {
    const NamedObject& named = objects()[k];
    const ObjectScan scan = scan_object(*named.object, cloud_of(60'000));
    const pipeline::Projection found = project_scan(with_false_ranges(scan, kShare, 2.0));
    ASSERT_TRUE(found.closed) << named.name << ": discs decide";
    const Judgement f = judge_object(found.grid, *named.object, scan);
    EXPECT_LE(f.beyond, kShare / 5.0) << named.name;
    EXPECT_LE(f.wrong_smooth, 0.002) << named.name;
    EXPECT_GE(f.covered, 0.9) << named.name;
  }
}

// Where stations stand near and far, wide discs find what is sparse; false ranges must not fill them.
TEST(ScatteredPoints, GrowNoSurfaceAlongTheRaysOfStationsNearAndFar) {
  constexpr double kShare = 0.05;
  for (const std::size_t k : {0U, 1U, 4U}) {
    const NamedObject& named = objects()[k];
    ScanOptions options = cloud_of(60'000);
    options.density_ratio = 25.0;
    const ObjectScan scan = scan_object(*named.object, options);
    const pipeline::Projection found = project_scan(with_false_ranges(scan, kShare, 1.0));
    ASSERT_TRUE(found.closed) << named.name;
    ASSERT_TRUE(found.discs) << named.name;
    const Judgement f = judge_object(found.grid, *named.object, scan);
    EXPECT_LE(f.beyond, kShare / 5.0) << named.name;
    EXPECT_LE(f.wrong_smooth, 0.002) << named.name;
    EXPECT_GE(f.covered, 0.9) << named.name;
  }
}

// The origin of oriented points is a median of points that a hash chooses: it moves by spacings where coordinates move
// by nanometres, and which points count as scattered must not follow it.
TEST(ScatteredPoints, AreTheSameWhenTheObjectIsMovedByNanometres) {
  for (const std::size_t k : {0U, 4U}) {
    const NamedObject& named = objects()[k];
    ObjectScan scan = in_a_cloud(scan_object(*named.object, cloud_of(60'000)), 0.1);
    const Points points = scan.points;
    const auto before = static_cast<double>(project_scan(scan).scattered);
    ASSERT_GT(before, 0.0) << named.name;
    for (int n = 1; n <= 6; ++n) {
      for (std::size_t p = 0; p < points.size(); ++p) {
        for (std::size_t axis = 0; axis < 3; ++axis) scan.points[p][axis] = points[p][axis] + 1e-9 * n;
      }
      const auto after = static_cast<double>(project_scan(scan).scattered);
      EXPECT_NEAR(after, before, 1.0) << named.name << ", " << n << " nm: one may lie on the face of a cube";
    }
  }
}

double waves_m(double x, double y) { return 0.01 * std::sin(80.0 * x) * std::cos(60.0 * y); }

constexpr double kRadius = 0.08, kHole = 0.02;

bool on_plate(double x, double y) { return std::hypot(x, y) <= kRadius && std::hypot(x - 0.02, y - 0.02) >= kHole; }

/// A round, wavy plate with a hole, points 1 mm apart, and a share more of scattered ones in its box.
Points plate(double share, double noise_m, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, noise_m);
  Points points;
  const auto count = static_cast<std::size_t>(std::numbers::pi * (kRadius * kRadius - kHole * kHole) / 1e-6);
  while (points.size() < count) {
    const double x = kRadius * uniform(random);
    const double y = kRadius * uniform(random);
    if (on_plate(x, y)) points.push_back({x, y, waves_m(x, y) + normal(random)});
  }
  for (std::size_t n = 0; n < static_cast<std::size_t>(share * static_cast<double>(count)); ++n) {
    points.push_back({kRadius * uniform(random), kRadius * uniform(random), 0.011 * uniform(random)});
  }
  return points;
}

TEST(ScatteredPoints, GrowNoSurfaceBesideAReliefAndAreCounted) {
  scene::GridConfig grid;
  grid.spacing_m = 0.001;
  for (const double share : {0.05, 0.1}) {
    const Points points = plate(share, 0.0002, 5);
    const pipeline::Projection found = project_cloud(make_cloud(points), grid);
    ASSERT_FALSE(found.closed);
    const scene::Lattice& lattice = found.grid.lattice;
    std::size_t measured = 0;
    std::size_t astray = 0;
    for (int j = 0; j < lattice.ny; ++j) {
      for (int i = 0; i < lattice.nx; ++i) {
        const std::size_t k = lattice.index(i, j);
        if (found.grid.state[k] != scene::NodeState::measured) continue;
        ++measured;
        const double z = lattice.origin_m.z() + static_cast<double>(found.grid.height_m[k]);
        // Within a node and a half of the plate, and within three spacings of its height there.
        bool near = false;
        for (const double dx : {-0.0015, 0.0, 0.0015}) {
          for (const double dy : {-0.0015, 0.0, 0.0015}) {
            const double x = lattice.x_m(i) + dx;
            const double y = lattice.y_m(j) + dy;
            near = near || (on_plate(x, y) && std::abs(z - waves_m(x, y)) < 0.003);
          }
        }
        astray += near ? 0 : 1;
      }
    }
    EXPECT_LE(static_cast<double>(astray), share / 5.0 * static_cast<double>(measured)) << share;
    EXPECT_GE(static_cast<double>(measured), 0.94 * static_cast<double>(points.size()) / (1.0 + share)) << share;
    EXPECT_GT(found.scattered, 0U);
    EXPECT_LE(static_cast<double>(found.scattered), share * static_cast<double>(points.size()));
  }
  EXPECT_EQ(project_cloud(make_cloud(plate(0.0, 0.0002, 5)), grid).scattered, 0U);
}

std::uint64_t counted(const Points& points, ThreadPool& pool, double unit = 1.0,
                      const Eigen::Vector3d& from = Eigen::Vector3d::Zero()) {
  std::vector<Eigen::Vector3d> places;
  for (const auto& p : points) places.emplace_back(Eigen::Vector3d(p[0], p[1], p[2]) / unit + from);
  return pipeline::count_scattered(places, unit, pool);
}

TEST(ScatteredPoints, AreCountedInAScanAsItsProjectionCountsThem) {
  ThreadPool one(1), three(3);
  for (const double share : {0.05, 0.1}) {
    const Points points = plate(share, 0.0002, 5);
    const std::uint64_t found = counted(points, one);
    EXPECT_EQ(counted(points, three), found);
    const auto built = static_cast<double>(project_cloud(make_cloud(points), {}).scattered);
    EXPECT_NEAR(static_cast<double>(found), built, 0.1 * built);
    EXPECT_LE(static_cast<double>(found), share * static_cast<double>(points.size()));
    const auto far = static_cast<double>(counted(points, one, 0.001, {4.5e8, 5.4e9, 1.2e5}));
    EXPECT_NEAR(far, built, 0.1 * built) << "millimetres, far from zero";
  }
  EXPECT_EQ(counted(plate(0.0, 0.0002, 5), one), 0U);
  EXPECT_EQ(counted({}, one), 0U);
  EXPECT_EQ(counted(Points(5000, {1.0, 2.0, 3.0}), one), 0U) << "all on one spot";
}

TEST(ScatteredPoints, AreNotTheSparsePartsOfARelief) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Points points;
  while (points.size() < 30'000) {
    const double x = uniform(random);
    const double y = uniform(random);
    // Density 1:100, as many points on each decade's half.
    if (uniform(random) > std::pow(0.01, x)) continue;
    points.push_back({0.3 * x, 0.3 * y, waves_m(0.3 * x, 0.3 * y) + 0.0001 * uniform(random)});
  }
  EXPECT_EQ(project_cloud(make_cloud(points), {}).scattered, 0U);
}

}  // namespace
}  // namespace sparsha::test
