// The same bits with every instruction set that the machine has.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "pipeline/projection/bins.h"
#include "pipeline/projection/local_fit.h"
#include "pipeline/projection/simd/kernels.h"

namespace sparsha::test {
namespace {

/// Those of this machine beside the baseline.
std::vector<const pipeline::ProjectionKernels*> vector_kernels() {
  std::vector<const pipeline::ProjectionKernels*> all;
  if (__builtin_cpu_supports("avx2")) all.push_back(&pipeline::avx2_kernels());
  if (pipeline::has_avx512()) all.push_back(&pipeline::avx512_kernels());
  return all;
}

TEST(ProjectionKernels, OrientAndDrawBitForBitWithEveryInstructionSet) {
  std::mt19937_64 random(12);
  std::normal_distribution<float> normal(0.0F, 100.0F);
  std::vector<float> xyz(4 * 1003);
  for (float& value : xyz) value = normal(random);
  const double matrix[12] = {0.3, -0.7, 0.2, 5.0, 0.1, 0.9, -0.4, -2.0, 0.6, 0.2, 0.8, 100.0};
  struct Result {
    std::vector<float> x, y, z;
    float low[3], high[3];
    std::vector<std::uint32_t> drawn;
    std::size_t count = 0;
  };
  const auto run = [&](const pipeline::ProjectionKernels& kernels) {
    Result r{std::vector<float>(1003), std::vector<float>(1003), std::vector<float>(1003), {}, {}, {}, 0};
    kernels.orient(xyz.data(), 4, 1003, matrix, r.x.data(), r.y.data(), r.z.data(), r.low, r.high);
    r.drawn.resize(1003);
    r.count = kernels.draw(xyz.data(), 4, 1003, 0x20000000U, r.drawn.data());
    return r;
  };
  if (vector_kernels().empty()) GTEST_SKIP() << "this machine has the baseline only";
  const Result a = run(pipeline::baseline_kernels());
  for (const auto* kernels : vector_kernels()) {
    const Result b = run(*kernels);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.y, b.y);
    EXPECT_EQ(a.z, b.z);
    EXPECT_TRUE(std::equal(a.low, a.low + 3, b.low));
    EXPECT_TRUE(std::equal(a.high, a.high + 3, b.high));
    EXPECT_EQ(a.count, b.count);
    EXPECT_NEAR(static_cast<double>(a.count), 1003.0 / 8.0, 40.0);
    EXPECT_EQ(a.drawn, b.drawn);
  }
}

constexpr double kNoise = 0.0002;  // metres

/// Height of a bent surface with a step; all in metres.
double front(double x, double y) {
  return 0.01 * std::sin(60.0 * x) * std::cos(40.0 * y) + (x + 0.1 * y > 0.08 ? 0.01 : 0.0);
}

/// Points on a bent surface with a step, a back and outliers, sorted into bins of a lattice of 61 x 40 nodes; `crowd`
/// more at node (20, 20).
pipeline::Bins binned(double per_node, std::size_t crowd = 0) {
  constexpr int kNx = 61;
  constexpr int kNy = 40;
  constexpr double kSpacing = 0.002;
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, kNoise);
  pipeline::OrientedPoints points;
  const auto spread = static_cast<std::size_t>(per_node * kNx * kNy);
  points.count = spread + crowd;
  for (auto* array : {&points.x, &points.y, &points.z}) *array = pipeline::make_buffer<float>(points.count);
  for (std::size_t k = 0; k < spread; ++k) {
    const double x = unit(random) * kNx * kSpacing;
    const double y = unit(random) * kNy * kSpacing;
    double z = front(x, y) + noise(random);
    const double what = unit(random);
    if (what < 0.1) z -= 0.06;
    if (what > 0.99) z += 0.1 * unit(random) - 0.05;
    points.x[k] = static_cast<float>(x);
    points.y[k] = static_cast<float>(y);
    points.z[k] = static_cast<float>(z);
  }
  for (std::size_t k = spread; k < points.count; ++k) {
    points.x[k] = points.y[k] = static_cast<float>((19.9 + 0.2 * unit(random)) * kSpacing);
    points.z[k] = 0.0F;
  }
  const pipeline::BinLattice lattice{kNx, kNy, kSpacing, 0.0, 0.0};
  ThreadPool pool(1);
  return pipeline::sort_into_bins(points, {}, lattice, pipeline::BinWindow::all(lattice), pool);
}

