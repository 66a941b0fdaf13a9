// Clouds in the frame of a camera stand upright, and others are not turned for one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "pipeline/suggest/range_image.h"
#include "pipeline/suggest/view.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using Points = std::vector<Eigen::Vector3d>;
using Depth = std::function<double(double, double)>;

RawScan scan_of(Points points, const char* format = "PLY ascii") {
  RawScan scan;
  scan.format = format;
  scan.points = std::move(points);
  scan.records = scan.points.size();
  return scan;
}

View guess(const RawScan& scan) {
  SeenScans seen;
  ScanStatistics statistics;
  statistics.scan = scan;
  statistics.runs = runs_of(scan.points);
  seen.look_at(statistics, 1.0);
  return sides_of(seen, std::nullopt).views.front();
}

/// What a pinhole camera of 60 degrees sees, row by row from the top; depths of zero are gaps.
Points image(int columns, int rows, const Depth& depth, double noise = 0.0) {
  std::mt19937 random(7);
  std::normal_distribution<double> shift(0.0, 1.0);
  Points points;
  const double pixel = 1.15 / columns;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double u = pixel * (i - 0.5 * columns);
      const double v = pixel * (j - 0.5 * rows);
      const double z = depth(u, v) * (1.0 + noise * shift(random));
      if (z > 0.0) points.emplace_back(u * z, v * z, z);
    }
  }
  return points;
}

double head(double u, double v) {  // a ball of 12 cm radius before a wall at 1.5 m
  const double a = u * u + v * v + 1.0;
  const double discriminant = 0.64 - a * (0.64 - 0.0144);
  return discriminant > 0.0 ? (0.8 - std::sqrt(discriminant)) / a : 1.5 + 0.3 * u;
}

bool in_order_of_pixels(const RawScan& scan) { return is_range_image(scan, runs_of(scan.points)); }

TEST(CameraFrame, AnImageOfRaysIsSeenFromTheCameraUpright) {
  for (const double noise : {0.0, 0.005}) {
    for (const char* format : {"PLY ascii", "PLY binary little-endian", "OBJ", "XYZ text", "PCD binary"}) {
      const RawScan scan = scan_of(image(160, 120, head, noise), format);
      EXPECT_TRUE(in_order_of_pixels(scan));
      const View view = guess(scan);
      EXPECT_EQ(view.look_from, Eigen::Vector3d(0, 0, -1));
      EXPECT_EQ(view.up, Eigen::Vector3d(0, -1, 0));
      EXPECT_TRUE(view.evident);
    }
  }
}

TEST(CameraFrame, GapsAndColumnsInPlaceOfRowsDoNoHarm) {
  EXPECT_TRUE(in_order_of_pixels(scan_of(image(160, 120, [](double u, double v) {
    return std::fmod(std::abs(37.0 * u + 91.0 * v), 1.0) < 0.3 ? 0.0 : head(u, v);
  }))));
  Points turned = image(160, 120, head);
  for (Eigen::Vector3d& p : turned) std::swap(p.x(), p.y());
  EXPECT_TRUE(in_order_of_pixels(scan_of(turned)));
}

TEST(CameraFrame, ARoomWhoseBackWallIsAcrossTheViewStandsUprightInAnyOrder) {
  const auto room = [](double u, double v) {  // 4 m wide, 2.7 m high, 4 m deep, with a low block before the wall
    const double side = 2.0 / std::max(std::abs(u), 1e-9);
    const double above = (v > 0.0 ? 1.3 : 1.4) / std::max(std::abs(v), 1e-9);
    const double walls = std::min({4.0, side, above});
    return std::abs(2.5 * u - 0.3) < 0.5 && 2.5 * v > 0.5 ? std::min(walls, 2.5) : walls;
  };
  Points points = image(160, 120, room);
  for (const bool shuffled : {false, true}) {
    if (shuffled) std::shuffle(points.begin(), points.end(), std::mt19937(3));
    EXPECT_TRUE(in_order_of_pixels(scan_of(points))) << shuffled;
    const View view = guess(scan_of(points));
    EXPECT_EQ(view.look_from, Eigen::Vector3d(0, 0, -1)) << shuffled;
    EXPECT_EQ(view.up, Eigen::Vector3d(0, -1, 0)) << shuffled;
  }
  Points rows;  // of a grid of x and y, whose heights differ
  for (int j = 0; j < 60; ++j) {
    for (int i = 0; i < 60; ++i) rows.emplace_back(0.1 * i, 0.1 * j, 40.0 + 0.2 * (i / 7 % 2) + 0.1 * (j / 5 % 3));
  }
  EXPECT_FALSE(in_order_of_pixels(scan_of(rows)));
}

