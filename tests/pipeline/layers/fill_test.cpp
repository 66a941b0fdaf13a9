// Fill: which nodes, judged by brute-force morphology, and which heights, judged by closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <utility>
#include <vector>

#include "pipeline/layers/closing.h"
#include "pipeline/layers/layers.h"
#include "tests/support/allocations.h"
#include "tests/support/grids.h"

namespace sparsha::pipeline {
namespace {

using testing::add_noise;
using testing::forget;
using testing::grid_of;
using testing::lattice_of;

constexpr float kEpsilon = std::numeric_limits<float>::epsilon();
constexpr double kNoStep = 1e9;

/// Closing by definition: a node is outside when some disc centred on a node, anywhere, holds it and no member.
bool closed_by_definition(const NodeSet& set, int i, int j, double diameter) {
  const double radius = diameter / 2;
  const int reach = static_cast<int>(radius);
  const auto in_disc = [&](int dx, int dy) { return dx * dx + dy * dy <= radius * radius + 1e-9; };
  for (int cy = j - reach; cy <= j + reach; ++cy)
    for (int cx = i - reach; cx <= i + reach; ++cx) {
      if (!in_disc(cx - i, cy - j)) continue;
      bool empty = true;
      for (int y = cy - reach; y <= cy + reach && empty; ++y)
        for (int x = cx - reach; x <= cx + reach && empty; ++x)
          if (in_disc(x - cx, y - cy) && x >= 0 && y >= 0 && x < set.nx() && y < set.ny() && set.contains(x, y))
            empty = false;
      if (empty) return false;
    }
  return true;
}

TEST(Closing, AgreesWithItsDefinitionOnRandomSets) {
  std::mt19937 random(7);
  ThreadPool pool(2);
  for (int round = 0; round < 60; ++round) {
    const int nx = 1 + static_cast<int>(random() % 150), ny = 1 + static_cast<int>(random() % 40);
    const double diameter = 0.5 + static_cast<double>(random() % 160) / 10;
    NodeSet set(nx, ny);
    const auto sparseness = static_cast<unsigned>(2 + random() % 60);
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        if (random() % sparseness == 0) set.insert(i, j);
    const NodeSet closed = close_by_disc(set, diameter, pool);
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        ASSERT_EQ(closed.contains(i, j), closed_by_definition(set, i, j, diameter))
            << "round " << round << " node " << i << ' ' << j << " diameter " << diameter;
  }
}

TEST(Closing, AgreesWithOpenCvsDistancesOnALargeMask) {
  // OpenCV's exact distance transform, thresholded, is a dilation by a disc; its closing takes 12 to 130 times as long.
  constexpr int kSide = 400;
  ThreadPool pool(2);
  std::mt19937 random(11);
  NodeSet set(kSide, kSide);
  for (const double diameter : {3.0, 9.5, 26.0}) {
    const int margin = static_cast<int>(diameter / 2) + 1;
    cv::Mat mask = cv::Mat::zeros(kSide + 2 * margin, kSide + 2 * margin, CV_8U);
    set = NodeSet(kSide, kSide);
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        const bool hole = std::hypot(i - 150.0, j - 210.0) < 20.0 || random() % 10 == 0;
        if (hole || std::hypot(i - 200.0, j - 200.0) > 190.0) continue;
        set.insert(i, j);
        mask.at<unsigned char>(j + margin, i + margin) = 255;
      }
    const auto dilated = [&](const cv::Mat& members) {
      cv::Mat distance;
      cv::distanceTransform(255 - members, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
      return cv::Mat(distance <= 0.5 * diameter * (1.0 + 1e-6));
    };
    const cv::Mat closed = 255 - dilated(255 - dilated(mask));
    const NodeSet ours = close_by_disc(set, diameter, pool);
    int differing = 0;
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i)
        differing += ours.contains(i, j) != (closed.at<unsigned char>(j + margin, i + margin) != 0) ? 1 : 0;
    EXPECT_EQ(differing, 0) << "diameter " << diameter;
  }
}

TEST(Closing, HandlesDiscsWiderThanAWordAndTheLattice) {
  ThreadPool pool(1);
  NodeSet set(300, 5);
  set.insert(0, 2);
  set.insert(299, 2);
  EXPECT_TRUE(close_by_disc(set, 20000, pool).contains(150, 2));
  EXPECT_FALSE(close_by_disc(set, 298, pool).contains(150, 2));
}

TEST(Closing, OfNarrowSetsByDiscsManyTimesAsWideFollowsTheDefinition) {
  ThreadPool pool(2);
  std::mt19937 random(19);
  for (const auto& [nx, ny] : {std::pair{30, 1}, {31, 2}, {2, 24}, {1, 20}}) {
    for (const double diameter : {20.0, 35.5}) {
      NodeSet set(nx, ny);
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i)
          if (random() % 8 == 0) set.insert(i, j);
      const NodeSet closed = close_by_disc(set, diameter, pool);
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i)
          ASSERT_EQ(closed.contains(i, j), closed_by_definition(set, i, j, diameter))
              << nx << " x " << ny << ", node " << i << ' ' << j << ", diameter " << diameter;
    }
  }
}

