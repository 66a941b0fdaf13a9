// The orthographic sampler: counts, noise, outliers, backs and densities are what was asked for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "pipeline/simulate/simulate.h"

namespace sparsha::pipeline {
namespace {

SimulationConfig accuracy_scene(double points_per_node) {
  SimulationConfig config;
  config.nodes = 256;
  config.scan = SamplerConfig{points_per_node, 1.0, 1};
  return config;
}

TEST(Sampler, GivesExactlyTheAskedNumberOfFrontAndBackPoints) {
  SimulationConfig config = accuracy_scene(2.5);
  config.surface.back = {BackConfig::Kind::rough, 0.2, 0.003, 0.4};
  const SimulatedScan scan = generate(config);
  const auto front = static_cast<std::size_t>(std::count(scan.is_front.begin(), scan.is_front.end(), 1));
  const double expected = 2.5 * 255.0 * 255.0;
  EXPECT_EQ(front, static_cast<std::size_t>(std::floor(expected + 0.5)));
  EXPECT_EQ(scan.points_m.size() - front, static_cast<std::size_t>(std::floor(0.4 * static_cast<double>(front))));
}

TEST(Sampler, NoiseHasTheStatedStandardDeviationAndOutliersTheStatedShareAndSpread) {
  SimulationConfig config = accuracy_scene(4.0);
  config.noise_m = 0.0002;
  config.outlier_fraction = 0.005;
  config.outlier_spread_m = 0.05;
  const SimulatedScan scan = generate(config);
  const Truth truth(config);
  double squares = 0.0;
  double outlier_squares = 0.0;
  std::size_t outliers = 0;
  for (std::size_t k = 0; k < scan.points_m.size(); ++k) {
    const double error = scan.points_m[k].z() - truth.height_m(scan.points_m[k].x(), scan.points_m[k].y());
    if (scan.is_outlier[k] != 0) {
      ++outliers;
      outlier_squares += error * error;
      EXPECT_LE(std::fabs(error), config.outlier_spread_m + 6.0 * config.noise_m);
    } else {
      squares += error * error;
    }
  }
  const auto n = static_cast<double>(scan.points_m.size());
  const double clean = n - static_cast<double>(outliers);
  EXPECT_NEAR(std::sqrt(squares / clean) / config.noise_m, 1.0, 5.0 / std::sqrt(2.0 * clean));
  EXPECT_NEAR(static_cast<double>(outliers), 0.005 * n, 5.0 * std::sqrt(0.005 * 0.995 * n));
  // A uniform distribution has spread / sqrt(3); its square has relative deviation 0.9 / sqrt(count).
  EXPECT_NEAR(outlier_squares / static_cast<double>(outliers) * 3.0 / (0.05 * 0.05), 1.0,
              5.0 / std::sqrt(static_cast<double>(outliers)));
}

TEST(Sampler, PointsFallUniformlyOnTheNodes) {
  const SimulationConfig config = accuracy_scene(3.0);
  const SimulatedScan scan = generate(config);
  constexpr int kBins = 32;
  std::vector<double> counts(kBins * kBins, 0.0);
  for (const Eigen::Vector3d& p : scan.points_m) {
    const int i = std::min(kBins - 1, static_cast<int>(p.x() * kBins));
    const int j = std::min(kBins - 1, static_cast<int>(p.y() * kBins));
    counts[static_cast<std::size_t>(j * kBins + i)] += 1.0;
  }
  const double expected = static_cast<double>(scan.points_m.size()) / (kBins * kBins);
  double chi_square = 0.0;
  for (const double count : counts) chi_square += (count - expected) * (count - expected) / expected;
  const double freedom = kBins * kBins - 1;
  EXPECT_NEAR(chi_square, freedom, 5.0 * std::sqrt(2.0 * freedom));
}

TEST(Sampler, DensityVariesByTheAskedRatioAcrossTheSurface) {
  SimulationConfig config = accuracy_scene(4.0);
  std::get<SamplerConfig>(config.scan).density_ratio = 100.0;
  const SimulatedScan scan = generate(config);
  // Tenths of the width: an exponential density of ratio 100 makes the last hold 100^0.9 times the first.
  std::vector<double> counts(10, 0.0);
  for (const Eigen::Vector3d& p : scan.points_m)
    counts[std::min<std::size_t>(9, static_cast<std::size_t>(p.x() * 10))] += 1;
  const double expected = std::pow(100.0, 0.9);
  EXPECT_NEAR(counts[9] / counts[0] / expected, 1.0, 5.0 / std::sqrt(counts[0]));
}

TEST(Sampler, AParallelBackLiesItsDepthBehindTheFrontEverywhere) {
  SimulationConfig config = accuracy_scene(1.0);
  config.noise_m = 0.0;
  config.surface.back = {BackConfig::Kind::parallel, 0.008, 0.0, 1.0};
  const SimulatedScan scan = generate(config);
  const Truth truth(config);
  for (std::size_t k = 0; k < scan.points_m.size(); ++k) {
    const Eigen::Vector3d& p = scan.points_m[k];
    ASSERT_NEAR(p.z(), truth.height_m(p.x(), p.y()) - (scan.is_front[k] != 0 ? 0.0 : 0.008), 1e-12);
  }
}

TEST(Sampler, FilesTogetherHoldTheSamePointsAsOne) {
  SimulationConfig config = accuracy_scene(1.3);
  config.surface.back = {BackConfig::Kind::rough, 0.2, 0.003, 0.37};
  const SimulatedScan one = generate(config);
  std::get<SamplerConfig>(config.scan).files = 3;
  const SimulatedScan three = generate(config);
  ASSERT_EQ(one.points_m.size(), three.points_m.size());
  EXPECT_EQ(one.points_m, three.points_m);
  EXPECT_EQ(three.station.back(), 2U);
}

TEST(Sampler, GivesTheSameBitsOnOneTwoAndFiveThreads) {
  SimulationConfig config = accuracy_scene(2.0);
  config.outlier_fraction = 0.01;
  config.colour = config.intensity = true;
  config.surface.back = {BackConfig::Kind::rough, 0.2, 0.003, 0.5};
  ThreadPool one(1);
  const SimulatedScan expected = generate(config, one);
  for (const unsigned threads : {2U, 5U}) {
    ThreadPool pool(threads);
    const SimulatedScan scan = generate(config, pool);
    EXPECT_EQ(scan.points_m, expected.points_m);
    EXPECT_EQ(scan.is_outlier, expected.is_outlier);
    EXPECT_EQ(scan.rgba, expected.rgba);
    EXPECT_EQ(scan.intensity, expected.intensity);
  }
}

TEST(Truth, AFacadeSeenHorizontallyInUtmKeepsATenthOfAMicrometre) {
  SimulationConfig config;
  config.surface = {8.0, 5.0, FacadeForm{}, {}};
  config.nodes = 200;
  config.noise_m = 0.0;
  config.scan = SamplerConfig{1.0, 1.0, 1};
  config.origin_m = {450000.25, 5412000.5, 312.0};
  config.look_from = {0.6, 0.8, 0.0};
  config.up = {0.0, 0.0, 1.0};
  const SimulatedScan scan = generate(config);
  const Truth truth(config);
  const Eigen::Matrix3d rotation = truth.scan_to_grid().topLeftCorner<3, 3>();
  EXPECT_NEAR((rotation * Eigen::Vector3d(0.6, 0.8, 0.0) - Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-15);
  EXPECT_NEAR((rotation * Eigen::Vector3d(0.0, 0.0, 1.0) - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-15);
  std::size_t off = 0;
  for (const Eigen::Vector3d& p : scan.points_m) {
    const Eigen::Vector3d grid = rotation * p;
    // Rounding at 5.4e6 m is 1e-9 m a step; a point that close to a vertical reveal may fall on its other side.
    if (truth.step_distance_m(grid.x(), grid.y()) < 1e-7) continue;
    off += std::fabs(grid.z() - truth.height_m(grid.x(), grid.y())) > 1e-7 ? 1 : 0;
  }
  EXPECT_EQ(off, 0U);
}

TEST(Truth, StepDistanceIsTheDistanceToWhereTheHeightJumps) {
  for (const Form& form : {Form{AccuracyForm{}}, Form{BarsForm{0.006, 0.01, 0.05, true}}}) {
    SurfaceConfig config;
    config.form = form;
    const Surface surface(config);
    // Along rays from random points: a jump of half the step or more may only come where the distance is near 0.
    for (int k = 0; k < 100; ++k) {
      const double x = 0.05 + 0.9 * std::fmod(0.618033988 * k, 1.0);
      const double y = 0.05 + 0.9 * std::fmod(0.414213562 * k, 1.0);
      const double reach = std::min(0.04, surface.step_distance_m(x, y));
      for (int direction = 0; direction < 16; ++direction) {
        const double c = std::cos(direction * 0.39269908), s = std::sin(direction * 0.39269908);
        double before = surface.z(x, y);
        for (double t = 1e-5; t < reach; t += 1e-5) {
          const double z = surface.z(x + t * c, y + t * s);
          ASSERT_LT(std::fabs(z - before), 0.003) << x << " " << y;
          before = z;
        }
      }
    }
  }
}

}  // namespace
}  // namespace sparsha::pipeline
