// Texture of whole objects on bumps that are known, and on smooth objects without any. Lengths are in mean point
// spacings, h.
#include "pipeline/charts/sheet_texture.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "pipeline/charts/charts.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kPoints = 60'000;
const double kSpacing = std::sqrt(4.0 * M_PI / kPoints);  // of points on a ball of radius 1

scene::Charts charts_of(const Points& points, unsigned threads = 2) {
  ThreadPool pool(threads);
  Progress progress;
  scene::GridConfig grid;
  grid.spacing_m = kSpacing;
  return pipeline::make_charts(make_cloud(points), Eigen::Matrix4d::Identity(), grid, 0.0, {pool, progress}).charts;
}

/// Height of the bumps over a ball at a direction: waves of 28 spacings.
double bump_m(const Vector3d& direction) {
  const double wave = 2.0 * M_PI / (28.0 * kSpacing);
  return 0.5 * kSpacing * std::sin(wave * direction.x()) * std::sin(wave * direction.y() + 1.0) *
         std::sin(wave * direction.z() + 2.0);
}

Points bumpy_ball(double noise) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  Points points;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const Vector3d n = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Vector3d p = (1.0 + bump_m(n) + noise * kSpacing * normal(random)) * n;
    points.push_back({p.x(), p.y(), p.z()});
  }
  return points;
}

/// What a Gaussian of `sigma_m` in the tangent plane leaves of the bumps at a direction, by a sum over a lattice.
double bump_texture_m(const Vector3d& n, double sigma_m) {
  const Vector3d a = n.unitOrthogonal(), b = n.cross(a);
  double sum = 0.0, weights = 0.0;
  for (int i = -15; i <= 15; ++i)
    for (int j = -15; j <= 15; ++j) {
      const double x = 0.2 * i * sigma_m, y = 0.2 * j * sigma_m;
      if (std::hypot(x, y) > 3.0 * sigma_m) continue;
      const double weight = std::exp(-0.5 * (x * x + y * y) / (sigma_m * sigma_m));
      sum += weight * bump_m((n * std::sqrt(std::max(0.0, 1.0 - x * x - y * y)) + x * a + y * b).normalized());
      weights += weight;
    }
  return bump_m(n) - sum / weights;
}

/// The bumps over the tangent plane at a direction, and the curvature of that function by differences.
double bump_curvature(const Vector3d& n) {
  const Vector3d a = n.unitOrthogonal(), b = n.cross(a);
  const double d = 0.2 * kSpacing;
  const auto at = [&](double x, double y) { return bump_m((n + d * (x * a + y * b)).normalized()); };
  const double xx = (at(1, 0) - 2 * at(0, 0) + at(-1, 0)) / (d * d),
               yy = (at(0, 1) - 2 * at(0, 0) + at(0, -1)) / (d * d);
  const double xy = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * d * d);
  return std::sqrt(std::max(0.0, 0.5 * (xx + yy) * (xx + yy) - (xx * yy - xy * xy)));
}

struct Pairs {
  std::vector<double> found, want;
  void add(double f, double w) { found.push_back(f), want.push_back(w); }
  /// Slope and correlation of found over want.
  [[nodiscard]] std::array<double, 2> fit() const {
    double f = 0, w = 0, ff = 0, ww = 0, fw = 0;
    const auto n = static_cast<double>(found.size());
    for (std::size_t k = 0; k < found.size(); ++k) f += found[k] / n, w += want[k] / n;
    for (std::size_t k = 0; k < found.size(); ++k) {
      ff += (found[k] - f) * (found[k] - f), ww += (want[k] - w) * (want[k] - w);
      fw += (found[k] - f) * (want[k] - w);
    }
    return {fw / ww, fw / std::sqrt(ff * ww)};
  }
};

scene::TextureConfig wide_envelope() {
  scene::TextureConfig config;
  config.sigma_space_m = 10.0 * kSpacing;
  config.sigma_range_m = 10.0 * kSpacing;  // so wide that it averages all
  return config;
}

