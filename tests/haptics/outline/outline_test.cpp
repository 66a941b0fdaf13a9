// Lines found in depth grids, judged by the analytic shapes that the grids were sampled from.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "haptics/outline/outline.h"
#include "tests/support/guided_hand.h"
#include "tests/support/scenes.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector2d;
using test::Polygon;

constexpr double kSpacing = 0.001;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Even-odd rule.
bool inside(const Polygon& corners, const Vector2d& p) {
  bool in = false;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector2d& a = corners[k];
    const Vector2d& b = corners[(k + 1) % corners.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      in = !in;
  }
  return in;
}

scene::DepthGrid grid_of(const test::HeightFunction& height_m, int n = 201, double noise_m = 0.0) {
  scene::DepthGrid grid(scene::Lattice{n, n, kSpacing, Eigen::Vector3d(0.3, -0.2, 1.0)});
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double z = height_m(i * kSpacing, j * kSpacing);
      if (!std::isfinite(z)) continue;
      const std::size_t node = grid.lattice.index(i, j);
      grid.height_m[node] = static_cast<float>(z + noise_m * noise(random));
      grid.state[node] = scene::NodeState::measured;
    }
  return grid;
}

/// In metres from node (0, 0).
Polygon local(const Line& line) {
  Polygon points;
  for (const Vector2d& p : line) points.push_back(p - Vector2d(0.3, -0.2));
  return points;
}

struct Match {
  double covered = 0.0;     ///< share of the true outline within a limit of the lines found
  double farthest_m = 0.0;  ///< of any line found from the true outlines
};

Match match(const std::vector<Line>& lines, const std::vector<Polygon>& truth, double limit_m) {
  Match result;
  std::size_t all = 0;
  std::size_t near = 0;
  for (const Polygon& outline : truth)
    for (const Vector2d& place : test::along(outline, true, 0.3 * kSpacing)) {
      double least = HUGE_VAL;
      for (const Line& line : lines) least = std::min(least, test::distance_to(local(line), false, place));
      ++all;
      near += least < limit_m ? 1 : 0;
    }
  for (const Line& line : lines)
    for (const Vector2d& place : test::along(local(line), false, 0.3 * kSpacing)) {
      double least = HUGE_VAL;
      for (const Polygon& outline : truth) least = std::min(least, test::distance_to(outline, true, place));
      result.farthest_m = std::max(result.farthest_m, least);
    }
  result.covered = static_cast<double>(near) / static_cast<double>(all);
  return result;
}

bool closed(const Line& line) { return line.size() > 3 && line.front() == line.back(); }

struct Shape {
  const char* name;
  std::vector<Polygon> outlines;
  /// Half of the nodes' diagonal, and what smoothing takes of corners.
  double limit_m = 2.0 * kSpacing;
};

std::vector<Shape> shapes() {
  const Vector2d middle(0.1003, 0.0994);  // no corner on a node
  const Polygon dumbbell{{0.03, 0.06}, {0.08, 0.06}, {0.08, 0.0967}, {0.12, 0.0967}, {0.12, 0.06}, {0.17, 0.06},
                         {0.17, 0.14}, {0.12, 0.14}, {0.12, 0.1033}, {0.08, 0.1033}, {0.08, 0.14}, {0.03, 0.14}};
  return {{"circle", {test::star(60, 0.0503, 0.0503, middle)}},
          {"star", {test::star(5, 0.08, 0.04, middle)}},
          {"ring, a hole in it", {test::star(60, 0.07, 0.07, middle), test::star(60, 0.03, 0.03, middle)}},
          {"thin neck", {dumbbell}},
          {"tiny part", {test::star(20, 0.005, 0.005, middle)}}};
}

bool in_shape(const Shape& shape, double x, double y) {
  bool in = false;
  for (const Polygon& outline : shape.outlines) in = in != inside(outline, {x, y});
  return in;
}

TEST(Outline, OfPlateausOfAnyShapeIsFoundWhereTheStepIs) {
  for (const Shape& shape : shapes())
    for (const double noise_m : {0.0, 0.0002}) {
      const auto grid = grid_of([&](double x, double y) { return in_shape(shape, x, y) ? 0.006 : 0.0; }, 201, noise_m);
      const std::vector<Line> lines = find_outlines(grid, noise_m);
      ASSERT_EQ(lines.size(), shape.outlines.size()) << shape.name << " " << noise_m;
      for (const Line& line : lines) EXPECT_TRUE(closed(line)) << shape.name;
      const Match found = match(lines, shape.outlines, shape.limit_m);
      EXPECT_GE(found.covered, 0.95) << shape.name << " " << noise_m;
      EXPECT_LE(found.farthest_m, shape.limit_m) << shape.name << " " << noise_m;
    }
}

