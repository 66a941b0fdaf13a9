// The envelope against a double-precision definition, against OpenCV, and the exponential against the C library's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pipeline/layers/bilateral_kernel.h"
#include "pipeline/layers/layers.h"
#include "tests/support/grids.h"

namespace sparsha::pipeline {
namespace {

using testing::add_noise;
using testing::forget;
using testing::grid_of;
using testing::lattice_of;

constexpr double kFloat = 6e-8;  // relative rounding of a float

scene::DepthGrid relief(int nx, int ny, double spacing_m) {
  scene::DepthGrid grid = grid_of(lattice_of(nx, ny, spacing_m), [](double x, double y) {
    return 0.02 * std::sin(30 * x) * std::cos(25 * y) + 0.0004 * std::sin(900 * x + 700 * y) + (x > 0.05 ? 0.01 : 0.0);
  });
  add_noise(grid, 1e-4, 11);
  return grid;
}

double by_definition(const scene::DepthGrid& grid, const scene::TextureConfig& config, int i, int j) {
  const double h = grid.lattice.spacing_m, centre = grid.height_m[grid.lattice.index(i, j)];
  double sum = 0, weights = 0;
  const int reach = static_cast<int>(3 * config.sigma_space_m / h);
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const int x = i + dx, y = j + dy;
      const double squared = (dx * dx + dy * dy) * h * h;
      if (x < 0 || y < 0 || x >= grid.lattice.nx || y >= grid.lattice.ny ||
          squared > std::pow(3 * config.sigma_space_m, 2) * (1 + 1e-12))
        continue;
      const double z = grid.height_m[grid.lattice.index(x, y)];
      if (std::isnan(z)) continue;
      const double weight = std::exp(-squared / (2 * config.sigma_space_m * config.sigma_space_m) -
                                     (z - centre) * (z - centre) / (2 * config.sigma_range_m * config.sigma_range_m));
      sum += weight * (z - centre);
      weights += weight;
    }
  return centre + sum / weights;
}

TEST(ExponentialKernel, StaysWithin1e7OfTheTruth) {
  double worst = 0;
  for (int k = 0; k <= 4000000; ++k) {
    const float t = static_cast<float>(k) * 1.6e-5F;
    const double truth = std::exp(-static_cast<double>(t));
    worst = std::max(worst, std::abs(kernel::exp_minus(t) - truth) / truth);
  }
  EXPECT_LT(worst, 1e-7);
  EXPECT_EQ(kernel::exp_minus(0.0F), 1.0F);
}

TEST(Bilateral, FollowsItsDefinitionWithUnknownNodesAndBorders) {
  scene::DepthGrid grid = relief(90, 70, 0.00125);
  std::mt19937 random(5);
  for (int k = 0; k < 900; ++k) forget(grid, static_cast<int>(random() % 90), static_cast<int>(random() % 70));
  ThreadPool pool(2);
  const scene::TextureConfig config;
  const std::vector<float> envelope = bilateral_envelope(grid, config, pool);
  for (int j = 0; j < 70; ++j)
    for (int i = 0; i < 90; ++i) {
      const std::size_t n = grid.lattice.index(i, j);
      if (grid.state[n] == scene::NodeState::unknown) {
        EXPECT_TRUE(std::isnan(envelope[n]));
        continue;
      }
      // One rounding of the height itself; the correction, some 3 sigma_range, carries relative errors of a few
      // roundings.
      EXPECT_NEAR(envelope[n], by_definition(grid, config, i, j),
                  kFloat * std::abs(grid.height_m[n]) + 40 * kFloat * config.sigma_range_m);
    }
}

TEST(Bilateral, AgreesWithOpenCvWhereNothingIsUnknown) {
  const scene::DepthGrid grid = relief(160, 120, 0.001);
  ThreadPool pool(1);
  scene::TextureConfig config;  // 2 nodes: both windows are the disc of 6 nodes
  const std::vector<float> direct = bilateral_envelope(grid, config, pool);
  cv::Mat source(120, 160, CV_32F, const_cast<float*>(grid.height_m.data())), peer;
  cv::bilateralFilter(source, peer, 13, config.sigma_range_m, 2.0);
  config.method = scene::TextureConfig::Method::opencv;
  const std::vector<float> selectable = bilateral_envelope(grid, config, pool);
  // OpenCV interpolates the range weight in a table of 4096 steps over the image's range r. Linear interpolation of a
  // Gaussian errs by (r / 4096)^2 / (8 sigma^2) at most, relative to its peak, and heights differ by some sigma.
  const auto [low, high] = std::minmax_element(grid.height_m.begin(), grid.height_m.end());
  const double bin = (*high - *low) / 4096.0;
  const double tolerance = 8 * bin * bin / (8 * config.sigma_range_m) + kFloat;
  for (int j = 6; j < 114; ++j)
    for (int i = 6; i < 154; ++i) {
      EXPECT_NEAR(direct[grid.lattice.index(i, j)], peer.at<float>(j, i), tolerance);
      EXPECT_NEAR(selectable[grid.lattice.index(i, j)], peer.at<float>(j, i), tolerance);
    }
}

TEST(Bilateral, StaysCloseToItsDefinitionWhereAWideGaussianIsSampled) {
  // sigma_space is 16 nodes, and one node in 16 is asked, chosen without period. The range weight leaves some 60
  // effective ones on this slope: the mean's noise is an eighth of what varies about a node, which is the noise and as
  // much of form.
  const double noise = 0.00005;
  scene::DepthGrid grid = grid_of(lattice_of(140, 130, 0.000125), [](double x, double y) {
    return 0.3 * x + 0.0002 * std::sin(500 * y) + 0.00003 * std::sin(2 * std::numbers::pi * x / 0.0005);
  });
  add_noise(grid, noise, 13);
  ThreadPool pool(2);
  const scene::TextureConfig config{0.002, 0.0005, scene::TextureConfig::Method::direct};
  const std::vector<float> envelope = bilateral_envelope(grid, config, pool);
  double squares = 0;
  int count = 0;
  for (int j = 2; j < 130; j += 9)
    for (int i = 1; i < 140; i += 9, ++count)
      squares += std::pow(envelope[grid.lattice.index(i, j)] - by_definition(grid, config, i, j), 2);
  EXPECT_LT(std::sqrt(squares / count), 2 * noise / 8);
}

TEST(Bilateral, IsNotMovedByAFarSpike) {
  scene::DepthGrid grid = relief(120, 60, 0.00125);
  ThreadPool pool(1);
  const std::vector<float> before = bilateral_envelope(grid, {}, pool);
  grid.height_m[grid.lattice.index(5, 5)] = 40.0F;
  const std::vector<float> after = bilateral_envelope(grid, {}, pool);
  for (int j = 0; j < 60; ++j)
    for (int i = 20; i < 120; ++i) EXPECT_EQ(before[grid.lattice.index(i, j)], after[grid.lattice.index(i, j)]);
}

TEST(Bilateral, KeepsStepsAndTakesSmallTextureAway) {
  const double amplitude = 0.00005, step = 0.01;
  const scene::DepthGrid grid = grid_of(lattice_of(200, 60, 0.0005), [&](double x, double y) {
    return amplitude * std::sin(2 * std::numbers::pi * (x + y) / 0.002) + (x > 0.05 ? step : 0.0);
  });
  ThreadPool pool(1);
  const std::vector<float> envelope = bilateral_envelope(grid, {}, pool);
  for (int j = 15; j < 45; ++j)
    for (int i = 15; i < 185; ++i)
      EXPECT_NEAR(envelope[grid.lattice.index(i, j)], i * 0.0005 > 0.05 ? step : 0.0, amplitude / 3) << i << ' ' << j;
}

TEST(Bilateral, IsTheHeightItselfWhenTheWindowHoldsNoOtherNode) {
  const scene::DepthGrid grid = relief(30, 30, 0.01);
  ThreadPool pool(1);
  EXPECT_EQ(bilateral_envelope(grid, {}, pool), grid.height_m);
}

TEST(BilateralKernel, GivesTheSameBitsInPortableAndVectorCode) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
  std::mt19937 random(9);
  std::normal_distribution<float> normal(0.0F, 1e-3F);
  constexpr std::size_t kCount = 1003, kMargin = 40;
  std::vector<float> row(kCount + 2 * kMargin);
  for (float& z : row)
    z = random() % 9 == 0 ? scene::kUnknownHeight : (random() % 50 == 0 ? 30.0F : 0.0F) + normal(random);
  for (float& z : row)
    if (std::isnan(z)) z = -1e9F;
  const std::vector<float> ones(kCount, 1.0F);
  for (const std::size_t offset : {std::size_t{1}, std::size_t{7}, 2 * kMargin}) {
    std::vector<std::vector<float>> portable(4, ones), vector(4, ones);
    kernel::bilateral_pairs_portable(row.data(), row.data() + offset, kCount, 2e6F, 0.125F, portable[0].data(),
                                     portable[1].data(), portable[2].data(), portable[3].data());
    kernel::bilateral_pairs_avx2(row.data(), row.data() + offset, kCount, 2e6F, 0.125F, vector[0].data(),
                                 vector[1].data(), vector[2].data(), vector[3].data());
    EXPECT_EQ(portable, vector) << offset;
    EXPECT_GT(std::count(portable[0].begin(), portable[0].end(), 1.0F), 100) << "far heights weigh nothing";
    EXPECT_LT(std::count(portable[0].begin(), portable[0].end(), 1.0F), 500) << "near ones do";
  }
}