TEST(ProjectionKernels, DrawBordersAndBlocksAndClassifyAlikeWithEveryInstructionSet) {
  std::mt19937_64 random(25);
  std::uniform_real_distribution<float> anywhere(-1.0F, 11.0F);
  constexpr std::size_t kCount = 1003;
  constexpr std::int32_t kSide = 9;
  std::array<std::vector<float>, 3> points;
  for (std::vector<float>& values : points) {
    for (std::size_t k = 0; k < kCount; ++k) values.push_back(anywhere(random));
  }
  std::vector<float> height(kSide * kSide);
  for (float& h : height) h = anywhere(random);
  height[30] = std::numeric_limits<float>::quiet_NaN();
  const auto run = [&](const pipeline::ProjectionKernels& kernels) {
    std::array<std::vector<std::uint32_t>, 2> drawn{std::vector<std::uint32_t>(kCount),
                                                    std::vector<std::uint32_t>(kCount)};
    const float* const x = points[0].data();
    const float* const y = points[1].data();
    drawn[0].resize(kernels.draw_border({1.0F, 9.0F, 2.0F, 8.0F}, x, y, kCount, drawn[0].data()));
    drawn[1].resize(kernels.draw_blocks({0.5F, 0.5F, 2.0F, 0x40000000U}, x, y, kCount, drawn[1].data()));
    std::vector<std::uint8_t> point_class(kCount);
    const pipeline::ClassifyKernel classes{height.data(), kSide, 0.5F, 0.5F, 1.0F, kSide - 1.0F,
                                           kSide - 1.0F,  0.5F,  1,    2,    9};
    kernels.classify(classes, x, y, points[2].data(), kCount, point_class.data());
    return std::pair(drawn, point_class);
  };
  const auto [drawn, point_class] = run(pipeline::baseline_kernels());
  std::vector<std::uint32_t> border;
  for (std::uint32_t k = 0; k < kCount; ++k) {
    const float x = points[0][k];
    const float y = points[1][k];
    if (!(x > 1.0F && x < 9.0F && y > 2.0F && y < 8.0F)) border.push_back(k);
  }
  EXPECT_EQ(drawn[0], border);
  EXPECT_FALSE(drawn[1].empty());
  for (const int code : {0, 1, 2, 9})
    EXPECT_NE(std::find(point_class.begin(), point_class.end(), code), point_class.end()) << code;
  for (const auto* kernels : vector_kernels()) EXPECT_EQ(std::pair(drawn, point_class), run(*kernels));
}

