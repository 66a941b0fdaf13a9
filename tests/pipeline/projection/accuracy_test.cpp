// Accuracy of the projection against analytic truth. Bounds are shares of the noise; see docs/measure/accuracy.md for
// the table.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

constexpr double kNoise = 0.0002;
constexpr double kSpacing = 1.0 / 511.0;

scene::GridConfig nodes(int size) {
  scene::GridConfig config;
  config.size = size;
  return config;
}

bool anywhere(double, double) { return true; }
bool away_from_step(double x, double y) { return std::abs(x - step_edge_m(y)) > 3.0 * kSpacing; }

// A tenth of the unit square at the same density per node costs a tenth.
std::size_t points_for(double per_node, int size) { return static_cast<std::size_t>(per_node * size * size); }

TEST(ProjectionAccuracy, SparseBack) {
  const pipeline::Projection p = project_cloud(make_cloud(relief_scan(3.6, 0.2, 1)), nodes(512));
  const Errors away = judge(p.grid, relief_m, away_from_step);
  const Errors all = judge(p.grid, relief_m, anywhere);
  EXPECT_LE(away.rms_m, 0.4 * kNoise);
  EXPECT_LE(away.p99_m, 1.2 * kNoise);
  EXPECT_LE(away.over_2mm, 3e-5);
  EXPECT_LE(all.over_5mm, 3e-4);
  EXPECT_GE(all.measured, 0.995);
  EXPECT_NEAR(p.noise_m, kNoise, 0.15 * kNoise);
}

TEST(ProjectionAccuracy, SlabWithAnEquallyDenseBack) {
  const pipeline::Projection p = project_cloud(make_cloud(relief_scan(1.9, 1.9, 2)), nodes(512));
  const Errors away = judge(p.grid, relief_m, away_from_step);
  const Errors all = judge(p.grid, relief_m, anywhere);
  EXPECT_LE(away.rms_m, 0.5 * kNoise);
  EXPECT_LE(away.p99_m, 1.5 * kNoise);
  EXPECT_LE(away.over_2mm, 3e-5);
  EXPECT_LE(all.over_5mm, 3e-4);
  EXPECT_GE(all.measured, 0.995);
}

TEST(ProjectionAccuracy, SmoothPartsStayWithinTheNoiseOfTheirPoints) {
  constexpr int kSize = 256;
  for (const double per_node : {2.0, 4.0, 8.0, 16.0, 32.0}) {
    std::mt19937_64 random(4);
    Points points;
    sample_surface(points, smooth_forms_m, points_for(per_node, kSize), {kNoise, 0.0}, random);
    const pipeline::Projection p = project_cloud(make_cloud(points), nodes(kSize));
    const Errors errors = judge(p.grid, smooth_forms_m, anywhere);
    EXPECT_LE(errors.rms_m, 0.7 * kNoise / std::sqrt(per_node)) << per_node << " points per node";
  }
}

