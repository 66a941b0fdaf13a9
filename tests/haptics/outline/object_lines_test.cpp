// Lines on whole objects, judged by the formulas of the objects alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include "haptics/outline/object_lines.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;
using scene::Charts;

constexpr double kSpacing_m = 0.001;

Eigen::Quaterniond random_turn(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
}

/// A box of half sizes `half_m`, turned about its middle; only what faces a side well enough is in its sheet.
Charts box_charts(const Vector3d& half_m, const Eigen::Quaterniond& turn) {
  const Eigen::Matrix3d to_grid = turn.toRotationMatrix();
  return test::charts_of(
      [&](scene::Side side, double u, double v) -> std::optional<test::SeenSurface> {
        const scene::SideAxes axes = scene::SideAxes::of(side);
        const Vector3d towards = to_grid.transpose() * axes.to_grid(Vector3d(0.0, 0.0, 1.0));
        const Vector3d from_m = to_grid.transpose() * axes.to_grid(Vector3d(u, v, 0.0));
        double leaves = HUGE_VAL, enters = -HUGE_VAL;
        Vector3d normal = Vector3d::Zero();
        for (int axis = 0; axis < 3; ++axis) {
          if (std::abs(towards[axis]) < 1e-12) {
            if (std::abs(from_m[axis]) > half_m[axis] + 1e-9) return std::nullopt;
            continue;
          }
          const double sign = towards[axis] > 0.0 ? 1.0 : -1.0;
          enters = std::max(enters, (-sign * half_m[axis] - from_m[axis]) / towards[axis]);
          const double at = (sign * half_m[axis] - from_m[axis]) / towards[axis];
          if (at >= leaves) continue;
          leaves = at;
          normal = sign * Vector3d::Unit(axis);
        }
        if (leaves < enters - 1e-9) return std::nullopt;
        const Vector3d n = axes.to_chart(Vector3d(to_grid * normal));
        if (n.z() < 0.4) return std::nullopt;
        return test::SeenSurface{leaves, -n.x() / n.z(), -n.y() / n.z()};
      },
      static_cast<int>(half_m.norm() / kSpacing_m) + 2, kSpacing_m);
}

double distance_to_edges(const Vector3d& place_m, const Vector3d& half_m) {
  double least_m = HUGE_VAL;
  for (int along = 0; along < 3; ++along) {
    const int a = (along + 1) % 3, b = (along + 2) % 3;
    Vector3d off = Vector3d::Zero();
    off[a] = std::abs(place_m[a]) - half_m[a];
    off[b] = std::abs(place_m[b]) - half_m[b];
    off[along] = std::max(0.0, std::abs(place_m[along]) - half_m[along]);
    least_m = std::min(least_m, off.norm());
  }
  return least_m;
}

/// Places along the twelve edges, a spacing apart, those within `corner_m` of a corner left out.
std::vector<Vector3d> edges_of(const Vector3d& half_m, double corner_m) {
  std::vector<Vector3d> places_m;
  for (int along = 0; along < 3; ++along)
    for (const double a : {-1.0, 1.0})
      for (const double b : {-1.0, 1.0})
        for (double at = -half_m[along] + corner_m; at <= half_m[along] - corner_m; at += kSpacing_m) {
          Vector3d place_m;
          place_m[along] = at;
          place_m[(along + 1) % 3] = a * half_m[(along + 1) % 3];
          place_m[(along + 2) % 3] = b * half_m[(along + 2) % 3];
          places_m.push_back(place_m);
        }
  return places_m;
}

double share_covered(const std::vector<Vector3d>& places_m, const std::vector<ObjectLine>& lines, double within_m) {
  const auto covered = std::count_if(places_m.begin(), places_m.end(), [&](const Vector3d& place_m) {
    return std::any_of(lines.begin(), lines.end(), [&](const ObjectLine& line) {
      return std::any_of(line.begin(), line.end(),
                         [&](const LinePlace& corner) { return (corner.place_m - place_m).norm() < within_m; });
    });
  });
  return static_cast<double>(covered) / static_cast<double>(places_m.size());
}

/// Cosine of the sharpest turn of a line, from one of its pieces to the next.
double sharpest_turn(const ObjectLine& line) {
  double least = 1.0;
  for (std::size_t k = 2; k < line.size(); ++k) {
    const Vector3d from = line[k - 1].place_m - line[k - 2].place_m;
    const Vector3d to = line[k].place_m - line[k - 1].place_m;
    least = std::min(least, from.dot(to) / std::max(1e-15, from.norm() * to.norm()));
  }
  return least;
}

