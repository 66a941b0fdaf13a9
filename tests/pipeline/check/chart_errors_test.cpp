// Distances of points to a whole object, node by node, where half of the points are moved away from it.
#include "pipeline/check/chart_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/numbers/statistics.h"
#include "pipeline/charts/charts.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::pipeline {
namespace {

TEST(ChartErrors, AreHowFarThePointsAboutEachNodeLieOnAllSides) {
  test::ScanOptions options;
  options.points = 30'000;
  options.noise_spacings = 0.0;
  options.seed = 4;
  const test::ObjectScan scan = scan_object(*test::make_torus(), options);
  test::Points moved = scan.points;
  const double by_m = 0.5 * scan.spacing_m;
  for (std::size_t k = 0; k < moved.size(); ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (scan.points[k][0] > 0.0) moved[k][axis] += by_m * scan.normals[k][static_cast<Eigen::Index>(axis)];
  scene::GridConfig grid;
  grid.spacing_m = scan.spacing_m;
  const Eigen::Matrix4d same = Eigen::Matrix4d::Identity();
  Progress progress;
  ThreadPool pool(2), one(1);
  scene::Charts charts = make_charts(test::make_cloud(scan.points), same, grid, 0.0, {pool, progress}).charts;
  for (const std::int64_t samples : {std::int64_t{0}, std::int64_t{5'000}}) {
    const ChartCheck check =
        check_charts(test::make_cloud(moved), same, charts, scene::CheckConfig{samples}, {pool, progress});
    EXPECT_EQ(check.places.size(), check.cloud_to_surface.samples);
    add_errors(charts, check, {pool, progress});
    scene::Charts again = charts;
    add_errors(again, check, {one, progress});
    std::array<std::vector<double>, 2> errors;  // where nothing moved, and where all did; spacings
    std::size_t unknown = 0;
    // Points within reach of the border are of both.
    const double border_m = (samples == 0 ? 4.0 : 9.0) * scan.spacing_m;
    for (std::size_t s = 0; s < charts.sheets.size(); ++s) {
      const scene::Sheet& sheet = charts.sheets[s];
      ASSERT_EQ(sheet.error_m.size(), sheet.count());
      for (int j = 0; j < sheet.ny; ++j)
        for (int i = 0; i < sheet.nx; ++i) {
          const std::size_t node = sheet.index(i, j);
          if (!sheet.measured(node)) continue;
          unknown += std::isnan(sheet.error_m[node]) ? 1 : 0;
          if (std::isnan(sheet.error_m[node])) continue;
          ASSERT_EQ(sheet.error_m[node], again.sheets[s].error_m[node]);
          const double x = (charts.origin_m + charts.place_m(sheet, i, j)).x();
          if (std::abs(x) > border_m)
            errors[x > 0.0 ? 1 : 0].push_back(static_cast<double>(sheet.error_m[node]) / scan.spacing_m);
        }
    }
    EXPECT_LE(unknown, charts.measured_nodes() / 1000) << samples << " samples";
    for (std::vector<double>& side : errors) ASSERT_GT(side.size(), 5'000U);
    EXPECT_NEAR(quantile(errors[1], 0.5), 0.5, 0.05) << samples << " samples";
    EXPECT_GT(quantile(errors[1], 0.01), 0.4) << samples << " samples";
    EXPECT_LT(quantile(errors[0], 0.99), 0.1) << samples << " samples";
  }
}

}  // namespace
}  // namespace sparsha::pipeline