TEST(CameraFrame, AFlatThingBeforeTheOriginStandsUpright) {
  Points points;
  for (int j = 20; j >= 0; --j) {
    for (int i = 0; i < 26; ++i) points.emplace_back(0.02 * i - 0.25, 0.02 * j - 0.2, 0.6 - 0.0004 * i);
  }
  EXPECT_FALSE(in_order_of_pixels(scan_of(points)));  // a grid of x and y
  const View view = guess(scan_of(points));
  EXPECT_EQ(view.look_from, Eigen::Vector3d(0, 0, -1));
  EXPECT_EQ(view.up, Eigen::Vector3d(0, -1, 0));
  // Formats whose z is up have no such frame.
  EXPECT_EQ(guess(scan_of(points, "LAS 1.2 pf3")).up, Eigen::Vector3d(0, 1, 0));
}

TEST(CameraFrame, TheReportedCloudStandsUpright) {
  SPARSHA_REAL_SCANS_OR_SKIP(folder);
  const View view = guess(read_scan(folder / "reported" / "r35_camera_frame.ply"));
  EXPECT_EQ(view.look_from, Eigen::Vector3d(0, 0, -1));
  EXPECT_EQ(view.up, Eigen::Vector3d(0, -1, 0));
}

TEST(CameraFrame, OrdinaryScansAreNotTurned) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto expect_ordinary = [](const Points& points, const char* what, const Eigen::Vector3d& up = {0, 1, 0}) {
    EXPECT_FALSE(in_order_of_pixels(scan_of(points))) << what;
    EXPECT_EQ(guess(scan_of(points)).up, up) << what;
  };
  Points relief, far, statue, high_grid, shell;
  for (int k = 0; k < 4000; ++k) {
    const double x = uniform(random), y = uniform(random);
    relief.emplace_back(x, y, 0.03 * std::sin(9 * x));
    far.emplace_back(430000.0 + x, 1440000.0 + y, 600.0 + 0.03 * std::sin(9 * x));
    const double turn = 6.2831853 * x;
    statue.emplace_back(0.3 * std::cos(turn), 0.3 * std::sin(turn), 0.5 + 1.5 * y);
    const Eigen::Vector3d direction = Eigen::Vector3d(x - 0.5, y - 0.5, uniform(random) - 0.5).normalized();
    shell.emplace_back(Eigen::Vector3d(0, 0, 3) + direction);
  }
  for (int j = 0; j < 60; ++j) {
    for (int i = 0; i < 60; ++i) high_grid.emplace_back(i, j, 5.0 + 0.5 * std::sin(0.2 * i) * std::cos(0.1 * j));
  }
  expect_ordinary(relief, "a relief");
  expect_ordinary(far, "a relief in survey coordinates");
  expect_ordinary(statue, "a statue above zero", Eigen::Vector3d(0, 0, 1));  // along its axis of symmetry
  expect_ordinary(high_grid, "a grid of heights");
  EXPECT_FALSE(in_order_of_pixels(scan_of(shell)));
}

TEST(CameraFrame, AGridOfHeightsIsSeenFromAbove) {
  Points points;
  for (int j = 0; j < 20; ++j) {
    for (int i = 0; i < 20; ++i) points.emplace_back(i, j, 100.0 + 3.0 * i);
  }
  RawScan scan = scan_of(points, "ESRI ASCII grid");
  scan.cell = Eigen::Vector2d(1, 1);
  const View view = guess(scan);
  EXPECT_EQ(view.look_from, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(view.up, Eigen::Vector3d(0, 1, 0));
  EXPECT_TRUE(view.evident);
}

}  // namespace
}  // namespace sparsha::pipeline
