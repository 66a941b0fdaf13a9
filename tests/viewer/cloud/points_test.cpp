// Blocks, splats and the preview against brute force and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/viewer/cloud/points.h"
#include "viewer/cloud/orientation.h"
#include "viewer/cloud/preview.h"
#include "viewer/cloud/splat.h"

namespace sparsha::viewer::test {
namespace {

TEST(Points, ArrangingKeepsEveryPointWithItsColour) {
  PointView view = scattered(50000, 7);
  const std::vector<Eigen::Vector3f> before = view.points;
  arrange(view);
  ASSERT_EQ(view.points.size(), before.size());
  std::vector<bool> seen(before.size(), false);
  for (std::size_t n = 0; n < view.points.size(); ++n) {
    const std::uint32_t number = view.rgba[n] & 0xFFFFFFU;
    ASSERT_EQ(view.points[n], before[number]);
    ASSERT_FALSE(seen[number]);
    seen[number] = true;
  }
  std::uint32_t next = 0;
  for (const PointBlock& block : view.blocks) {
    EXPECT_EQ(block.begin, next);
    next += block.count;
  }
  EXPECT_EQ(next, before.size());
}

TEST(Points, TheSpacingOfASquareIsFound) {
  for (const int per_side : {20, 300, 900}) {
    PointView view = square(per_side, 2.0);
    arrange(view);
    // Cells are twice as wide as the next, and a plane meets 1 to 2 of them for each of its faces: a factor of 1.5.
    EXPECT_GT(view.spacing_m, 2.0 / per_side / 1.6) << per_side;
    EXPECT_LT(view.spacing_m, 2.0 / per_side * 1.6) << per_side;
  }
}

TEST(Points, StraysDoNotStretchTheBounds) {
  PointView view = square(200, 1.0);
  view.points.emplace_back(1000.0F, 0.0F, 5000.0F);
  arrange(view);
  EXPECT_NEAR(view.high.x(), 0.5, 0.01);
  EXPECT_NEAR(view.low.y(), -0.5, 0.01);
}

TEST(Points, OneOrTwentyOrEqualPointsAreNoProblem) {
  for (const int count : {1, 20}) {
    PointView view = scattered(count, 3);
    arrange(view);
    EXPECT_TRUE(preview_of(view, {}, 1000).any);
    std::ranges::fill(view.points, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
    arrange(view);
    const DepthPreview preview = preview_of(view, {}, 1000);
    EXPECT_TRUE(preview.any);
    EXPECT_TRUE(std::isfinite(preview.coverage));
  }
  PointView none;
  arrange(none);
  EXPECT_FALSE(preview_of(none, {}, 1000).any);
}

/// Every point on its own, in double.
std::vector<std::uint32_t> brute_force(const PointView& points, const SplatView& view, int size) {
  std::vector<std::uint32_t> picture(static_cast<std::size_t>(view.width * view.height), 0);
  std::vector<double> heights(picture.size(), -std::numeric_limits<double>::infinity());
  for (std::size_t n = 0; n < points.points.size(); ++n) {
    const Eigen::Vector3d at = view.to_pixel(points.points[n].cast<double>());
    const int left = static_cast<int>(std::floor(at.x())) - (size - 1) / 2;
    const int top = static_cast<int>(std::floor(at.y())) - (size - 1) / 2;
    for (int y = std::max(top, 0); y < std::min(top + size, view.height); ++y)
      for (int x = std::max(left, 0); x < std::min(left + size, view.width); ++x) {
        const auto k = static_cast<std::size_t>((view.height - 1 - y) * view.width + x);
        if (at.z() <= heights[k]) continue;
        heights[k] = at.z();
        picture[k] = points.rgba[n];
      }
  }
  return picture;
}

TEST(Splat, EqualsBruteForceWithAnyNumberOfThreadsAndInAnySteps) {
  PointView points = scattered(60000, 11);
  arrange(points);
  SplatView view;
  view.scan_to_view = seen_from(Face::left, true, Eigen::Matrix4d::Identity()).topLeftCorner<3, 3>();
  view.scan_to_view = turned(Eigen::Matrix4d::Identity(), true, 0.7, 0.4).topLeftCorner<3, 3>();
  view.target_m = {0.1, -0.2, 0.05};
  view.pixels_per_m = 120.0;
  view.width = 211;
  view.height = 157;
  for (const int size : {1, 3}) {
    const std::vector<std::uint32_t> truth = brute_force(points, view, size);
    std::vector<std::uint32_t> first;
    for (const unsigned threads : {1U, 3U}) {
      ThreadPool pool(threads);
      Splatter splatter(pool);
      splatter.clear(view);
      for (const double to : {0.25, 0.5, 1.0})
        splatter.add(points, {points.rgba, {}, 0.0, 1.0}, {}, to == 0.25 ? 0.0 : to == 0.5 ? 0.25 : 0.5, to, size);
      std::vector<std::uint32_t> picture;
      std::vector<float> heights;
      splatter.read(picture, heights);
      if (first.empty()) first = picture;
      EXPECT_EQ(picture, first) << threads;
      std::size_t wrong = 0;
      for (std::size_t k = 0; k < truth.size(); ++k) wrong += picture[k] != truth[k] ? 1 : 0;
      // Single precision may put a point that lies on a pixel's border into its neighbour: 1e-5 pixels of 1.
      EXPECT_LE(wrong, truth.size() / 1000) << size;
    }
  }
}

TEST(Splat, WhatIsNotANumberOrFarAwayIsLeftOut) {
  PointView points = square(10, 1.0);
  points.points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
  points.points.emplace_back(std::numeric_limits<float>::infinity(), 0.0F, 0.0F);
  points.points.emplace_back(1e30F, -1e30F, 1e30F);
  points.rgba.assign(points.points.size(), 0xFF112233U);
  arrange(points);
  ThreadPool pool(2);
  Splatter splatter(pool);
  SplatView view;
  view.pixels_per_m = 20.0;
  view.width = view.height = 40;
  splatter.clear(view);
  splatter.add(points, {points.rgba, {}, 0.0, 1.0}, {}, 0.0, 1.0, 1);
  std::vector<std::uint32_t> picture;
  std::vector<float> heights;
  splatter.read(picture, heights);
  EXPECT_EQ(std::ranges::count(picture, 0xFF112233U), 100);
}

TEST(Preview, SizeAndCoverageOfADiscAreThoseOfGeometry) {
  PointView points;
  const int n = 600;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = (i + 0.5) / n - 0.5, y = (j + 0.5) / n - 0.5;
      if (std::hypot(x, y) < 0.5) points.points.emplace_back(Eigen::Vector3d(x, y, 0.1 * x).cast<float>());
    }
  arrange(points);
  const DepthPreview preview = preview_of(points, {}, 1U << 22U);
  EXPECT_NEAR(preview.size_m().x(), 1.0, 2.0 / n);
  EXPECT_NEAR(preview.size_m().y(), 1.0, 2.0 / n);
  EXPECT_NEAR(preview.size_m().z(), 0.1, 2.0 / n);
  // A cell counts when it touches the disc: a rim of half a cell's diagonal along the circumference.
  EXPECT_NEAR(preview.coverage, std::numbers::pi / 4.0, std::numbers::pi * preview.cell_m);
  // Seen from the edge, the disc is a line.
  ScanSetup edge;
  edge.scan_to_grid = seen_from(Face::right, true, edge.scan_to_grid);
  EXPECT_NEAR(preview_of(points, edge, 1U << 22U).size_m().y(), 0.1, 2.0 / n);
}

TEST(Preview, TheScaleOfTheOrientationAndTheCropCount) {
  PointView points = square(400, 1.0);
  arrange(points);
  ScanSetup setup;
  setup.scan_to_grid.topLeftCorner<3, 3>() *= 10.0;
  EXPECT_NEAR(preview_of(points, setup, 1U << 20U).size_m().x(), 10.0, 0.06);
  setup.crop = scene::CropConfig{{-0.1, -0.2, -1.0}, {0.1, 0.2, 1.0}};
  const DepthPreview cropped = preview_of(points, setup, 1U << 20U);
  EXPECT_NEAR(cropped.size_m().x(), 2.0, 0.06);
  EXPECT_NEAR(cropped.size_m().y(), 4.0, 0.06);
  setup.crop = scene::CropConfig{{5.0, 5.0, 5.0}, {6.0, 6.0, 6.0}};
  EXPECT_FALSE(preview_of(points, setup, 1U << 20U).any);
}

}  // namespace
}  // namespace sparsha::viewer::test
