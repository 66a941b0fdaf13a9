// Accuracy of the projection against analytic truth; figures are those of docs/accuracy.md.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/pipeline/grid/clouds.h"

namespace sparsha::test {
namespace {

constexpr double kNoise = 0.0002;
constexpr double kSpacing = 1.0 / 511.0;

pipeline::GridConfig nodes(int size) {
  pipeline::GridConfig config;
  config.size = size;
  return config;
}

bool anywhere(double, double) { return true; }
bool away_from_step(double x, double y) { return std::abs(x - step_edge_m(y)) > 3.0 * kSpacing; }

TEST(Projection, MeasuresAReliefBeforeASparseBack) {
  const pipeline::Projection p = project_cloud(make_cloud(relief_scan(3.6, 0.2, 1)), nodes(512));
  const Errors away = judge(p.grid, relief_m, away_from_step);
  const Errors all = judge(p.grid, relief_m, anywhere);
  EXPECT_LE(away.rms_m, 0.5 * kNoise);
  EXPECT_LE(away.p99_m, 1.7 * kNoise);
  EXPECT_LE(away.over_2mm, 3e-5);
  EXPECT_LE(all.over_5mm, 3e-4);
  EXPECT_GE(all.measured, 0.995);
  EXPECT_NEAR(p.noise_m, kNoise, 0.1 * kNoise);
}

}  // namespace
}  // namespace sparsha::test