TEST(ProjectionKernels, SendEveryPointToTheBandOfItsBinWithEveryInstructionSet) {
  std::mt19937_64 random(24);
  std::uniform_real_distribution<float> anywhere(-2.0F, 12.0F);
  constexpr std::size_t kCount = 1003;
  constexpr std::int32_t kBands = 4;  // of two rows: 2 to 9 of a window whose columns are 1 to 10
  std::array<std::vector<float>, 3> points;
  for (std::vector<float>& values : points) {
    for (std::size_t k = 0; k < kCount; ++k) values.push_back(anywhere(random));
  }
  points[0][7] = pipeline::OrientedPoints::kFarAway;
  const pipeline::BandKernel kernel{-0.5F, 0.25F, 1.0F, 1.0F, 11.0F, 2.0F, 10.0F, 2, 12, 1, 1, kBands};
  using Place = std::array<float, 4>;  // band, bin, or kBands and 0 beyond the window; x, z
  std::vector<Place> expected;
  for (std::size_t k = 0; k < kCount; ++k) {
    const double u = std::floor(static_cast<double>(points[0][k] + 0.5F));
    const double v = std::floor(static_cast<double>(points[1][k] - 0.25F));
    const bool inside = u >= 1.0 && u < 11.0 && v >= 2.0 && v < 10.0;
    const double band = inside ? std::floor(v / 2.0) - 1.0 : kBands;
    const double bin = inside ? std::fmod(v, 2.0) * 12.0 + u : 0.0;
    expected.push_back({static_cast<float>(band), static_cast<float>(bin), points[0][k], points[2][k]});
  }
  std::sort(expected.begin(), expected.end());
  const auto check = [&](const pipeline::ProjectionKernels& kernels) {
    std::vector<std::int32_t> band(kCount);
    std::vector<std::int32_t> bin(kCount);
    kernels.index_bands(kernel, points[0].data(), points[1].data(), kCount, band.data(), bin.data());
    std::vector<std::uint32_t> start(4 * (kBands + 1) + 1, 0);
    for (std::size_t k = 0; k < kCount; ++k) ++start[4 * static_cast<std::size_t>(band[k]) + k % 4 + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<std::uint32_t> head(start.begin(), start.end() - 1);
    std::vector<pipeline::BandPoint> sent(kCount);
    kernels.send_to_bands(
        {points[0].data(), points[1].data(), points[2].data(), band.data(), bin.data(), head.data(), sent.data()},
        kCount);
    EXPECT_TRUE(std::equal(head.begin(), head.end(), start.begin() + 1)) << "a head stopped short of the next start";
    std::vector<Place> places;
    for (std::uint32_t b = 0; b <= kBands; ++b) {
      for (std::uint32_t k = start[4 * b]; k < start[4 * b + 4]; ++k) {
        const float in_band = b < kBands ? static_cast<float>(sent[k].bin) : 0.0F;
        places.push_back({static_cast<float>(b), in_band, sent[k].x, sent[k].z});
      }
    }
    std::sort(places.begin(), places.end());
    EXPECT_EQ(places, expected);
  };
  check(pipeline::baseline_kernels());
  for (const auto* kernels : vector_kernels()) check(*kernels);
}

TEST(ProjectionKernels, SortBinsByHeightThenPlaceWithEveryInstructionSet) {
  std::mt19937_64 random(23);
  for (const int most : {1, 3, 8, 20}) {
    constexpr std::size_t kBins = 203;
    std::uniform_int_distribution<int> size(0, most);
    std::uniform_int_distribution<int> level(0, 3);  // many equal heights and places
    std::vector<std::uint32_t> start(1, 0);
    for (std::size_t b = 0; b < kBins; ++b) start.push_back(start.back() + static_cast<std::uint32_t>(size(random)));
    const std::size_t count = start.back();
    start.resize(start.size() + pipeline::BinSort::kReadAhead, start.back());
    const auto coordinate = [&] { return 0.25F * static_cast<float>(level(random)); };
    std::vector<pipeline::BandPoint> from;
    for (std::size_t k = 0; k < count; ++k) from.push_back({coordinate(), coordinate(), coordinate(), 0});
    from.resize(count + pipeline::BinSort::kReadAhead, {9.0F, 9.0F, 9.0F, 0});
    std::vector<std::array<float, 3>> expected;  // -z, x, y
    for (std::size_t k = 0; k < count; ++k) expected.push_back({-from[k].z, from[k].x, from[k].y});
    for (std::size_t b = 0; b < kBins; ++b) std::sort(expected.begin() + start[b], expected.begin() + start[b + 1]);
    const auto check = [&](const pipeline::ProjectionKernels& kernels) {
      std::array<std::vector<float>, 3> to;
      for (std::vector<float>& values : to) values.assign(count + 1, 7.0F);
      const pipeline::BinSort sort{start.data(), from.data(), to[0].data(), to[1].data(), to[2].data()};
      kernels.sort_bins(sort, kBins);
      for (std::size_t b = 0; b < kBins; ++b) {
        if (start[b + 1] - start[b] > pipeline::BinSort::kFew) continue;
        for (std::size_t k = start[b]; k < start[b + 1]; ++k) {
          EXPECT_EQ((std::array<float, 3>{-to[2][k], to[0][k], to[1][k]}), expected[k]) << "bin " << b;
        }
      }
      for (const std::vector<float>& values : to) EXPECT_EQ(values.back(), 7.0F) << "written beyond the end";
    };
    check(pipeline::baseline_kernels());
    for (const auto* kernels : vector_kernels()) check(*kernels);
  }
}

/// Heights of all nodes, 0 where not measured, and the verdicts.
std::pair<std::vector<float>, std::vector<std::uint8_t>> fit_all(const pipeline::Bins& bins,
                                                                 const pipeline::ProjectionKernels& kernels) {
  const std::vector<float> per_r2(pipeline::NodeKernel::kLeastRadii, 0.4F);
  pipeline::NodeKernel kernel;
  kernel.start = bins.start.get();
  kernel.x = bins.x.get();
  kernel.y = bins.y.get();
  kernel.z = bins.z.get();
  kernel.bins_x = static_cast<std::size_t>(bins.lattice.bins_x());
  kernel.margin = pipeline::BinLattice::kMargin;
  kernel.nx = static_cast<std::size_t>(bins.lattice.nx);
  kernel.spacing_m = bins.lattice.spacing_m;
  kernel.band_m = 0.0057F;
  kernel.scale_m = 0.0002F;
  kernel.ridge = 0.004F;
  for (std::size_t window = 0; window < 3; ++window) {
    kernel.per_r2[window] = per_r2.data();
    kernel.most_of[window] = per_r2.size() - 1;
  }
  std::vector<float> scratch(pipeline::NodeKernel::kScratch);
  kernel.scratch = scratch.data();
  const auto ny = static_cast<std::size_t>(bins.lattice.ny);
  std::pair<std::vector<float>, std::vector<std::uint8_t>> result{std::vector<float>(kernel.nx * ny),
                                                                  std::vector<std::uint8_t>(kernel.nx * ny)};
  kernels.fit_rows(kernel, 0, ny, result.first.data(), result.second.data());
  return result;
}

TEST(ProjectionKernels, FitNodesBitForBitWithEveryInstructionSet) {
  if (vector_kernels().empty()) GTEST_SKIP() << "this machine has the baseline only";
  for (const double per_node : {0.7, 1.5, 4.0, 12.0, 40.0}) {
    const pipeline::Bins bins = binned(per_node);
    const auto a = fit_all(bins, pipeline::baseline_kernels());
    for (const auto* kernels : vector_kernels()) {
      const auto b = fit_all(bins, *kernels);
      EXPECT_EQ(a.second, b.second) << per_node << " points per node";
      EXPECT_EQ(0, std::memcmp(a.first.data(), b.first.data(), a.first.size() * sizeof(float))) << per_node;
    }
  }
}

TEST(ProjectionKernels, ANodeDependsOnlyOnBinsOfItsOwnWindow) {
  const pipeline::Bins plain = binned(4.0);
  const pipeline::Bins crowded = binned(4.0, 50);
  const auto a = fit_all(plain, pipeline::fastest_kernels());
  const auto b = fit_all(crowded, pipeline::fastest_kernels());
  const int nx = plain.lattice.nx;
  for (int node = 0; node < nx * plain.lattice.ny; ++node) {
    // The widest window has three nodes to each side.
    if (std::abs(node % nx - 20) <= 3 && std::abs(node / nx - 20) <= 3) continue;
    const auto k = static_cast<std::size_t>(node);
    EXPECT_EQ(a.second[k], b.second[k]) << node % nx << ", " << node / nx;
    EXPECT_EQ(a.first[k], b.first[k]) << node % nx << ", " << node / nx;
  }
}

/// True when points of the front within 1.5 nodes of node (i, j), four at least, leave no half-plane empty.
bool surrounded(const pipeline::Bins& bins, int i, int j) {
  std::vector<double> angles;
  for (std::size_t k = 0; k < bins.points; ++k) {
    const double x = static_cast<double>(bins.x[k]);
    const double y = static_cast<double>(bins.y[k]);
    const double u = x / bins.lattice.spacing_m - i;
    const double v = y / bins.lattice.spacing_m - j;
    const bool of_front = std::abs(static_cast<double>(bins.z[k]) - front(x, y)) < 6.0 * kNoise;
    if (of_front && u * u + v * v <= 1.5 * 1.5) angles.push_back(std::atan2(v, u));
  }
  if (angles.size() < 4) return false;
  std::sort(angles.begin(), angles.end());
  double widest = angles.front() + 2.0 * std::numbers::pi - angles.back();
  for (std::size_t k = 1; k < angles.size(); ++k) widest = std::max(widest, angles[k] - angles[k - 1]);
  return widest < std::numbers::pi;
}

TEST(ProjectionKernels, CallANodeUnknownOnlyWhereNoPointsSurroundIt) {
  std::size_t unknown = 0;
  for (const double per_node : {1.0, 1.5, 2.5}) {
    const pipeline::Bins bins = binned(per_node);
    const auto verdicts = fit_all(bins, pipeline::fastest_kernels()).second;
    for (std::size_t node = 0; node < verdicts.size(); ++node) {
      if (verdicts[node] != pipeline::NodeKernel::kUnknown) continue;
      ++unknown;
      const int i = static_cast<int>(node) % bins.lattice.nx;
      const int j = static_cast<int>(node) / bins.lattice.nx;
      EXPECT_FALSE(surrounded(bins, i, j)) << per_node << " a node at " << i << ", " << j;
    }
  }
  EXPECT_GT(unknown, 30U);
}

TEST(ProjectionKernels, FitLayersBitForBitWithEveryInstructionSet) {
  if (vector_kernels().empty()) GTEST_SKIP() << "this machine has the baseline only";
  std::mt19937_64 random(22);
  std::normal_distribution<float> normal(0.0F, 1.0F);
  for (std::size_t count = 1; count < 100; ++count) {
    const std::size_t stride = count + pipeline::LayerKernel::kReadAhead;
    std::vector<float> memory(4 * stride);
    for (std::size_t k = 0; k < count; ++k) {
      const float u = 0.5F * normal(random);
      const float v = 0.5F * normal(random);
      memory[k] = u;
      memory[stride + k] = v;
      memory[2 * stride + k] = 0.001F * (u + 3.0F * u * v + 0.2F * normal(random)) + (k % 17 == 16 ? 0.02F : 0.0F);
    }
    const auto run = [&](const pipeline::ProjectionKernels& kernels) {
      std::vector<float> own = memory;
      pipeline::LayerKernel kernel;
      kernel.u = own.data();
      kernel.v = kernel.u + stride;
      kernel.z = kernel.v + stride;
      kernel.w = kernel.z + stride;
      kernel.per_r2 = 1.0F;
      kernel.scale_m = 0.0002F;
      kernel.ridge = 0.001F;
      kernel.bend_ridge = 0.008F;
      std::vector<std::uint32_t> rank(count);
      const bool distinct = kernels.rank_descending(kernel.z, count, rank.data());
      return std::tuple(kernels.fit_layer(kernel, count), rank, distinct);
    };
    const auto [a, rank_a, distinct_a] = run(pipeline::baseline_kernels());
    for (const auto* kernels : vector_kernels()) {
      const auto [b, rank_b, distinct_b] = run(*kernels);
      EXPECT_EQ(a.good, b.good);
      EXPECT_EQ(a.support, b.support);
      for (const auto& [left, right] : {std::pair{a.height_m, b.height_m}, std::pair{a.slope_u_m, b.slope_u_m},
                                        std::pair{a.slope_v_m, b.slope_v_m}, std::pair{a.loss, b.loss}}) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(left), std::bit_cast<std::uint32_t>(right)) << count << " points";
      }
      EXPECT_EQ(rank_a, rank_b);
      EXPECT_EQ(distinct_a, distinct_b);
    }
  }
}

}  // namespace
}  // namespace sparsha::test