TEST(ProjectionAccuracy, AGridMuchCoarserThanTheCloudStaysWithinTheNoise) {
  // 400 000 points on 65 x 65 nodes: about a hundred each.
  constexpr int kSize = 65;
  std::mt19937_64 random(14);
  Points points;
  sample_surface(points, smooth_forms_m, 400'000, {kNoise, 0.005}, random);
  const Errors errors = judge(project_cloud(make_cloud(points), nodes(kSize)).grid, smooth_forms_m, anywhere);
  EXPECT_LE(errors.rms_m, kNoise);
  EXPECT_EQ(errors.over_2mm, 0.0);
  EXPECT_EQ(errors.measured, 1.0);
}

TEST(ProjectionAccuracy, OutliersGainNoSupportAtThirtyTwoPointsANode) {
  constexpr int kSize = 200;
  std::mt19937_64 random(5);
  Points points;
  sample_surface(points, smooth_forms_m, points_for(32.0, kSize), {kNoise, 0.005}, random);
  const Errors errors = judge(project_cloud(make_cloud(points), nodes(kSize)).grid, smooth_forms_m, anywhere);
  EXPECT_LE(errors.rms_m, 0.25 * kNoise);
  EXPECT_GE(errors.measured, 0.999);
}

TEST(ProjectionAccuracy, ParallelBackEightMillimetresBehindIsNotMixedIn) {
  std::mt19937_64 random(6);
  Points points;
  sample_surface(points, smooth_forms_m, points_for(3.6, 512), {kNoise, 0.005}, random);
  sample_surface(
      points, [](double x, double y) { return smooth_forms_m(x, y) - 0.008; }, points_for(3.6, 512), {kNoise, 0.0},
      random);
  const Errors errors = judge(project_cloud(make_cloud(points), nodes(512)).grid, smooth_forms_m, anywhere);
  EXPECT_LE(errors.rms_m, 0.5 * kNoise);
  EXPECT_LE(errors.over_2mm, 3e-5);
}

TEST(ProjectionAccuracy, ParallelBackEightMillimetresBehindAStepOfTenDoesNotHideTheStep) {
  std::mt19937_64 random(11);
  Points points;
  sample_surface(points, relief_m, points_for(3.6, 512), {kNoise, 0.005}, random);
  sample_surface(
      points, [](double x, double y) { return relief_m(x, y) - 0.008; }, points_for(3.6, 512), {kNoise, 0.0}, random);
  const Errors errors = judge(project_cloud(make_cloud(points), nodes(512)).grid, relief_m, anywhere);
  EXPECT_LE(errors.over_5mm, 4e-4);
  EXPECT_GE(errors.measured, 0.999);
}

TEST(ProjectionAccuracy, WholeFieldWithItsStepAtThirtyTwoPointsANode) {
  // A strip of the lattice of 512 nodes.
  constexpr double kHeight = 0.25;
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, kNoise);
  Points points;
  for (std::size_t k = 0; k < points_for(32.0 * kHeight, 512); ++k) {
    const double x = unit(random);
    const double y = kHeight * unit(random);
    const double outlier = unit(random) < 0.005 ? 0.1 * unit(random) - 0.05 : 0.0;
    points.push_back({x, y, relief_m(x, y) + normal(random) + outlier});
    if (k % 10 == 0) points.push_back({x, kHeight * unit(random), -0.1 + 0.003 * normal(random) / kNoise});
  }
  scene::GridConfig config;
  config.bounds_m = {0.0, 0.0, 1.0, kHeight};
  config.spacing_m = kSpacing;
  const Errors errors = judge(project_cloud(make_cloud(points), config).grid, relief_m, anywhere);
  EXPECT_LE(errors.rms_m, 0.25 * kNoise);
  EXPECT_GE(errors.measured, 0.999);
}

TEST(ProjectionAccuracy, PlaneAtFiftySixDegrees) {
  const auto plane = [](double x, double y) { return 1.4826 * (0.8 * x + 0.6 * y); };
  std::mt19937_64 random(7);
  Points points;
  sample_surface(points, plane, points_for(3.6, 512), {kNoise, 0.005}, random);
  const Errors errors = judge(project_cloud(make_cloud(points), nodes(512)).grid, plane, anywhere);
  EXPECT_LE(errors.rms_m, 0.5 * kNoise);
  EXPECT_LE(errors.over_2mm, 3e-5);
  EXPECT_GE(errors.measured, 0.999);
}

