// Colours and intensities of whole objects, judged by the functions of place that the points have them of.
#include "pipeline/charts/sheet_attributes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "pipeline/charts/charts.h"
#include "pipeline/scan/sampled_faces.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

constexpr std::uint32_t kRed = 0xFF0000FFU, kBlue = 0xFFFF0000U;

std::array<double, 3> tint_at(const Eigen::Vector3d& p) {
  return {128.0 + 100.0 * std::sin(2.0 * p.x() + 0.3), 128.0 + 100.0 * std::sin(2.0 * p.y() - 0.4),
          128.0 + 100.0 * std::sin(2.0 * p.z() + 0.1)};
}
std::uint32_t packed(const std::array<double, 3>& tint) {
  std::uint32_t rgba = 0xFF000000U;
  for (std::size_t c = 0; c < 3; ++c) rgba |= static_cast<std::uint32_t>(std::lround(tint[c])) << (8 * c);
  return rgba;
}
double shine_at(const Eigen::Vector3d& p) { return 40.0 + 7.0 * p.x() - 3.0 * p.z(); }

ObjectScan scan_of(const ClosedObject& object, std::size_t points, double noise = 0.1) {
  ScanOptions options;
  options.points = points;
  options.noise_spacings = noise;
  options.seed = 31;
  return scan_object(object, options);
}

/// Colours and intensities by place.
pipeline::Cloud tinted(const ObjectScan& scan) {
  pipeline::Cloud cloud = make_cloud(scan.points);
  for (const auto& p : scan.points) {
    const Eigen::Vector3d place(p[0], p[1], p[2]);
    cloud.rgba.push_back(packed(tint_at(place)));
    cloud.intensity.push_back(static_cast<float>(shine_at(place)));
  }
  return cloud;
}

scene::Charts charts_with(const pipeline::Cloud& cloud, double spacing_m, unsigned threads = 2) {
  ThreadPool pool(threads);
  Progress progress;
  scene::GridConfig grid;
  grid.spacing_m = spacing_m;
  const Eigen::Matrix4d same = Eigen::Matrix4d::Identity();
  pipeline::ChartResult result = pipeline::make_charts(cloud, same, grid, 0.0, {pool, progress});
  pipeline::add_attributes(result.charts, cloud, same, {true, true, result.point_spacing_m, result.noise_m},
                           {pool, progress});
  return std::move(result.charts);
}

/// Calls use(sheet, node, place) for each measured node.
template <typename Use>
void each_node(const scene::Charts& charts, const Use& use) {
  for (const scene::Sheet& sheet : charts.sheets)
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i)
        if (sheet.measured(sheet.index(i, j)))
          use(sheet, sheet.index(i, j), Eigen::Vector3d(charts.origin_m + charts.place_m(sheet, i, j)));
}

