// Objects scanned in lines that are farther apart than the points on them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/pipeline/projection/front_only.h"

namespace sparsha::test {
namespace {

// A line scanner, a turntable with a coarse step, stacked contours. Points on one line tell no plane.
TEST(ScansInLines, ShowTheirFrontAndOnlyTheirFront) {
  for (const NamedObject& named : objects()) {
    ScanOptions options = cloud_of(kMany);
    options.lines = 4.0;
    expect_front_only(named, options);
  }
}

// Noise of half a spacing is as wide as the points on these lines are apart, and wider.
TEST(ScansInLines, ObliqueOnesShowTheirFrontUnderMuchNoise) {
  for (const std::size_t k : {0, 4}) {
    for (const double lines : {4.0, 9.0}) {
      ScanOptions options = cloud_of(kMany, lines > 4.0 ? 0.5 : 0.1);
      options.across = Eigen::Vector3d(0.36, 0.48, 0.8);
      options.lines = lines;
      expect_front_only(objects()[k], options);
    }
  }
}

TEST(ScansInLines, GiveTheirNoiseWithinAQuarter) {
  for (const std::size_t k : {0, 3}) {
    for (const double noise : {0.1, 0.5}) {
      ScanOptions options = cloud_of(kMany, noise);
      options.lines = 4.0;
      EXPECT_NEAR(noise_ratio(scan_object(*objects()[k].object, options)), 1.0, 0.25) << objects()[k].name;
    }
  }
}

// Between lines that are nine times farther apart than their points windows found too little.
TEST(ScansInLines, OpenOnesAreMeasuredBetweenThem) {
  constexpr double kSpacing_m = 0.005;
  const auto truth = [](double x, double y) { return 0.04 * std::sin(9.0 * x) * std::cos(7.0 * y); };
  for (const double noise : {0.1, 0.3}) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> normal(0.0, noise * kSpacing_m);
    Points points;
    for (int k = 0; k < 40'000; ++k) {
      const double gap_m = 3.0 * kSpacing_m;
      const double x = gap_m * (std::floor(unit(random) / gap_m) + 0.02 * (unit(random) - 0.5));
      const double y = unit(random);
      points.push_back({x, y, truth(x, y) + normal(random)});
    }
    scene::GridConfig grid;
    grid.spacing_m = kSpacing_m;
    const pipeline::Projection p = project_cloud(make_cloud(points), grid);
    std::vector<double> errors;
    for (int j = 0; j < p.grid.lattice.ny; ++j) {
      for (int i = 0; i < p.grid.lattice.nx; ++i) {
        const std::size_t k = p.grid.lattice.index(i, j);
        if (p.grid.state[k] != scene::NodeState::measured) continue;
        const double height_m = p.grid.lattice.origin_m.z() + static_cast<double>(p.grid.height_m[k]);
        errors.push_back(std::abs(height_m - truth(p.grid.lattice.x_m(i), p.grid.lattice.y_m(j))) / kSpacing_m);
      }
    }
    EXPECT_GE(static_cast<double>(errors.size()), 0.95 * static_cast<double>(p.grid.lattice.count())) << noise;
    std::sort(errors.begin(), errors.end());
    EXPECT_LE(errors[errors.size() / 2], 0.5 * noise) << noise;
    EXPECT_LE(errors.back(), 3.0) << noise;
    EXPECT_FALSE(p.closed);
    EXPECT_EQ(p.nodes_unsure, 0U);
  }
}

TEST(RealScansInLines, ShowTheirFrontAndOnlyTheirFront) {
  const std::vector<NamedObject> meshes = real_meshes();
  if (meshes.empty()) GTEST_SKIP() << "SPARSHA_SCANS_DIR names no folder of scans";
  for (const NamedObject& named : meshes) {
    ScanOptions options = cloud_of(kMany);
    options.lines = 4.0;
    expect_front_only(named, options);
  }
}

}  // namespace
}  // namespace sparsha::test
