// What a fitter keeps from node to node saves work and decides nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "pipeline/projection/bins.h"
#include "pipeline/projection/node_fitter.h"

namespace sparsha::pipeline {
namespace {

constexpr double kSpacing_m = 0.001;

/// A bent surface with a step and a hole, so many points a node, and its bins.
Bins bins_of(int nx, int ny, double per_node, unsigned seed, ThreadPool& pool) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> x(0.0F, static_cast<float>((nx - 1) * kSpacing_m));
  std::uniform_real_distribution<float> y(0.0F, static_cast<float>((ny - 1) * kSpacing_m));
  std::normal_distribution<float> noise(0.0F, 5e-5F);
  const auto count = static_cast<std::size_t>(per_node * nx * ny);
  OrientedPoints points;
  for (Buffer<float>* axis : {&points.x, &points.y, &points.z}) *axis = make_buffer<float>(count);
  const auto middle_x = static_cast<float>(nx / 2 * kSpacing_m), middle_y = static_cast<float>(ny / 2 * kSpacing_m);
  while (points.count < count) {
    const float px = x(random), py = y(random);
    if (std::hypot(px - 0.4F * middle_x, py - middle_y) < 0.15F * middle_x) continue;
    points.x[points.count] = px;
    points.y[points.count] = py;
    points.z[points.count] = 20.0F * px * py + (px > middle_x ? 0.01F : 0.0F) + noise(random);
    ++points.count;
  }
  const BinLattice lattice{nx, ny, kSpacing_m, 0.0, 0.0};
  return sort_into_bins(points, {}, lattice, BinWindow::all(lattice), pool);
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

TEST(NodeFitter, DecidesANodeAlikeWhateverItHasDecidedBefore) {
  ThreadPool pool(1);
  const NodeFitParameters rule{5e-5, 4};
  for (const double per_node : {0.1, 0.3, 1.0, 4.0}) {
    const int nx = 61, ny = 47;
    const Bins bins = bins_of(nx, ny, per_node, 5, pool);
    std::vector<int> nodes(static_cast<std::size_t>(nx * ny));
    for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = static_cast<int>(n);
    for (const bool in_order : {true, false}) {
      std::mt19937 random(7);
      if (!in_order) std::shuffle(nodes.begin(), nodes.end(), random);
      NodeFitter kept(bins, rule);
      for (const int n : nodes) {
        const int least = in_order ? 1 : 1 + static_cast<int>(random() % 3);
        NodeFitter fresh(bins, rule);
        const NodeFit a = kept.fit(n % nx, n / nx, least), b = fresh.fit(n % nx, n / nx, least);
        ASSERT_EQ(a.measured, b.measured) << "node " << n << ", " << per_node << " points a node";
        if (!a.measured) continue;
        ASSERT_TRUE(same_bits(a.height_m, b.height_m)) << "node " << n << ", " << per_node << " points a node";
        ASSERT_TRUE(same_bits(a.slope_x, b.slope_x) && same_bits(a.slope_y, b.slope_y));
      }
    }
  }
}

TEST(NodeFitter, CountsFewWindowsANodeHoweverFewPointsThereAre) {
  ThreadPool pool(1);
  const NodeFitParameters rule{5e-5, 4};
  const int nx = 200, ny = 200;
  for (const double per_node : {0.04, 0.16, 0.64}) {
    const Bins bins = bins_of(nx, ny, per_node, 11, pool);
    NodeFitter fitter(bins, rule);
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) (void)fitter.fit(i, j);
    // Its own and one that is smaller, seldom more; and once about each node the spacing for each of two widths.
    constexpr double kMost = 5.0;
    EXPECT_LE(static_cast<double>(fitter.windows_counted()) / (nx * ny), kMost) << per_node << " points a node";
  }
}

}  // namespace
}  // namespace sparsha::pipeline