void expect_tints(const scene::Charts& charts, double off_levels, double off_shine) {
  std::vector<double> levels, shines;
  each_node(charts, [&](const scene::Sheet& sheet, std::size_t node, const Eigen::Vector3d& place) {
    ASSERT_NE(sheet.colour_rgba[node], pipeline::kNoColour);
    ASSERT_EQ(sheet.colour_rgba[node] >> 24U, 255U);
    ASSERT_TRUE(std::isfinite(sheet.intensity[node]));
    const auto want = tint_at(place);
    for (std::size_t c = 0; c < 3; ++c)
      levels.push_back(std::abs((sheet.colour_rgba[node] >> (8 * c) & 255U) - want[c]));
    shines.push_back(std::abs(static_cast<double>(sheet.intensity[node]) - shine_at(place)));
  });
  ASSERT_GT(shines.size(), 1000U);
  const auto worst = [](std::vector<double>& values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  EXPECT_LE(worst(levels, 0.99), off_levels);
  EXPECT_LE(worst(levels, 1.0), 3.0 * off_levels);
  EXPECT_LE(worst(shines, 0.99), off_shine);
}

// A spacing changes a colour by at most 200 levels a metre times itself, an intensity by 8.
TEST(SheetAttributes, AreThoseOfThePlaceOnAllSidesOfAnObject) {
  for (const ObjectPtr& object : {make_torus(), make_two_spheres(), make_vase(turned(48.0, 0.0))}) {
    const ObjectScan scan = scan_of(*object, 40'000);
    expect_tints(charts_with(tinted(scan), scan.spacing_m), 200.0 * scan.spacing_m, 8.0 * scan.spacing_m);
  }
}

TEST(SheetAttributes, AreBetweenPointsWhereNodesAreManyAndTheirMeanWhereNodesAreFew) {
  const ObjectScan scan = scan_of(*make_torus(), 40'000);
  expect_tints(charts_with(tinted(scan), 0.3 * scan.spacing_m), 400.0 * scan.spacing_m, 16.0 * scan.spacing_m);
  expect_tints(charts_with(tinted(scan), 4.0 * scan.spacing_m), 400.0 * scan.spacing_m, 16.0 * scan.spacing_m);
}

// The faces of a plate are three spacings apart, with nodes as far apart as the points and four times as far.
TEST(SheetAttributes, OfTwoFacesOfAWallDoNotMix) {
  const double thick = 3.0 * std::sqrt(8.0 / 20'000);
  for (const Eigen::Matrix3d& view : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turned(25.0, 20.0)}) {
    const ObjectScan scan = scan_of(*make_box({1.0, 1.0, 0.5 * thick}, view), 20'000);
    const Eigen::Vector3d across = view.col(2);
    pipeline::Cloud cloud = make_cloud(scan.points);
    for (const auto& p : scan.points)
      cloud.rgba.push_back(Eigen::Vector3d(p[0], p[1], p[2]).dot(across) > 0.0 ? kRed : kBlue);
    for (const double spacing_m : {scan.spacing_m, 4.0 * scan.spacing_m}) {
      const scene::Charts charts = charts_with(cloud, spacing_m);
      std::array<std::size_t, 2> pure{}, mixed{};
      each_node(charts, [&](const scene::Sheet& sheet, std::size_t node, const Eigen::Vector3d& place) {
        const double side =
            scene::Charts::normal(sheet, static_cast<int>(node) % sheet.nx, static_cast<int>(node) / sheet.nx)
                .dot(across);
        // Beside the plate's rims, whose points are of both colours.
        const Eigen::Vector3d on = view.transpose() * place;
        if (std::abs(side) < 0.9 || std::max(std::abs(on.x()), std::abs(on.y())) > 1.0 - 4.0 * spacing_m) return;
        ++(sheet.colour_rgba[node] == (side > 0.0 ? kRed : kBlue) ? pure : mixed)[side > 0.0 ? 1 : 0];
      });
      EXPECT_EQ(mixed[0] + mixed[1], 0U) << spacing_m / scan.spacing_m << " spacings";
      EXPECT_GT(std::min(pure[0], pure[1]), 200U) << spacing_m / scan.spacing_m << " spacings";
    }
  }
}

TEST(SheetAttributes, AreNoneWhereNoPointHasAnyAndLeftOutWhereNoneIsAskedFor) {
  const ObjectScan scan = scan_of(*make_two_spheres(), 20'000);
  pipeline::Cloud cloud = tinted(scan);
  for (std::size_t k = 0; k < cloud.size(); ++k)
    if (scan.points[k][0] > 0.0) cloud.rgba[k] = pipeline::kNoColour, cloud.intensity[k] = pipeline::kNoIntensity;
  const scene::Charts charts = charts_with(cloud, scan.spacing_m);
  std::size_t without = 0;
  each_node(charts, [&](const scene::Sheet& sheet, std::size_t node, const Eigen::Vector3d& place) {
    if (std::abs(place.x()) < 6.0 * scan.spacing_m) return;  // a cell of a steep sheet is so wide
    ASSERT_EQ(sheet.colour_rgba[node] == pipeline::kNoColour, place.x() > 0.0);
    ASSERT_EQ(std::isnan(sheet.intensity[node]), place.x() > 0.0);
    without += place.x() > 0.0 ? 1 : 0;
  });
  EXPECT_GT(without, 1000U);

  cloud.rgba.clear();
  const scene::Charts grey = charts_with(cloud, scan.spacing_m);
  EXPECT_TRUE(grey.sheets.front().colour_rgba.empty());
  EXPECT_EQ(grey.sheets.front().intensity.size(), grey.sheets.front().count());
}

TEST(SheetAttributes, DependNeitherOnThreadsNorOnThePointsOrder) {
  const ObjectScan scan = scan_of(*make_torus(), 20'000);
  const pipeline::Cloud cloud = tinted(scan);
  std::vector<std::size_t> order(scan.points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(3));
  ObjectScan other = scan;
  for (std::size_t k = 0; k < order.size(); ++k) other.points[k] = scan.points[order[k]];
  const scene::Charts first = charts_with(cloud, scan.spacing_m, 1),
                      again = charts_with(tinted(other), scan.spacing_m, 3);
  ASSERT_EQ(first.sheets.size(), again.sheets.size());
  for (std::size_t s = 0; s < first.sheets.size(); ++s) {
    EXPECT_EQ(first.sheets[s].colour_rgba, again.sheets[s].colour_rgba);
    EXPECT_TRUE(std::ranges::equal(first.sheets[s].intensity, again.sheets[s].intensity,
                                   [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }));
  }
}

// Large faces, whose corners are far from most of what is sampled on them.
TEST(SheetAttributes, OfAMeshLieBetweenItsCorners) {
  pipeline::Cloud mesh = make_cloud({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}});
  mesh.faces = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  const auto shade = [](const Eigen::Vector3d& p) { return 20.0 + 100.0 * p.x() + 10.0 * p.y(); };
  for (std::size_t k = 0; k < 4; ++k) {
    const double level = shade(Eigen::Map<const Eigen::Vector3f>(mesh.xyz1() + 4 * k).cast<double>());
    mesh.rgba.push_back(packed({level, level, 255.0 - level}));
    mesh.intensity.push_back(static_cast<float>(level));
  }
  const pipeline::Cloud cloud = pipeline::sample_faces(mesh, 0.05, 1, true);
  ASSERT_EQ(cloud.rgba.size(), cloud.size());
  ASSERT_GT(cloud.size(), 2000U);
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const double want = shade(Eigen::Map<const Eigen::Vector3f>(cloud.xyz1() + 4 * k).cast<double>());
    ASSERT_NEAR(cloud.rgba[k] & 255U, want, 0.6);
    ASSERT_NEAR(cloud.rgba[k] >> 16U & 255U, 255.0 - want, 0.6);
    ASSERT_NEAR(cloud.intensity[k], want, 0.01);
  }
  // A corner without colour leaves the others theirs.
  mesh.rgba = {kRed, kRed, pipeline::kNoColour, kRed};
  for (const std::uint32_t rgba : pipeline::sample_faces(mesh, 0.05, 1, true).rgba) ASSERT_EQ(rgba, kRed);
  EXPECT_TRUE(pipeline::sample_faces(mesh, 0.05, 1).rgba.empty());
}

}  // namespace
}  // namespace sparsha::test
