// What the normals of the benchmark are judged by: every disc once, and PCL on the threads that it is given.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bench/pipeline/disc_list.h"
#include "bench/pipeline/pcl_normals.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::bench {
namespace {

std::pair<test::ObjectScan, pipeline::Cloud> torus() {
  test::ScanOptions how;
  how.points = 20'000;
  how.noise_spacings = 0.1;
  for (const test::NamedObject& named : test::analytic_objects())
    if (named.name == "torus") {
      test::ObjectScan scan = test::scan_object(*named.object, how);
      pipeline::Cloud cloud = test::make_cloud(scan.points);
      return {std::move(scan), std::move(cloud)};
    }
  throw std::runtime_error("no torus");
}

using Feet = std::vector<std::pair<float, float>>;

Feet feet_of(const test::ObjectScan& scan, const pipeline::Cloud& cloud, unsigned threads) {
  ThreadPool pool(threads);
  const pipeline::OrientedPoints points = pipeline::orient_points(pipeline::raw_points(cloud), cloud.origin_m,
                                                                  Eigen::Matrix4d::Identity(), cloud.origin_m, pool);
  pipeline::DiscRule rule;
  rule.spacing_m = scan.spacing_m;
  const Eigen::Array2f extent = points.max_m.head<2>() - points.min_m.head<2>();
  const pipeline::BinLattice nodes{static_cast<int>(extent.x() / rule.spacing_m) + 2,
                                   static_cast<int>(extent.y() / rule.spacing_m) + 2, rule.spacing_m,
                                   static_cast<double>(points.min_m.x()), static_cast<double>(points.min_m.y())};
  const pipeline::BinLattice columns = pipeline::disc_columns(nodes, rule);
  const pipeline::TangentDiscs discs =
      pipeline::find_discs(points, {}, columns, pipeline::BinWindow::all(columns), rule, true, pool);
  Feet feet;
  for (const std::size_t d : disc_indices(discs)) feet.emplace_back(discs.x[d], discs.y[d]);
  std::sort(feet.begin(), feet.end());
  return feet;
}

TEST(BenchNormals, EveryDiscIsListedOnceWhateverTheNumberOfThreads) {
  const auto [scan, cloud] = torus();
  const Feet feet = feet_of(scan, cloud, 1);
  EXPECT_GT(feet.size(), 15'000U);
  EXPECT_LE(feet.size(), scan.points.size());
  EXPECT_EQ(std::adjacent_find(feet.begin(), feet.end()), feet.end());
  EXPECT_EQ(feet, feet_of(scan, cloud, 2));
}

#ifdef SPARSHA_HAS_OPENMP
TEST(BenchNormals, PclRunsOnAsManyThreadsAsItIsGiven) {
  const auto threads = [] {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
  };
  const auto [scan, cloud] = torus();
  ASSERT_TRUE(pcl_normals_have_threads());
  const auto before = threads();
  const auto one = by_pcl_normals(cloud, 14, 1);
  EXPECT_EQ(threads(), before);
  const auto three = by_pcl_normals(cloud, 14, 3);
  EXPECT_EQ(threads(), before + 2);  // OpenMP keeps its threads
  EXPECT_EQ(one.size(), scan.points.size());
  EXPECT_EQ(one, three);
}
#endif

}  // namespace
}  // namespace sparsha::bench