TEST(Outline, EnclosesHolesButNoBays) {
  scene::DepthGrid grid = grid_of(lattice_of(60, 60, 0.001), [](double, double) { return 0; });
  for (int j = 20; j < 40; ++j)
    for (int i = 20; i < 40; ++i) forget(grid, i, j);  // a hole
  for (int j = 0; j < 15; ++j)
    for (int i = 25; i < 36; ++i) forget(grid, i, j);  // a bay, open at the border
  ThreadPool pool(1);
  const NodeSet outline = outline_nodes(grid, 0, pool);
  EXPECT_TRUE(outline.contains(30, 30));
  EXPECT_FALSE(outline.contains(30, 2));
  EXPECT_TRUE(outline.contains(5, 2));
}

TEST(Outline, EnclosesWhatNoWayFromOutsideReaches) {
  std::mt19937 random(23);
  for (const auto& [nx, ny] : {std::pair{1, 1}, {1, 9}, {64, 3}, {65, 40}, {128, 30}, {200, 61}}) {
    for (const unsigned one_in : {2U, 3U, 9U}) {
      NodeSet set(nx, ny);
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i)
          if (random() % one_in == 0) set.insert(i, j);
      // Outside is what has a neighbour outside, until nothing changes.
      const auto at = [nx = nx](int i, int j) { return static_cast<std::size_t>(j * nx + i); };
      std::vector<bool> outside(static_cast<std::size_t>(nx * ny));
      for (bool changed = true; std::exchange(changed, false);) {
        for (int j = 0; j < ny; ++j)
          for (int i = 0; i < nx; ++i) {
            if (set.contains(i, j) || outside[at(i, j)]) continue;
            if (i > 0 && j > 0 && i + 1 < nx && j + 1 < ny && !outside[at(i - 1, j)] && !outside[at(i + 1, j)] &&
                !outside[at(i, j - 1)] && !outside[at(i, j + 1)])
              continue;
            outside[at(i, j)] = changed = true;
          }
      }
      const NodeSet filled = fill_holes(set);
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i)
          ASSERT_EQ(filled.contains(i, j), !outside[at(i, j)]) << nx << " x " << ny << ", node " << i << ' ' << j;
    }
  }
}

TEST(Fill, TakesLessThanTwoBytesANodeHoweverMuchIsUnknown) {
  scene::DepthGrid grid = grid_of(lattice_of(1200, 1000, 0.001), [](double x, double y) { return x + 0.3 * y; });
  for (int j = 0; j < 1000; ++j)
    for (int i = 0; i < 1200; ++i)
      if (std::hypot(i - 600, j - 500) > 300 || std::hypot(i - 600, j - 500) < 4) forget(grid, i, j);
  ThreadPool pool(1);
  allocations::begin_most();
  const std::size_t before = allocations::held();
  fill_gaps(grid, {0.02}, kNoStep, pool);
  EXPECT_EQ(grid.state[grid.lattice.index(600, 500)], scene::NodeState::filled);
  EXPECT_LT(allocations::most_held() - before, 2 * grid.lattice.count());
}