TEST(ObjectLines, OfABoxInAnyDirectionAreItsEdges) {
  std::mt19937_64 random(20);
  for (int k = 0; k < 12; ++k) {
    const Eigen::Quaterniond turn = k == 0 ? Eigen::Quaterniond::Identity() : random_turn(random);
    const Vector3d half_m(0.02, 0.026, 0.031);
    const auto lines = find_object_outlines(box_charts(half_m, turn), 0.0, 1);
    std::vector<ObjectLine> own = lines;  // in the box's own frame
    double worst_m = 0.0;
    for (ObjectLine& line : own)
      for (LinePlace& corner : line) {
        corner.place_m = turn.conjugate() * corner.place_m;
        worst_m = std::max(worst_m, distance_to_edges(corner.place_m, half_m));
      }
    EXPECT_LT(worst_m, 2.0 * kSpacing_m) << k;
    for (const ObjectLine& line : lines) EXPECT_GT(sharpest_turn(line), -0.6) << k << ": no way back";
    EXPECT_GE(share_covered(edges_of(half_m, 4.0 * kSpacing_m), own, 2.0 * kSpacing_m), 0.95) << k;
  }
}

TEST(ObjectLines, OfABallAreNoneAndOfOneThatWasNotSeenWholeItsRim) {
  EXPECT_TRUE(find_object_outlines(test::ball_charts(), 0.0, 1).empty());
  EXPECT_TRUE(find_object_outlines(test::ball_charts(), 0.0, 2).empty());
  const double radius_m = 0.04;
  const auto lines = find_object_outlines(test::ball_charts(radius_m, kSpacing_m, scene::Side::back), 0.0, 1);
  ASSERT_FALSE(lines.empty());
  const ObjectLine& rim = lines.front();
  EXPECT_EQ(rim.front().place_m, rim.back().place_m) << "closed";
  for (const LinePlace& corner : rim) {
    EXPECT_NEAR(corner.place_m.norm(), radius_m, 0.5 * kSpacing_m);
    EXPECT_LT(corner.place_m.z(), -0.25 * radius_m) << "where the back is missing";
  }
  EXPECT_GT(length_m(rim), 2.0 * std::numbers::pi * 0.5 * radius_m);
}

TEST(ObjectLines, OfPartsCloseAroundTheObjectAcrossItsSides) {
  const double radius_m = 0.04;
  const Charts charts = test::ball_charts(radius_m, kSpacing_m);
  std::mt19937_64 random(7);
  for (const double off_m : {0.0, 0.013, -0.03, 0.037}) {
    for (int k = 0; k < 8; ++k) {
      const Vector3d axis = random_turn(random) * Vector3d::UnitX();
      const auto lines = find_object_borders(charts, [&](const Vector3d& p) { return axis.dot(p) - off_m; });
      ASSERT_EQ(lines.size(), 1U) << off_m << ' ' << k;
      const ObjectLine& line = lines.front();
      EXPECT_EQ(line.front().place_m, line.back().place_m) << "closed";
      const double circle_m = std::sqrt(radius_m * radius_m - off_m * off_m);
      EXPECT_NEAR(length_m(line), 2.0 * std::numbers::pi * circle_m,
                  0.02 * 2.0 * std::numbers::pi * circle_m + kSpacing_m);
      for (std::size_t at = 0; at < line.size(); ++at) {
        const Vector3d& p = line[at].place_m;
        EXPECT_LT(std::hypot(axis.dot(p) - off_m, p.norm() - radius_m), 0.3 * kSpacing_m);
        EXPECT_GT(line[at].normal.dot(p.normalized()), std::cos(3.0 * std::numbers::pi / 180.0));
        const Vector3d& before_m = line[at > 0 ? at - 1 : 0].place_m;
        EXPECT_LT((p - before_m).norm(), 3.5 * kSpacing_m);
      }
    }
  }
}

TEST(ObjectLines, ThatAreDrawnNearTheSurfaceLieOnIt) {
  const double radius_m = 0.04;
  const Charts charts = test::ball_charts(radius_m, kSpacing_m);
  std::vector<Vector3d> drawn_m;
  for (int k = 0; k <= 24; ++k) {
    const double angle = 2.0 * std::numbers::pi * (k % 24) / 24.0;
    drawn_m.push_back((radius_m + 0.001) * Vector3d(std::cos(angle), 0.0, std::sin(angle)));
  }
  const ObjectLine line = on_surface(charts, drawn_m, 4.0 * kSpacing_m);
  ASSERT_GT(line.size(), 200U);
  EXPECT_EQ(line.front().place_m, line.back().place_m);
  for (const LinePlace& corner : line) EXPECT_NEAR(corner.place_m.norm(), radius_m, 0.1 * kSpacing_m);
  // Off the object but for a piece of it.
  EXPECT_TRUE(on_surface(charts, {{0.1, 0.0, 0.0}, {0.1, 0.1, 0.0}}, 4.0 * kSpacing_m).empty());
  const ObjectLine piece = on_surface(charts, {{-0.1, 0.0, 0.04}, {0.1, 0.0, 0.04}}, 4.0 * kSpacing_m);
  ASSERT_FALSE(piece.empty());
  EXPECT_LT(length_m(piece), 0.05);
}

}  // namespace
}  // namespace sparsha::haptics
