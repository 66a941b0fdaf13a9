// Curvature of textures whose derivatives are known in closed form; noise; friction slope.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <numbers>

#include "pipeline/layers/curvature_kernel.h"
#include "pipeline/layers/layers.h"
#include "tests/support/allocations.h"
#include "tests/support/grids.h"

namespace sparsha::pipeline {
namespace {

using testing::add_noise;
using testing::grid_of;
using testing::lattice_of;

constexpr double kPi = std::numbers::pi;
constexpr double kNoStep = 1e9;

/// z = a sin(kx) sin(ky) and its exact curvatures.
struct Wave {
  double amplitude, wave_number;
  [[nodiscard]] double z(double x, double y) const {
    return amplitude * std::sin(wave_number * x) * std::sin(wave_number * y);
  }
  /// {k, H, K}
  [[nodiscard]] std::array<double, 3> curvature(double x, double y) const {
    const double k = wave_number, a = amplitude;
    const double sx = std::sin(k * x), cx = std::cos(k * x), sy = std::sin(k * y), cy = std::cos(k * y);
    const double zx = a * k * cx * sy, zy = a * k * sx * cy, zxx = -a * k * k * sx * sy, zyy = zxx,
                 zxy = a * k * k * cx * cy;
    const double g = 1 + zx * zx + zy * zy;
    const double mean = (zxx * (1 + zy * zy) + zyy * (1 + zx * zx) - 2 * zxy * zx * zy) / (2 * std::pow(g, 1.5));
    const double gaussian = (zxx * zyy - zxy * zxy) / (g * g);
    return {std::sqrt(std::max(0.0, 2 * mean * mean - gaussian)), mean, gaussian};
  }
};

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double ma = 0, mb = 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    ma += a[n] / static_cast<double>(a.size());
    mb += b[n] / static_cast<double>(a.size());
  }
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    ab += (a[n] - ma) * (b[n] - mb);
    aa += (a[n] - ma) * (a[n] - ma);
    bb += (b[n] - mb) * (b[n] - mb);
  }
  return ab / std::sqrt(aa * bb);
}

const std::vector<float>& flat(const scene::DepthGrid& grid) {
  static std::vector<float> zero;
  zero.assign(grid.lattice.count(), 0.0F);
  return zero;
}

TEST(Curvature, IsExactOnAQuadric) {
  const double h = 0.001;
  const scene::DepthGrid grid = grid_of(lattice_of(61, 61, h), [](double x, double y) {
    const double u = x - 0.03, v = y - 0.03;
    return 2.0 * u * u - 1.5 * v * v + 0.8 * u * v;
  });
  ThreadPool pool(1);
  const CurvatureMap map = texture_curvature(grid, flat(grid), 3 * h, 0, kNoStep, pool);
  const std::size_t centre = grid.lattice.index(30, 30);
  const double xx = 4, yy = -3, xy = 0.8;
  const double tolerance = 2e-3;  // per m: float rounding of heights of some mm over the window's squared size
  EXPECT_NEAR(map.mean_per_m[centre], (xx + yy) / 2, tolerance);
  EXPECT_NEAR(map.gaussian_per_m2[centre], xx * yy - xy * xy, 10 * tolerance);
  EXPECT_NEAR(map.rms_per_m[centre], std::sqrt((xx * xx + yy * yy) / 2 + xy * xy), tolerance);
}

TEST(Curvature, FollowsASinusoidUpToTheFitsOwnSmoothing) {
  const double h = 0.0005;
  const Wave wave{0.002, 2 * kPi / 0.03};  // wavelength 60 nodes, 20 scales
  const scene::DepthGrid grid = grid_of(lattice_of(181, 181, h), [&](double x, double y) { return wave.z(x, y); });
  ThreadPool pool(2);
  const double scale = 3 * h;
  const CurvatureMap map = texture_curvature(grid, flat(grid), scale, 0, kNoStep, pool);
  double peak = 0;
  for (int k = 0; k < 60; ++k) peak = std::max(peak, wave.curvature(k * h, k * h)[0]);
  // A Gaussian-weighted quadratic fit sees a wave of wave number q along each axis weakened by about (q scale)^2.
  const double tolerance = 1.5 * std::pow(wave.wave_number * scale, 2) * peak;
  for (int j = 20; j < 160; ++j)
    for (int i = 20; i < 160; ++i) {
      const auto truth = wave.curvature(i * h, j * h);
      const std::size_t n = grid.lattice.index(i, j);
      EXPECT_NEAR(map.rms_per_m[n], truth[0], tolerance);
      EXPECT_NEAR(map.mean_per_m[n], truth[1], tolerance);
    }
}