TEST(Outline, OfTheStoneIsTheBorderOfItsKnownNodes) {
  for (const Shape& shape : shapes()) {
    const auto grid = grid_of([&](double x, double y) { return in_shape(shape, x, y) ? test::hills_m(x, y) : kNone; });
    const std::vector<Line> lines = find_outlines(grid, 0.0);
    ASSERT_EQ(lines.size(), shape.outlines.size()) << shape.name;
    for (const Line& line : lines) EXPECT_TRUE(closed(line)) << shape.name;
    const Match found = match(lines, shape.outlines, shape.limit_m);
    EXPECT_GE(found.covered, 0.95) << shape.name;
    EXPECT_LE(found.farthest_m, shape.limit_m) << shape.name;
  }
}

TEST(Outline, OfAStoneThatTheGridCutsEndsAtTheRim) {
  // A disc that goes on beyond the left rim.
  const Vector2d middle(0.01, 0.1);
  const auto grid = grid_of([&](double x, double y) { return std::hypot(x - 0.01, y - 0.1) < 0.0603 ? 0.0 : kNone; });
  const std::vector<Line> lines = find_outlines(grid, 0.0);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_FALSE(closed(lines.front())) << "along the rim nothing is known of a border";
  for (const Vector2d& p : local(lines.front())) EXPECT_NEAR((p - middle).norm(), 0.0603, 2.0 * kSpacing);
  EXPECT_LT(local(lines.front()).front().x(), 0.003);
  EXPECT_LT(local(lines.front()).back().x(), 0.003);
}

TEST(Outline, RunsAlongRidgesAndGrooves) {
  for (const double sign : {1.0, -1.0}) {
    // A roof, 6 mm high and 20 mm wide, along a line oblique to the grid.
    const Vector2d across = Vector2d(0.6, 0.8);
    const auto distance = [&](double x, double y) { return across.dot(Vector2d(x - 0.1, y - 0.1)); };
    const auto grid = grid_of(
        [&](double x, double y) { return sign * 0.006 * std::max(0.0, 1.0 - std::abs(distance(x, y)) / 0.010); });
    const std::vector<Line> lines = find_outlines(grid, 0.0);
    ASSERT_FALSE(lines.empty());
    bool found = false;
    for (const Line& line : lines) {
      double farthest = 0.0;
      for (const Vector2d& p : local(line)) farthest = std::max(farthest, std::abs(distance(p.x(), p.y())));
      found = found || (farthest < kSpacing && (line.back() - line.front()).norm() > 0.15);
    }
    EXPECT_TRUE(found) << sign;
  }
}

TEST(Outline, IsNotFoundWhereThereIsNone) {
  EXPECT_TRUE(find_outlines(grid_of([](double, double) { return 0.01; }), 0.0).empty());
  EXPECT_TRUE(find_outlines(grid_of([](double x, double y) { return 0.7 * x - 0.4 * y; }), 0.0).empty()) << "a slope";
  EXPECT_TRUE(find_outlines(grid_of(test::hills_m), 0.0).empty()) << "gentle hills";
  EXPECT_TRUE(find_outlines(grid_of(test::hills_m, 201, 0.0003), 0.0003).empty()) << "noisy hills";
  EXPECT_TRUE(find_outlines(grid_of([](double, double) { return kNone; }), 0.0).empty()) << "nothing measured";
  EXPECT_TRUE(find_outlines(grid_of([](double, double) { return 0.0; }, 2), 0.0).empty()) << "hardly a node";
}

TEST(Outline, OfNodesOfAPartIsClosedAlsoAtTheRim) {
  const scene::Lattice lattice{50, 40, kSpacing, {0.3, -0.2, 0.0}};
  const std::vector<Line> borders = find_borders(lattice, [](int i, int j) { return i < 10 && j < 20; });
  ASSERT_EQ(borders.size(), 1U);
  EXPECT_TRUE(closed(borders.front()));
  const Polygon box{{0.0, 0.0}, {0.0095, 0.0}, {0.0095, 0.0195}, {0.0, 0.0195}};
  const Match found = match(borders, {box}, kSpacing);
  EXPECT_GE(found.covered, 0.99);
  EXPECT_LE(found.farthest_m, kSpacing);
}

}  // namespace
}  // namespace sparsha::haptics