TEST(Fill, FillsGapsUpToTheGivenWidthOnly) {
  const scene::Lattice lattice = lattice_of(80, 40, 0.001);
  scene::DepthGrid grid = grid_of(lattice, [](double, double) { return 0.1; });
  for (int j = 10; j < 30; ++j) {
    for (int i = 10; i < 13; ++i) forget(grid, i, j);  // 4 mm from measured to measured node
    for (int i = 40; i < 60; ++i) forget(grid, i, j);  // 21 mm
  }
  ThreadPool pool(1);
  fill_gaps(grid, {0.006}, kNoStep, pool);
  EXPECT_EQ(grid.state[lattice.index(11, 20)], scene::NodeState::filled);
  EXPECT_EQ(grid.state[lattice.index(50, 20)], scene::NodeState::unknown);
  EXPECT_TRUE(std::isnan(grid.height_m[lattice.index(50, 20)]));
  EXPECT_EQ(grid.state[lattice.index(5, 20)], scene::NodeState::measured);
}

TEST(Fill, FillsExactlyTheUnknownNodesOfTheClosingInsideTheOutline) {
  std::mt19937 random(3);
  scene::DepthGrid grid = grid_of(lattice_of(90, 70, 0.002), [](double x, double) { return x; });
  for (int k = 0; k < 60; ++k) {
    const int ci = static_cast<int>(random() % 90), cj = static_cast<int>(random() % 70),
              r = 1 + static_cast<int>(random() % 6);
    for (int j = std::max(0, cj - r); j < std::min(70, cj + r); ++j)
      for (int i = std::max(0, ci - r); i < std::min(90, ci + r); ++i) forget(grid, i, j);
  }
  const scene::DepthGrid before = grid;
  ThreadPool pool(2);
  const double max_gap = 0.011;
  const NodeSet measured = nodes_of(before, scene::NodeState::measured), outline = outline_nodes(before, max_gap, pool);
  fill_gaps(grid, {max_gap}, kNoStep, pool);
  for (int j = 0; j < 70; ++j)
    for (int i = 0; i < 90; ++i) {
      const std::size_t n = grid.lattice.index(i, j);
      const bool gap = before.state[n] == scene::NodeState::unknown && outline.contains(i, j) &&
                       closed_by_definition(measured, i, j, max_gap / 0.002);
      EXPECT_EQ(grid.state[n] == scene::NodeState::filled, gap) << i << ' ' << j;
      if (before.state[n] == scene::NodeState::measured) {
        EXPECT_EQ(grid.height_m[n], before.height_m[n]);
        EXPECT_EQ(grid.state[n], scene::NodeState::measured);
      }
    }
}

TEST(Fill, ContinuesAPlaneExactly) {
  const auto plane = [](double x, double y) { return 0.02 + 1.4 * x - 0.7 * y; };
  scene::DepthGrid grid = grid_of(lattice_of(60, 60, 0.001), plane);
  for (int j = 20; j < 27; ++j)
    for (int i = 30; i < 37; ++i) forget(grid, i, j);
  ThreadPool pool(1);
  fill_gaps(grid, {0.012}, 0.002, pool);
  for (int j = 20; j < 27; ++j)
    for (int i = 30; i < 37; ++i)
      EXPECT_NEAR(grid.height_m[grid.lattice.index(i, j)], plane(i * 0.001, j * 0.001), 4 * kEpsilon * 0.1);
}

