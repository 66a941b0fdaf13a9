// Polygons to triangles: the triangles' areas add up to the polygon's, which the shoelace formula tells.
#include "pipeline/scan/triangulate.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ScanFolder;
using Points = std::vector<Eigen::Vector3d>;
using Corners = std::vector<std::uint32_t>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

double area_of(const Triangles& triangles, const Points& points) {
  double area = 0.0;
  for (const auto& [a, b, c] : triangles) area += (points[b] - points[a]).cross(points[c] - points[a]).norm() / 2.0;
  return area;
}

/// Of a flat outline, one bound to a hole by a bridge included.
double area_within(const Corners& corners, const Points& points) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    area += points[corners[i]].cross(points[corners[(i + 1) % corners.size()]]) / 2.0;
  }
  return area.norm();
}

Corners all_of(const Points& points) {
  Corners corners(points.size());
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
  return corners;
}

void expect_cut_right(const Corners& corners, const Points& points) {
  Triangles triangles;
  EXPECT_TRUE(triangulate(corners, points, triangles));
  EXPECT_EQ(triangles.size(), corners.size() - 2);
  const double area = area_within(corners, points);
  EXPECT_NEAR(area_of(triangles, points), area, 1e-12 * static_cast<double>(corners.size()) * area);
}

Eigen::Vector3d on_circle(double radius, double turns) {
  const double angle = 2.0 * std::numbers::pi * turns;
  return {radius * std::cos(angle), radius * std::sin(angle), 0.0};
}

Points gear(std::size_t corners) {
  Points points;
  for (std::size_t i = 0; i < corners; ++i) {
    points.push_back(on_circle(i / 2 % 2 == 0 ? 0.8 : 1.0, static_cast<double>(i) / static_cast<double>(corners)));
  }
  return points;
}

/// A band along a spiral, there and back.
Points spiral(std::size_t corners, double turns) {
  Points points(corners);
  for (std::size_t i = 0; i < corners / 2; ++i) {
    const double turn = turns * static_cast<double>(i) / static_cast<double>(corners / 2);
    points[i] = on_circle(1.0 + turn, turn);
    points[corners - 1 - i] = on_circle(1.5 + turn, turn);
  }
  return points;
}

TEST(Triangulate, AConvexPolygonIsAFan) {
  Points points;
  for (std::size_t i = 0; i < 100; ++i) points.push_back(on_circle(1.0, static_cast<double>(i) / 100.0));
  Triangles cut, fan;
  EXPECT_TRUE(triangulate(all_of(points), points, cut));
  triangulate_as_fan(all_of(points), fan);
  EXPECT_EQ(cut, fan);
}

TEST(Triangulate, APolygonWithAHoleKeepsItWhetherItsBridgeRepeatsIndicesOrPlaces) {
  // A plate of 30 x 20 with a hole of 10 x 10.
  const Points points{{0, 0, 0}, {30, 0, 0}, {30, 20, 0}, {0, 20, 0}, {10, 5, 0}, {10, 15, 0}, {20, 15, 0}, {20, 5, 0}};
  const Corners outline{0, 1, 2, 3, 0, 4, 5, 6, 7, 4};
  EXPECT_DOUBLE_EQ(area_within(outline, points), 500.0);
  Points repeated;
  for (const std::uint32_t corner : outline) repeated.push_back(points[corner]);
  // From any first corner, and upside down.
  for (std::size_t first = 0; first < outline.size(); ++first) {
    Corners turned;
    for (std::size_t i = 0; i < outline.size(); ++i) turned.push_back(outline[(first + i) % outline.size()]);
    expect_cut_right(turned, points);
    Corners apart;
    for (std::size_t i = 0; i < outline.size(); ++i)
      apart.push_back(static_cast<std::uint32_t>((first + i) % outline.size()));
    expect_cut_right(apart, repeated);
    std::reverse(apart.begin(), apart.end());
    expect_cut_right(apart, repeated);
  }
}

TEST(Triangulate, ARoundHoleInAPlateStaysOpen) {
  Points points{{-20, -15, 0}, {20, -15, 0}, {20, 15, 0}, {-20, 15, 0}};
  constexpr std::uint32_t kHole = 60;
  for (std::uint32_t i = 0; i < kHole; ++i) points.push_back(on_circle(10.0, 0.6 - static_cast<double>(i) / kHole));
  Corners outline{0, 1, 2, 3, 0};
  for (std::uint32_t i = 0; i <= kHole; ++i) outline.push_back(4 + i % kHole);
  expect_cut_right(outline, points);
}

TEST(Triangulate, PolygonsOfManyCornersAreCutWithinTheirOutline) {
  for (const std::size_t corners : {64U, 68U, 100U, 10'000U}) expect_cut_right(all_of(gear(corners)), gear(corners));
  for (const std::size_t corners : {66U, 400U, 10'000U}) {
    expect_cut_right(all_of(spiral(corners, 5.0)), spiral(corners, 5.0));
  }
}

TEST(Triangulate, ASlitHoldsNoArea) {
  const Points points{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0.5, 1, 0}};
  expect_cut_right({0, 1, 2, 3, 4, 3}, points);
}

TEST(Triangulate, AnOutlineThatCrossesItselfIsTold) {
  const Points points{{0, 0, 0}, {4, 0, 0}, {0, 2, 0}, {2, 3, 0}};
  Triangles triangles;
  EXPECT_FALSE(triangulate(Corners{0, 1, 2, 3}, points, triangles));
  EXPECT_EQ(triangles.size(), 2U);
  // One without area crosses nothing.
  const Points line{{0, 0, 0}, {0.1, 0.3, 0.7}, {0.3, 0.9, 2.1}, {0.2, 0.6, 1.4}, {0.05, 0.15, 0.35}};
  EXPECT_TRUE(triangulate(all_of(line), line, triangles));
}

TEST(Triangulate, BeyondWhatCanBeCutInTimeAFanStandsInAndIsSaid) {
  const Points points = gear(kMostCornersCut + 4);
  Triangles triangles;
  EXPECT_FALSE(triangulate(all_of(points), points, triangles));
  EXPECT_EQ(triangles.size(), points.size() - 2);

  const auto obj = [](const Points& outline) {
    std::string text, face = "f";
    for (std::size_t i = 0; i < outline.size(); ++i) {
      text += fmt::format("v {} {} 0\n", outline[i].x(), outline[i].y());
      face += fmt::format(" {}", i + 1);
    }
    return text + face + "\n";
  };
  const ScanFolder folder;
  EXPECT_THAT(folder.read("large.obj", obj(points)).warnings,
              ElementsAre(HasSubstr("1 polygon crosses itself or has more than 10000 corners")));
  const Points small = gear(100);
  const RawScan scan = folder.read("gear.obj", obj(small));
  EXPECT_THAT(scan.warnings, IsEmpty());
  EXPECT_NEAR(area_of(scan.faces, scan.points), area_within(all_of(small), small), 1e-9);
}

}  // namespace
}  // namespace sparsha::pipeline
