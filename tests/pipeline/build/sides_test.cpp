// The six sides in the report of what a view shows a part of.
#include "pipeline/build/sides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

// The surface of a rod of 4 x 1 x 1 along the scan's x.
std::vector<Eigen::Vector3d> rod() {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  std::vector<Eigen::Vector3d> points;
  while (points.size() < 40'000) {
    Eigen::Vector3d p(unit(random), unit(random), unit(random));
    const Eigen::Index axis = points.size() % 9 == 0 ? 0 : 1 + static_cast<Eigen::Index>(points.size() % 2);
    p[axis] = p[axis] < 0.0 ? -0.5 : 0.5;
    points.emplace_back(4.0 * p.x(), p.y(), p.z());
  }
  return points;
}

double covered(const Report::Side& side) {
  return static_cast<double>(
      std::count_if(side.grey.begin(), side.grey.end(), [](std::uint8_t grey) { return grey != Report::kNoSurface; }));
}

TEST(ReportSides, AreThoseOfTheViewThatTheSceneShows) {
  Report report;
  report.kept_m = rod();
  // Millimetres, seen along the rod with its z up: x right is the scan's y.
  Eigen::Matrix4d scan_to_grid = Eigen::Matrix4d::Identity();
  scan_to_grid.topLeftCorner<3, 3>() << 0, 1000, 0, 0, 0, 1000, 1000, 0, 0;
  add_sides(scan_to_grid, report);
  ASSERT_EQ(report.sides.size(), 6U);
  EXPECT_EQ(report.sides[0].look_from, Eigen::Vector3d::UnitX());
  EXPECT_EQ(report.sides[0].up, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(report.sides[1].look_from, -Eigen::Vector3d::UnitX());
  EXPECT_EQ(report.sides[4].look_from, Eigen::Vector3d::UnitZ());
  // 1 x 1 from its ends, 4 x 1 from elsewhere, and the discs of points around each: 1.6 pixels and a pixel's half.
  const double pixels = 1.0 / report.side_pixel_m;
  const double margin = 2.0 * (1.6 + 0.5) / pixels;
  for (std::size_t k = 0; k < report.sides.size(); ++k) {
    const double length = k < 2 ? 1.0 : 4.0;
    const double area = covered(report.sides[k]) / (pixels * pixels);
    EXPECT_GE(area, length) << report.sides[k].name;
    EXPECT_LE(area, (1.0 + margin) * (length + margin)) << report.sides[k].name;
  }
}

TEST(ReportSides, OfWhatIsSeenFromOneSideThereAreNone) {
  Report report;
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 200; ++j) report.kept_m.emplace_back(0.01 * i, 0.01 * j, 0.05 * std::sin(0.1 * i));
  add_sides(Eigen::Matrix4d::Identity(), report);
  EXPECT_TRUE(report.sides.empty());
  report.kept_m.clear();
  add_sides(Eigen::Matrix4d::Identity(), report);
  EXPECT_TRUE(report.sides.empty());
}

}  // namespace
}  // namespace sparsha::pipeline