TEST(Curvature, CorrelatesWithTheTruthOfANoisyTexture) {
  // Scanned stone: ripples of 0.25 mm, 24 mm long, noise 0.05 mm per node, 1.25 mm spacing.
  const double h = 0.00125, noise = 0.00005;
  const Wave wave{0.00025, 2 * kPi / 0.024};
  scene::DepthGrid grid = grid_of(lattice_of(300, 300, h), [&](double x, double y) { return wave.z(x, y); });
  add_noise(grid, noise, 21);
  ThreadPool pool(2);
  const CurvatureMap map = texture_curvature(grid, flat(grid), 3 * h, noise, kNoStep, pool);
  std::vector<double> found, truth, differences;
  for (int j = 12; j < 288; ++j)
    for (int i = 12; i < 288; ++i) {
      found.push_back(map.rms_per_m[grid.lattice.index(i, j)]);
      truth.push_back(wave.curvature(i * h, j * h)[0]);
      const auto z = [&](int a, int b) { return static_cast<double>(grid.height_m[grid.lattice.index(i + a, j + b)]); };
      const double xx = (z(1, 0) - 2 * z(0, 0) + z(-1, 0)) / (h * h), yy = (z(0, 1) - 2 * z(0, 0) + z(0, -1)) / (h * h);
      const double xy = (z(1, 1) - z(1, -1) - z(-1, 1) + z(-1, -1)) / (4 * h * h);
      differences.push_back(std::sqrt((xx * xx + yy * yy) / 2 + xy * xy));
    }
  EXPECT_GE(correlation(found, truth), 0.95);
  EXPECT_LT(correlation(differences, truth), 0.6) << "node-to-node differences should be the trap that they are";
}

TEST(Curvature, LosesTheExpectationOfNoise) {
  const double h = 0.001, noise = 0.0001;
  scene::DepthGrid grid = grid_of(lattice_of(300, 300, h), [](double, double) { return 0; });
  add_noise(grid, noise, 4);
  ThreadPool pool(1);
  const CurvatureMap with = texture_curvature(grid, flat(grid), 3 * h, noise, kNoStep, pool);
  const CurvatureMap without = texture_curvature(grid, flat(grid), 3 * h, 0, kNoStep, pool);
  double with_2 = 0, without_2 = 0, gaussian = 0;
  int count = 0;
  for (int j = 10; j < 290; ++j)
    for (int i = 10; i < 290; ++i, ++count) {
      const std::size_t n = grid.lattice.index(i, j);
      with_2 += with.mean_per_m[n] * with.mean_per_m[n];
      without_2 += without.rms_per_m[n] * without.rms_per_m[n];
      gaussian += with.gaussian_per_m2[n];
    }
  const double floor_2 = with.noise_floor_per_m * with.noise_floor_per_m;
  // The windows overlap: about 280^2 / 36 independent ones, each with a relative spread of order 1.
  const double spread = 4 / std::sqrt(280.0 * 280 / 36);
  EXPECT_NEAR(without_2 / count / floor_2, 1, spread);
  EXPECT_NEAR(gaussian / count / floor_2, 0, spread);
  EXPECT_LT(with_2 / count, floor_2);
}

