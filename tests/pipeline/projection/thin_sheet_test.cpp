// Sheets so thin that a point's nearest neighbours lie on both faces: each face is told alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

constexpr double kNoise = 0.2;  // of the mean distance between points, which is 1 mm

double wave_m(double x, double y) {
  return 0.01 * std::sin(50.0 * x + 11.0 * y) + 0.006 * std::sin(75.0 * y - 16.0 * x);
}

/// Both faces of a waving sheet of 0.2 x 0.2 m, `thick` mm apart along z, whose points are up to 1.6 times as far apart
/// on one side as on the other; turned by `tilt` about y.
Points sheet(double thick, double tilt, std::uint64_t seed) {
  constexpr double kSide = 0.2;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, kNoise * 1e-3);
  Points points;
  for (int face = 0; face < 2; ++face) {
    for (std::size_t n = 0; n < 40'000;) {
      const double x = kSide * (uniform(random) - 0.5);
      const double y = kSide * (uniform(random) - 0.5);
      if (uniform(random) > 0.7 - 3.0 * x) continue;
      const double z = wave_m(x, y) + (face == 0 ? 0.5 : -0.5) * thick * 1e-3 + normal(random);
      points.push_back({x * std::cos(tilt) + z * std::sin(tilt), y, z * std::cos(tilt) - x * std::sin(tilt)});
      ++n;
    }
  }
  return points;
}

struct Judged {
  std::size_t nodes = 0;
  double median = 0.0;  ///< distance across the front, mm
  double wrong = 0.0;   ///< share of nodes more than 1 mm off
};

/// Away from the rim.
Judged judge(const scene::DepthGrid& grid, double thick, double tilt) {
  std::vector<double> errors;
  const scene::Lattice& lattice = grid.lattice;
  for (int j = 0; j < lattice.ny; ++j) {
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      if (grid.state[k] != scene::NodeState::measured) continue;
      const double height = lattice.origin_m.z() + static_cast<double>(grid.height_m[k]);
      const double u = lattice.x_m(i) * std::cos(tilt) - height * std::sin(tilt);
      const double w = lattice.x_m(i) * std::sin(tilt) + height * std::cos(tilt);
      const double v = lattice.y_m(j);
      if (std::max(std::abs(u), std::abs(v)) > 0.09) continue;
      constexpr double kStep = 1e-5;
      const double du = (wave_m(u + kStep, v) - wave_m(u - kStep, v)) / (2.0 * kStep);
      const double dv = (wave_m(u, v + kStep) - wave_m(u, v - kStep)) / (2.0 * kStep);
      errors.push_back(1e3 * std::abs(w - wave_m(u, v) - 0.5e-3 * thick) / std::sqrt(1.0 + du * du + dv * dv));
    }
  }
  Judged judged{errors.size(), 1e9, 1.0};
  if (errors.empty()) return judged;
  std::sort(errors.begin(), errors.end());
  judged.median = errors[errors.size() / 2];
  judged.wrong = static_cast<double>(errors.end() - std::upper_bound(errors.begin(), errors.end(), 1.0)) /
                 static_cast<double>(errors.size());
  return judged;
}

TEST(ThinSheets, AreMeasuredOnTheirFrontFace) {
  for (const double thick : {2.7, 3.5, 4.4}) {
    for (const double tilt : {0.0, 0.35}) {
      scene::GridConfig grid;
      grid.spacing_m = 0.001;
      const pipeline::Projection found = project_cloud(make_cloud(sheet(thick, tilt, 5)), grid);
      const Judged judged = judge(found.grid, thick, tilt);
      EXPECT_LE(judged.median, 0.1) << thick << ' ' << tilt;
      EXPECT_LE(judged.wrong, 0.01) << thick << ' ' << tilt;
      EXPECT_GE(judged.nodes, 0.9 * 180.0 * 180.0 * std::cos(tilt)) << thick << ' ' << tilt;
      EXPECT_NEAR(1e3 * found.noise_m, kNoise, 0.25 * kNoise) << thick << ' ' << tilt;
    }
  }
}

TEST(ThinSheets, NextToTheirLimitAreMostlyUnknownOrRight) {
  constexpr double kThick = 2.0;  // on slopes 1.7 across
  scene::GridConfig grid;
  grid.spacing_m = 0.001;
  const pipeline::Projection found = project_cloud(make_cloud(sheet(kThick, 0.0, 5)), grid);
  const Judged judged = judge(found.grid, kThick, 0.0);
  EXPECT_LE(judged.median, 0.15);
  EXPECT_LE(judged.wrong, 0.08);
  EXPECT_NEAR(1e3 * found.noise_m, kNoise, 0.25 * kNoise);
}

}  // namespace
}  // namespace sparsha::test