// A lattice of several pieces: a part of it that has another place among them gives the same bits.
TEST(Bilateral, DependsOnANodesNeighbourhoodAlone) {
  scene::DepthGrid grid = relief(1300, 300, 0.001);
  std::mt19937 random(6);
  for (int k = 0; k < 9000; ++k) forget(grid, static_cast<int>(random() % 1300), static_cast<int>(random() % 300));
  ThreadPool one(1), two(2);
  const scene::TextureConfig config{0.003, 0.0005, scene::TextureConfig::Method::direct};
  const std::vector<float> whole = bilateral_envelope(grid, config, two);
  const int i0 = 77, j0 = 61, nx = 1100, ny = 203, reach = 9;
  scene::DepthGrid part(lattice_of(nx, ny, 0.001));
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      part.height_m[part.lattice.index(i, j)] = grid.height_m[grid.lattice.index(i0 + i, j0 + j)];
  const std::vector<float> envelope = bilateral_envelope(part, config, one);
  for (int j = reach; j < ny - reach; ++j)
    for (int i = reach; i < nx - reach; ++i) {
      const float a = envelope[part.lattice.index(i, j)], b = whole[grid.lattice.index(i0 + i, j0 + j)];
      ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << i << ' ' << j;
    }
}

}  // namespace
}  // namespace sparsha::pipeline