TEST(Curvature, KnowsHowMuchNoiseTheEnvelopeTakesAlong) {
  const double h = 0.00125, noise = 0.00005;
  scene::DepthGrid grid = grid_of(lattice_of(300, 300, h), [](double x, double y) { return 0.2 * x - 0.1 * y; });
  add_noise(grid, noise, 12);
  ThreadPool pool(2);
  const scene::TextureConfig texture{0.002, 0.002,
                                     scene::TextureConfig::Method::direct};  // sigma_range is 40 noises: a Gaussian
  const std::vector<float> envelope = bilateral_envelope(grid, texture, pool);
  const double predicted =
      texture_curvature(grid, envelope, 3 * h, noise, kNoStep, pool, texture.sigma_space_m).noise_floor_per_m;
  const CurvatureMap raw = texture_curvature(grid, envelope, 3 * h, 0, kNoStep, pool, texture.sigma_space_m);
  double squares = 0;
  int count = 0;
  for (int j = 16; j < 284; ++j)
    for (int i = 16; i < 284; ++i, ++count) squares += std::pow(raw.rms_per_m[grid.lattice.index(i, j)], 2);
  // The model's Gaussian fills a square and the envelope's a disc, which takes a little more noise along.
  const double share = squares / count / (predicted * predicted);
  EXPECT_GT(share, 0.7);
  EXPECT_LT(share, 1.1);
  EXPECT_LT(predicted, 0.5 * texture_curvature(grid, envelope, 3 * h, noise, kNoStep, pool).noise_floor_per_m);
}

TEST(FrictionSlope, BringsThe95thPercentileToTheMost) {
  const double h = 0.001;
  const Wave wave{0.0005, 2 * kPi / 0.02};
  scene::DepthGrid grid = grid_of(lattice_of(200, 200, h), [&](double x, double y) { return wave.z(x, y); });
  add_noise(grid, 1e-5, 2);
  ThreadPool pool(1);
  const CurvatureMap map = texture_curvature(grid, flat(grid), 3 * h, 1e-5, kNoStep, pool);
  const scene::FrictionConfig config;
  const double c = friction_slope(map, config);
  std::vector<float> k;
  for (int j = 8; j < 192; ++j)
    for (int i = 8; i < 192; ++i) k.push_back(map.rms_per_m[grid.lattice.index(i, j)]);
  std::nth_element(k.begin(), k.begin() + static_cast<std::ptrdiff_t>(k.size() * 95 / 100), k.end());
  EXPECT_NEAR(config.mu_0 + c * k[k.size() * 95 / 100], config.mu_max, 0.01 * (config.mu_max - config.mu_0));
  scene::FrictionConfig given;
  given.c_m = 0.0125;
  EXPECT_EQ(friction_slope(map, given), 0.0125);
}

TEST(FrictionSlope, IsNoneWhereCurvatureIsTheRoundingOfHeights) {
  // A scene's description holds slopes up to 1e12 m.
  CurvatureMap map;
  for (const double k : {0.0, 1e-18, 1e-12, 1e-10}) {
    map.percentile_95_per_m = k;
    EXPECT_EQ(friction_slope(map, {}), 0.0) << k;
  }
  map.percentile_95_per_m = 1e-3;
  EXPECT_GT(friction_slope(map, {}), 0.0) << "a wave of a kilometre's radius";
}

TEST(FrictionSlope, LeavesAFlatNoisyPlaneSmooth) {
  const double h = 0.00125;
  ThreadPool pool(2);
  for (const double noise : {1e-6, 1e-4, 1e-3}) {
    scene::DepthGrid grid = grid_of(lattice_of(300, 300, h), [](double x, double) { return 0.1 * x; });
    add_noise(grid, noise, 6);
    const scene::TextureConfig texture{0.002, 0.0005, scene::TextureConfig::Method::direct};
    const std::vector<float> envelope = bilateral_envelope(grid, texture, pool);
    const CurvatureMap map = texture_curvature(grid, envelope, 3 * h, noise, kNoStep, pool, texture.sigma_space_m);
    const scene::FrictionConfig config;
    const double c = friction_slope(map, config);
    double mean = 0;
    for (const float k : map.rms_per_m) mean += c * k / static_cast<double>(map.rms_per_m.size());
    EXPECT_LT(mean, 0.02 * (config.mu_max - config.mu_0)) << "noise " << noise;
  }
}

