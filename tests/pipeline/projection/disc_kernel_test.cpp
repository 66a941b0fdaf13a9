// The kernels of tangent discs agree bit for bit, and their planes are those of an eigenvalue solver in double.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/bins.h"
#include "pipeline/projection/simd/kernels.h"

namespace sparsha {
namespace {

constexpr std::size_t kPoints = 6000;
constexpr double kRadius_m = 0.1;
constexpr double kNoise_m = 0.0002;
constexpr double kSide_m = 0.0115;  // 2.5 spacings

/// A ball's points in columns, twenty of them twice.
pipeline::Bins ball() {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  pipeline::OrientedPoints points;
  points.count = kPoints;
  for (auto* axis : {&points.x, &points.y, &points.z}) *axis = pipeline::make_buffer<float>(kPoints);
  for (std::size_t k = 0; k < kPoints; ++k) {
    Eigen::Vector3d p(normal(random), normal(random), normal(random));
    p *= (kRadius_m + kNoise_m * normal(random)) / p.norm();
    const std::size_t from = k < 20 ? k : k + 20 >= kPoints ? k + 20 - kPoints : k;
    points.x[k] = from == k ? static_cast<float>(p.x()) : points.x[from];
    points.y[k] = from == k ? static_cast<float>(p.y()) : points.y[from];
    points.z[k] = from == k ? static_cast<float>(p.z()) : points.z[from];
  }
  const int columns = static_cast<int>(2.0 * kRadius_m / kSide_m) + 3;
  const pipeline::BinLattice lattice{columns, columns, kSide_m, -kRadius_m, -kRadius_m};
  ThreadPool pool(1);
  return sort_into_bins(points, {}, lattice, pipeline::BinWindow::all(lattice), pool);
}

struct Discs {
  std::vector<float> values[7];
  std::vector<float> heights;
  std::vector<std::uint8_t> verdicts;
  std::vector<std::size_t> layer_counts;
  std::vector<pipeline::DiscLayer> layers;  // of each node, the highest first
};

Discs discs_of(const pipeline::Bins& bins, const pipeline::ProjectionKernels& kernels) {
  Discs discs;
  const std::size_t room = bins.points + pipeline::DiscKernel::kReadAhead;
  for (auto& values : discs.values) values.assign(room, 0.0F);
  const auto nx = static_cast<std::size_t>(bins.lattice.bins_x());
  const auto ny = static_cast<std::size_t>(bins.lattice.bins_y());
  const std::vector<float> needed(nx * ny, -std::numeric_limits<float>::infinity());
  std::vector<float> scratch(pipeline::DiscKernel::kScratch);
  pipeline::DiscKernel kernel;
  kernel.start = bins.start.get();
  kernel.x = bins.x.get();
  kernel.y = bins.y.get();
  kernel.z = bins.z.get();
  kernel.bins_x = nx;
  kernel.last_row = ny;
  kernel.side_m = static_cast<float>(kSide_m);
  kernel.most_spacing_m = static_cast<float>(1.2 * kSide_m);
  kernel.needed_m = needed.data();
  kernel.scratch = scratch.data();
  kernel.foot_x = discs.values[0].data();
  kernel.foot_y = discs.values[1].data();
  kernel.foot_z = discs.values[2].data();
  kernel.slope_x = discs.values[3].data();
  kernel.slope_y = discs.values[4].data();
  kernel.above = discs.values[5].data();
  kernel.radius2 = discs.values[6].data();
  for (std::size_t row = 0; row < ny; ++row) kernels.fit_discs(kernel, row);

  // All of them as records, those without a disc too: their radius covers nothing.
  std::vector<float> records(pipeline::kDiscRecord * room, 0.0F);
  std::vector<std::uint32_t> start;
  for (std::size_t row = 0; row < ny; ++row) {
    for (std::size_t column = 0; column <= nx; ++column) start.push_back(bins.start[row * nx + column]);
  }
  for (std::size_t p = 0; p < bins.points; ++p) {
    for (std::size_t v = 0; v < 7; ++v) records[pipeline::kDiscRecord * p + v] = discs.values[v][p];
    records[pipeline::kDiscRecord * p + 7] = 1.0F;
  }
  const std::vector<std::uint8_t> rings(nx * ny, 2);
  std::vector<float> node_scratch(pipeline::DiscNodeKernel::kScratch);
  constexpr std::size_t kNodes = 90;
  const pipeline::BinLocator ruler(bins.lattice);
  pipeline::DiscNodeKernel nodes;
  nodes.start = start.data();
  nodes.x = discs.values[0].data();
  nodes.y = discs.values[1].data();
  nodes.slope_x = discs.values[3].data();
  nodes.slope_y = discs.values[4].data();
  nodes.radius2 = discs.values[6].data();
  nodes.records = records.data();
  nodes.rings = rings.data();
  nodes.bins_x = nx;
  nodes.last_row = ny;
  nodes.columns_x0_m = ruler.x_shift_m;
  nodes.columns_y0_m = ruler.y_shift_m;
  nodes.per_side = ruler.per_m;
  nodes.x0_m = nodes.y0_m = -1.05 * kRadius_m;
  nodes.spacing_m = 2.1 * kRadius_m / kNodes;
  nodes.nx = kNodes;
  nodes.link_noise_m = static_cast<float>(4.0 * kNoise_m);
  nodes.scratch = node_scratch.data();
  discs.heights.assign(kNodes * kNodes, 0.0F);
  discs.verdicts.assign(kNodes * kNodes, 0);
  for (std::size_t j = 0; j < kNodes; ++j) {
    kernels.fit_disc_nodes(nodes, j, discs.heights.data() + j * kNodes, discs.verdicts.data() + j * kNodes);
    for (std::size_t i = 0; i < kNodes; ++i) {
      std::vector<pipeline::DiscLayer> layers(pipeline::DiscNodeKernel::kMostLayers);
      layers.resize(kernels.find_disc_layers(nodes, i, j, layers.data()));
      discs.layer_counts.push_back(layers.size());
      discs.layers.insert(discs.layers.end(), layers.begin(), layers.end());
    }
  }
  return discs;
}

TEST(DiscKernels, AgreeBitForBitWithEveryInstructionSet) {
  std::vector<const pipeline::ProjectionKernels*> others;
  if (__builtin_cpu_supports("avx2")) others.push_back(&pipeline::avx2_kernels());
  if (pipeline::has_avx512()) others.push_back(&pipeline::avx512_kernels());
  if (others.empty()) GTEST_SKIP() << "this machine has the baseline only";
  const pipeline::Bins bins = ball();
  const Discs a = discs_of(bins, pipeline::baseline_kernels());
  EXPECT_GT(std::count(a.verdicts.begin(), a.verdicts.end(), pipeline::DiscNodeKernel::kMeasured), 5000);
  for (const auto* kernels : others) {
    const Discs b = discs_of(bins, *kernels);
    EXPECT_EQ(a.verdicts, b.verdicts);
    EXPECT_EQ(0, std::memcmp(a.heights.data(), b.heights.data(), a.heights.size() * sizeof(float)));
    EXPECT_EQ(a.layer_counts, b.layer_counts);
    ASSERT_EQ(a.layers.size(), b.layers.size());
    EXPECT_EQ(0, std::memcmp(a.layers.data(), b.layers.data(), a.layers.size() * sizeof(pipeline::DiscLayer)));
    for (std::size_t v = 0; v < 7; ++v) {
      EXPECT_EQ(0, std::memcmp(a.values[v].data(), b.values[v].data(), bins.points * sizeof(float))) << v;
    }
  }
}

TEST(DiscKernels, LayersAreTheFrontAndTheBackOfABallAndTheFirstIsTheFront) {
  const Discs found = discs_of(ball(), pipeline::fastest_kernels());
  std::size_t first = 0, both = 0;
  for (std::size_t node = 0; node < found.layer_counts.size(); ++node) {
    const std::size_t count = found.layer_counts[node];
    const pipeline::DiscLayer* layers = found.layers.data() + first;
    first += count;
    for (std::size_t k = 1; k < count; ++k) EXPECT_LT(layers[k].height, layers[k - 1].height);
    if (found.verdicts[node] == pipeline::DiscNodeKernel::kMeasured) {
      ASSERT_GE(count, 1U);
      EXPECT_NEAR(layers[0].height, found.heights[node], 1e-6 * kRadius_m);  // sums in another order
    }
    const auto i = static_cast<double>(node % 90U), j = static_cast<double>(node / 90U);
    const Eigen::Vector2d at(-1.05 * kRadius_m + i * 2.1 * kRadius_m / 90.0,
                             -1.05 * kRadius_m + j * 2.1 * kRadius_m / 90.0);
    if (at.norm() > 0.8 * kRadius_m) continue;
    ASSERT_EQ(count, 2U) << at.transpose();
    ++both;
    const double height = std::sqrt(kRadius_m * kRadius_m - at.squaredNorm());
    for (const std::size_t k : {0U, 1U}) {
      const double sign = k == 0 ? 1.0 : -1.0;
      EXPECT_NEAR(static_cast<double>(layers[k].height), sign * height, 6.0 * kNoise_m);
      EXPECT_NEAR(static_cast<double>(layers[k].slope_x), -sign * at.x() / height, 0.3);
      EXPECT_NEAR(static_cast<double>(layers[k].slope_y), -sign * at.y() / height, 0.3);
    }
  }
  EXPECT_GT(both, 2000U);
}

TEST(DiscKernels, PlanesAreThoseOfTheNeighboursWithinTheirRadius) {
  const pipeline::Bins bins = ball();
  const Discs found = discs_of(bins, pipeline::fastest_kernels());
  const auto place = [&](std::size_t p) {
    return Eigen::Vector3d(static_cast<double>(bins.x[p]), static_cast<double>(bins.y[p]),
                           static_cast<double>(bins.z[p]));
  };
  std::size_t judged = 0;
  for (std::size_t p = 0; p < bins.points; p += 7) {
    if (!(found.values[6][p] > 0.0F)) continue;
    // radius2 = (2.5 spacing)^2 and spacing^2 = pi r^2 / count: the count tells r.
    bool matched = false;
    const double spacing2 = static_cast<double>(found.values[6][p]) / 6.25;
    for (int count = 8; count <= 40 && !matched; ++count) {
      const double r2 = spacing2 * count / 3.14159265358979;
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
      int within = 0;
      for (std::size_t q = 0; q < bins.points; ++q) {
        const Eigen::Vector3d d = place(q) - place(p);
        if (d.squaredNorm() > r2 * (1.0 + 1e-6)) continue;
        mean += d;
        second += d * d.transpose();
        ++within;
      }
      if (within != count) continue;
      mean /= count;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(second / count - mean * mean.transpose());
      const Eigen::Vector3d normal = axes.eigenvectors().col(0);
      const Eigen::Vector2d slope(-normal.x() / normal.z(), -normal.y() / normal.z());
      const Eigen::Vector2d kernel(static_cast<double>(found.values[3][p]), static_cast<double>(found.values[4][p]));
      // Floats tell normals to about 1e-4; slopes stretch that by 1 + slope^2.
      matched = (slope - kernel).norm() < 1e-3 * (1.0 + slope.squaredNorm());
    }
    EXPECT_TRUE(matched) << p;
    ++judged;
  }
  EXPECT_GT(judged, 300U);
}

}  // namespace
}  // namespace sparsha