TEST(SheetTexture, BumpsAreFoundOnEverySide) {
  scene::Charts charts = charts_of(bumpy_ball(0.05));
  ThreadPool pool(2);
  Progress progress;
  pipeline::add_texture(charts, wide_envelope(), {pool, progress});
  pipeline::add_curvature(charts, 2.0 * kSpacing, 0.05 * kSpacing, {pool, progress});
  for (std::size_t side = 0; side < scene::kSides; ++side) {
    Pairs texture, curvature;
    std::size_t unknown = 0;
    for (const scene::Sheet& sheet : charts.sheets) {
      if (sheet.side != static_cast<scene::Side>(side)) continue;
      for (int j = 0; j < sheet.ny; ++j)
        for (int i = 0; i < sheet.nx; ++i) {
          const std::size_t node = sheet.index(i, j);
          if (!sheet.measured(node)) continue;
          const Vector3d n = (charts.place_m(sheet, i, j) + charts.origin_m).normalized();
          if (node % 5 == 0)
            texture.add(static_cast<double>(sheet.texture_m[node]), bump_texture_m(n, wide_envelope().sigma_space_m));
          unknown += std::isnan(sheet.curvature_per_m[node]) ? 1 : 0;
          if (!std::isnan(sheet.curvature_per_m[node]))
            curvature.add(static_cast<double>(sheet.curvature_per_m[node]), bump_curvature(n));
        }
    }
    const auto [height, height_agrees] = texture.fit();
    const auto [bend, bend_agrees] = curvature.fit();
    const std::string all = "side " + std::to_string(side) + ": " + std::to_string(texture.found.size()) +
                            " nodes, texture " + std::to_string(height) + " at correlation " +
                            std::to_string(height_agrees) + ", curvature " + std::to_string(bend) + " at " +
                            std::to_string(bend_agrees) + ", " + std::to_string(unknown) + " unknown";
    if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
    EXPECT_GT(texture.found.size(), 2'000U) << all;
    EXPECT_NEAR(height, 1.0, 0.06) << all;
    EXPECT_GT(height_agrees, 0.97) << all;
    EXPECT_NEAR(bend, 0.8, 0.08) << all << ": the fit's own scale takes some";
    EXPECT_GT(bend_agrees, 0.9) << all;
    EXPECT_LE(unknown, curvature.found.size() / 1'000) << all;
  }
}

/// Of nodes of different sides at the same place.
struct Overlap {
  std::size_t pairs = 0;
  double p99 = 0.0;  ///< of the difference of their texture, spacings
};
/// Nodes a quarter of a spacing apart at most, where both face their side by `least_facing`.
Overlap overlap_of(const scene::Charts& charts, double least_facing) {
  struct Place {
    Vector3d at;
    scene::Side side;
    double texture;
  };
  std::vector<Place> places;
  for (const scene::Sheet& sheet : charts.sheets)
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        const std::size_t node = sheet.index(i, j);
        if (!sheet.measured(node)) continue;
        const Vector3d normal = scene::SideAxes::of(sheet.side).to_chart(scene::Charts::normal(sheet, i, j));
        if (normal.z() < least_facing) continue;
        places.push_back({charts.place_m(sheet, i, j), sheet.side, static_cast<double>(sheet.texture_m[node])});
      }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.at.x() < b.at.x(); });
  std::vector<double> differences;
  const double reach = 0.25 * kSpacing;
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = a + 1; b < places.size() && places[b].at.x() - places[a].at.x() < reach; ++b)
      if (places[a].side != places[b].side && (places[a].at - places[b].at).norm() < reach)
        differences.push_back(std::abs(places[a].texture - places[b].texture) / kSpacing);
  if (differences.empty()) return {};
  std::sort(differences.begin(), differences.end());
  return {differences.size(), differences[differences.size() * 99 / 100]};
}

/// Quantile of the curvature of all nodes, per spacing.
double curvature_of(const scene::Charts& charts, double share) {
  std::vector<double> k;
  for (const scene::Sheet& sheet : charts.sheets)
    for (const float value : sheet.curvature_per_m)
      if (!std::isnan(value)) k.push_back(static_cast<double>(value) * kSpacing);
  std::sort(k.begin(), k.end());
  return k.at(static_cast<std::size_t>(share * static_cast<double>(k.size() - 1)));
}

TEST(SheetTexture, SheetsAgreeWhereTheyOverlapAndNoiseIsNoTexture) {
  constexpr double kNoise = 0.1;
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  Points points;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const Vector3d n = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Vector3d p = (1.0 + kNoise * kSpacing * normal(random)) * n;
    points.push_back({p.x(), p.y(), p.z()});
  }
  scene::Charts charts = charts_of(points);
  ThreadPool pool(2);
  Progress progress;
  scene::TextureConfig config;
  config.sigma_space_m = 3.0 * kSpacing;
  config.sigma_range_m = kSpacing;
  pipeline::add_texture(charts, config, {pool, progress});
  const Overlap all_pairs = overlap_of(charts, 0.0), trusted = overlap_of(charts, 0.5);
  std::string all = std::to_string(all_pairs.pairs) + " pairs, 99th percentile " + std::to_string(all_pairs.p99) +
                    ", " + std::to_string(trusted.pairs) + " where touch goes over, " + std::to_string(trusted.p99);
  EXPECT_GT(trusted.pairs, 300U) << all;
  EXPECT_LE(trusted.p99, 0.05) << all;
  for (const double scale : {2.0, 5.0}) {
    pipeline::add_curvature(charts, scale * kSpacing, 0.0, {pool, progress});
    const double raw = curvature_of(charts, 0.95);
    pipeline::add_curvature(charts, scale * kSpacing, kNoise * kSpacing, {pool, progress});
    const double left = curvature_of(charts, 0.95);
    all += "; k at " + std::to_string(scale) + ": " + std::to_string(raw) + ", " + std::to_string(left);
    // Waves of the height of the noise and of four scales bend by pi^2 / 4 noises per square of the scale.
    EXPECT_LE(left, 0.25 * 2.5 * kNoise / (scale * scale)) << all;
  }
  if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
}

TEST(SheetTexture, DoesNotDependOnThreads) {
  scene::Charts charts = charts_of(bumpy_ball(0.1));
  scene::Charts again = charts;
  Progress progress;
  ThreadPool one(1), three(3);
  pipeline::add_texture(charts, wide_envelope(), {one, progress});
  pipeline::add_texture(again, wide_envelope(), {three, progress});
  for (std::size_t s = 0; s < charts.sheets.size(); ++s) {
    const auto& a = charts.sheets[s].texture_m;
    const auto& b = again.sheets[s].texture_m;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t n = 0; n < a.size(); ++n)
      if (charts.sheets[s].measured(n)) {
        ASSERT_EQ(a[n], b[n]);
      }
  }
}

}  // namespace
}  // namespace sparsha::test