TEST(Fill, AveragesNoiseAndBridgesCurvature) {
  const double radius = 0.2, noise = 0.0001;
  const auto dome = [&](double x, double y) {
    return std::sqrt(radius * radius - (x - 0.05) * (x - 0.05) - (y - 0.05) * (y - 0.05));
  };
  scene::DepthGrid grid = grid_of(lattice_of(101, 101, 0.001), dome);
  add_noise(grid, noise, 5);
  for (int j = 40; j < 46; ++j)
    for (int i = 40; i < 46; ++i) forget(grid, i, j);
  ThreadPool pool(1);
  fill_gaps(grid, {0.01}, 0.003, pool);
  double squares = 0;
  for (int j = 40; j < 46; ++j)
    for (int i = 40; i < 46; ++i)
      squares += std::pow(grid.height_m[grid.lattice.index(i, j)] - dome(i * 0.001, j * 0.001), 2);
  const double sag = 0.0035 * 0.0035 / (2 * radius);  // of the dome over half the gap
  EXPECT_LT(std::sqrt(squares / 36), noise + sag);
}

TEST(Fill, LetsTheLowerSideOfAStepWin) {
  const double step = 0.01;
  const auto surface = [&](double x, double) { return x < 0.03 ? step + 0.2 * x : 0.2 * x; };
  const scene::Lattice lattice = lattice_of(60, 40, 0.001);
  scene::DepthGrid grid = grid_of(lattice, surface);
  for (int j = 0; j < 40; ++j)
    for (int i = 28; i < 33; ++i) forget(grid, i, j);
  ThreadPool pool(1);
  fill_gaps(grid, {0.008}, step / 3, pool);
  for (int j = 4; j < 36; ++j)
    for (int i = 28; i < 33; ++i) {
      ASSERT_EQ(grid.state[lattice.index(i, j)], scene::NodeState::filled);
      EXPECT_NEAR(grid.height_m[lattice.index(i, j)], 0.2 * i * 0.001, 0.2 * 0.001) << i << ' ' << j;
    }
}

TEST(Fill, KeepsAHoleInTheTopOfABarOnTheBar) {
  const double bar = 0.006;
  const auto surface = [&](double x, double) { return x > 0.0255 && x < 0.0345 ? bar : 0.0; };
  const scene::Lattice lattice = lattice_of(60, 40, 0.001);
  scene::DepthGrid grid = grid_of(lattice, surface);
  for (int j = 18; j < 21; ++j)
    for (int i = 29; i < 32; ++i) forget(grid, i, j);
  ThreadPool pool(1);
  fill_gaps(grid, {0.008}, bar / 3, pool);
  EXPECT_NEAR(grid.height_m[lattice.index(30, 19)], bar, 4 * kEpsilon * bar);
}

TEST(Fill, GivesTheSameBitsOnAnyNumberOfThreads) {
  scene::DepthGrid one =
      grid_of(lattice_of(200, 150, 0.001), [](double x, double y) { return std::sin(40 * x) * 0.01 + y; });
  add_noise(one, 1e-4, 1);
  std::mt19937 random(2);
  for (int k = 0; k < 8000; ++k) forget(one, static_cast<int>(random() % 200), static_cast<int>(random() % 150));
  scene::DepthGrid three = one;
  ThreadPool single(1), several(3);
  fill_gaps(one, {0.005}, 0.002, single);
  fill_gaps(three, {0.005}, 0.002, several);
  EXPECT_EQ(std::memcmp(one.height_m.data(), three.height_m.data(), one.height_m.size() * sizeof(float)), 0);
  EXPECT_EQ(one.state, three.state);
}

TEST(Fill, LeavesAnEmptyGridAlone) {
  scene::DepthGrid grid(lattice_of(20, 10, 0.001));
  ThreadPool pool(1);
  fill_gaps(grid, {0.005}, 0.001, pool);
  EXPECT_THAT(grid.state, ::testing::Each(scene::NodeState::unknown));
}

}  // namespace
}  // namespace sparsha::pipeline