TEST(Curvature, HasTheSameBitsInAPartOfTheLattice) {
  // Wider and higher than what is measured at once, from other columns and rows on.
  scene::DepthGrid grid =
      grid_of(lattice_of(1300, 300, 0.001), [](double x, double y) { return 0.01 * std::sin(90 * x + 40 * y); });
  add_noise(grid, 1e-4, 29);
  constexpr int kLeft = 101, kBottom = 37, kWidth = 1100, kHeight = 230;
  scene::DepthGrid part(lattice_of(kWidth, kHeight, 0.001));
  for (int j = 0; j < kHeight; ++j)
    for (int i = 0; i < kWidth; ++i) {
      part.height_m[part.lattice.index(i, j)] = grid.height_m[grid.lattice.index(i + kLeft, j + kBottom)];
      part.state[part.lattice.index(i, j)] = scene::NodeState::measured;
    }
  ThreadPool pool(2);
  constexpr double kScale_m = 0.006;
  constexpr int kReach = 15;  // 2.5 scales
  const CurvatureMap whole =
      texture_curvature(grid, std::vector<float>(grid.lattice.count()), kScale_m, 1e-4, kNoStep, pool);
  const CurvatureMap of_part =
      texture_curvature(part, std::vector<float>(part.lattice.count()), kScale_m, 1e-4, kNoStep, pool);
  for (int j = kReach; j < kHeight - kReach; ++j)
    for (int i = kReach; i < kWidth - kReach; ++i) {
      const std::size_t a = part.lattice.index(i, j), b = grid.lattice.index(i + kLeft, j + kBottom);
      ASSERT_EQ(of_part.rms_per_m[a], whole.rms_per_m[b]) << i << ' ' << j;
      ASSERT_EQ(of_part.gaussian_per_m2[a], whole.gaussian_per_m2[b]) << i << ' ' << j;
    }
}

TEST(Curvature, TakesNoMoreMemoryANodeOnAWideLattice) {
  ThreadPool pool(1);
  const auto bytes_per_node = [&](int nx, int ny) {
    const scene::DepthGrid grid = grid_of(lattice_of(nx, ny, 0.001), [](double x, double y) { return 0.1 * x * y; });
    const std::vector<float> envelope_m(grid.lattice.count());
    allocations::begin_most();
    const std::size_t before = allocations::held();
    const CurvatureMap map = texture_curvature(grid, envelope_m, 0.012, 0.0, kNoStep, pool);
    EXPECT_FALSE(map.rms_per_m.empty());
    return static_cast<double>(allocations::most_held() - before) / static_cast<double>(grid.lattice.count());
  };
  // Three curvatures, a list of which percentiles are taken, bits, and the filtered rows of a piece.
  const double square = bytes_per_node(500, 500), wide = bytes_per_node(5000, 50);
  EXPECT_LT(wide, 1.5 * square);
  EXPECT_LT(wide, 25.0);
}

TEST(CurvatureKernel, GivesTheSameBitsInPortableAndVectorCode) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  constexpr std::size_t kCount = 517;
  constexpr int kRadius = 8;
  std::vector<float> weights(27), row(kCount + 2 * kRadius);
  for (float& w : weights) w = normal(random);
  for (float& z : row) z = random() % 40 == 0 ? scene::kUnknownHeight : normal(random);
  const kernel::CurvatureFilter filter{kRadius, weights.data(), weights.data() + 9, weights.data() + 18};
  std::vector<std::vector<float>> results;
  for (const kernel::CurvatureKernels& kernels :
       {kernel::curvature_kernels_portable(), kernel::curvature_kernels_avx2()}) {
    constexpr std::size_t kRows = 2 * kRadius + 1;
    std::vector<float> value(kRows * kCount), slope(value), bend(value), out(5 * kCount);
    for (std::size_t r = 0; r < kRows; ++r)
      kernels.along(filter, row.data() + kRadius, kCount, value.data() + r * kCount, slope.data() + r * kCount,
                    bend.data() + r * kCount);
    float* const pointers[] = {out.data(), out.data() + kCount, out.data() + 2 * kCount, out.data() + 3 * kCount,
                               out.data() + 4 * kCount};
    kernels.across(filter, value.data() + kRadius * kCount, slope.data() + kRadius * kCount,
                   bend.data() + kRadius * kCount, kCount, kCount, pointers);
    results.push_back(out);
  }
  for (std::size_t n = 0; n < results[0].size(); ++n) {
    if (std::isnan(results[0][n])) {
      EXPECT_TRUE(std::isnan(results[1][n]));
    } else {
      EXPECT_EQ(results[0][n], results[1][n]);
    }
  }
}

}  // namespace
}  // namespace sparsha::pipeline