TEST(ProjectionAccuracy, NodesBesideBarsKeepTheirOwnSide) {
  for (const int width : {1, 2, 3, 4}) {
    // 6 mm high, slanted against the lattice, 6 nodes apart.
    const double bar = width * kSpacing;
    const double period = bar + 6.0 * kSpacing;
    const auto across = [=](double x, double y) { return std::fmod(0.96 * x + 0.28 * y, period); };
    const auto bars = [=](double x, double y) { return across(x, y) < bar ? 0.006 : 0.0; };
    const auto beside = [=](double x, double y) {
      const double t = across(x, y);
      return t >= bar && std::min(t - bar, period - t) < kSpacing;
    };
    std::mt19937_64 random(8);
    Points points;
    sample_surface(points, bars, points_for(3.6, 512), {kNoise, 0.005}, random);
    const Errors errors = judge(project_cloud(make_cloud(points), nodes(512)).grid, bars, beside);
    EXPECT_LE(errors.over_2mm, width == 1 ? 0.25 : 0.07) << width << " nodes wide";
  }
}

TEST(ProjectionAccuracy, DensityVaryingOneToAHundredIsRightOrUnknown) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, kNoise);
  Points points;
  while (points.size() < points_for(3.4, 512)) {
    const double x = unit(random);
    const double y = unit(random);
    if (unit(random) < std::pow(100.0, -x)) points.push_back({x, y, smooth_forms_m(x, y) + normal(random)});
  }
  const Errors errors = judge(project_cloud(make_cloud(points), nodes(512)).grid, smooth_forms_m, anywhere);
  EXPECT_LE(errors.rms_m, kNoise);
  EXPECT_LE(errors.over_2mm, 3e-4);
  EXPECT_GE(errors.measured, 0.985);
}

TEST(ProjectionAccuracy, GridThreeTimesFinerThanTheCloudIsRightOrUnknown) {
  std::mt19937_64 random(10);
  Points points;
  sample_surface(points, smooth_forms_m, points_for(1.0 / 9.0, 512), {kNoise, 0.0}, random);
  const Errors errors = judge(project_cloud(make_cloud(points), nodes(512)).grid, smooth_forms_m, anywhere);
  EXPECT_LE(errors.rms_m, kNoise);
  EXPECT_LE(errors.over_2mm, 1e-3);
  EXPECT_GE(errors.measured, 0.99);
}

TEST(ProjectionAccuracy, GeoreferencedScanLosesNothing) {
  const Eigen::Vector3d origin(450000.0, 5412000.0, 300.0);
  Points points = relief_scan(3.6, 0.2, 1);
  for (std::array<double, 3>& p : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] += origin[static_cast<Eigen::Index>(axis)];
  }
  const pipeline::Projection p = project_cloud(make_cloud(points, origin), nodes(512));
  const auto truth = [&](double x, double y) { return relief_m(x - origin.x(), y - origin.y()) + origin.z(); };
  const auto away = [&](double x, double y) { return away_from_step(x - origin.x(), y - origin.y()); };
  EXPECT_LE(judge(p.grid, truth, away).rms_m, 0.55 * kNoise);
}

TEST(ProjectionAccuracy, UtmFacadeLookedAtHorizontally) {
  // The relief stands upright and faces south: scan = origin + (x, -z, y), seen along +y.
  const Eigen::Vector3d origin(450000.0, 5412000.0, 300.0);
  Points points;
  for (const std::array<double, 3>& p : relief_scan(3.6, 0.2, 1)) {
    points.push_back({origin.x() + p[0], origin.y() - p[2], origin.z() + p[1]});
  }
  Eigen::Matrix4d look = Eigen::Matrix4d::Identity();
  look.topLeftCorner<3, 3>() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const pipeline::Projection p = project_cloud(make_cloud(points, origin), nodes(512), look);
  const auto truth = [&](double x, double y) { return relief_m(x - origin.x(), y - origin.z()) - origin.y(); };
  const auto away = [&](double x, double y) { return away_from_step(x - origin.x(), y - origin.z()); };
  const Errors errors = judge(p.grid, truth, away);
  EXPECT_LE(errors.rms_m, 0.55 * kNoise);
  EXPECT_GE(errors.measured, 0.995);
}

}  // namespace
}  // namespace sparsha::test
