// A floor under a statue and a wall behind it are found; a relief's wall, a statue's base, a room's walls are not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "base/files/files.h"
#include "base/threads/thread_pool.h"
#include "base/yaml/yaml.h"
#include "pipeline/build/build.h"
#include "pipeline/suggest/floors.h"
#include "pipeline/suggest/suggest.h"
#include "scene/scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr double kNoise_m = 0.0006;

class Scanner {
 public:
  explicit Scanner(std::uint64_t seed) : random_(seed) {}

  [[nodiscard]] double unit() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  [[nodiscard]] Eigen::Vector3d noise() {
    std::normal_distribution<double> normal(0.0, kNoise_m);
    return {normal(random_), normal(random_), normal(random_)};
  }
  /// On corner + s a + t b, 0 <= s, t <= 1.
  void sheet(const Eigen::Vector3d& corner, const Eigen::Vector3d& a, const Eigen::Vector3d& b, int count) {
    for (int k = 0; k < count; ++k) points.push_back(corner + unit() * a + unit() * b + noise());
  }
  /// A body of that height on y = 0, bulging and with a nose towards +z.
  void statue(double height_m, int count) {
    for (int k = 0; k < count; ++k) {
      const double t = unit();
      const double turn = 2.0 * std::numbers::pi * unit();
      const double radius = height_m * (0.14 + 0.05 * std::sin(7.0 * t) + 0.04 * std::exp(-8.0 * turn * turn));
      points.push_back(Eigen::Vector3d(radius * std::sin(turn), height_m * t, radius * std::cos(turn)) + noise());
    }
  }

  Points points;

 private:
  std::mt19937_64 random_;
};

FloorsAndWalls around(const Points& points) {
  ThreadPool pool(2);
  Progress progress;
  return find_floors_and_walls(points, {pool, progress});
}

Scanner statue_in_a_room(std::uint64_t seed) {
  Scanner scan(seed);
  scan.statue(1.0, 9000);
  scan.sheet({-1.5, 0.0, -1.2}, {3.0, 0.0, 0.0}, {0.0, 0.0, 2.7}, 20000);
  scan.sheet({-1.5, 0.0, -1.0}, {3.0, 0.0, 0.0}, {0.0, 1.6, 0.0}, 12000);
  for (int k = 0; k < 60; ++k)
    scan.points.emplace_back(3.0 * scan.unit() - 1.5, 1.6 * scan.unit(), 2.0 * scan.unit() - 1.0);
  return scan;
}

TEST(FloorsAndWalls, FloorAndWallOfAStatueAreFoundHoweverTheScanIsTurned) {
  for (int turned = 0; turned < 6; ++turned) {
    Scanner scan = statue_in_a_room(static_cast<std::uint64_t>(turned) + 1);
    const Eigen::Vector3d axis(0.3, 1.0, -0.4 * turned);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7 * turned, axis.normalized()).toRotationMatrix();
    for (Eigen::Vector3d& p : scan.points) p = turn * p + Eigen::Vector3d(100.0 * turned, 5.0, -3.0);
    const FloorsAndWalls found = around(scan.points);
    ASSERT_EQ(found.planes.size(), 2U) << turned;
    EXPECT_GT(found.planes[0].filter.normal.normalized().dot(turn.col(1)), 0.999) << turned;
    EXPECT_GT(found.planes[1].filter.normal.normalized().dot(turn.col(2)), 0.999) << turned;
    ASSERT_TRUE(found.piece) << turned;
    std::size_t statue = 0;
    std::size_t others = 0;
    for (std::size_t k = 0; k < scan.points.size(); ++k) {
      if (found.keeps(scan.points[k])) ++(k < 9000 ? statue : others);
    }
    EXPECT_GE(statue, 8800U) << turned;
    EXPECT_LE(others, 40U) << turned;
  }
}

TEST(FloorsAndWalls, WhatBelongsToAnObjectIsNotTakenForAFloor) {
  Scanner relief(3);  // a carved panel of a larger wall
  relief.sheet({-1.0, -1.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, 20000);
  for (int k = 0; k < 6000; ++k) {
    const Eigen::Vector2d at(0.6 * relief.unit() - 0.3, 0.6 * relief.unit() - 0.3);
    relief.points.emplace_back(at.x(), at.y(), 0.06 * std::exp(-20.0 * at.squaredNorm()) + relief.noise().z());
  }
  EXPECT_TRUE(around(relief.points).planes.empty());

  Scanner box(4);
  const Eigen::Vector3d x(0.5, 0.0, 0.0);
  const Eigen::Vector3d y(0.0, 0.3, 0.0);
  const Eigen::Vector3d z(0.0, 0.0, 0.4);
  const Eigen::Vector3d low(-0.25, 0.0, -0.2);
  for (const auto& [corner, a, b] :
       {std::tuple(low, x, y), {low, y, z}, {low, x, z}, {low + x, y, z}, {low + y, x, z}, {low + z, x, y}})
    box.sheet(corner, a, b, 4000);
  EXPECT_TRUE(around(box.points).planes.empty());

  Scanner standing(5);  // its flat base is scanned, and no floor
  standing.statue(1.0, 12000);
  standing.sheet({-0.13, 0.0, -0.13}, {0.26, 0.0, 0.0}, {0.0, 0.0, 0.26}, 2500);
  EXPECT_TRUE(around(standing.points).planes.empty());

  Scanner room(6);  // from within, with a table and shelves
  room.sheet({0.0, 0.0, 0.0}, {5.0, 0.0, 0.0}, {0.0, 0.0, 4.0}, 12000);
  room.sheet({0.0, 2.5, 0.0}, {5.0, 0.0, 0.0}, {0.0, 0.0, 4.0}, 12000);
  room.sheet({0.0, 0.0, 0.0}, {5.0, 0.0, 0.0}, {0.0, 2.5, 0.0}, 8000);
  room.sheet({0.0, 0.0, 0.0}, {0.0, 2.5, 0.0}, {0.0, 0.0, 4.0}, 7000);
  room.sheet({5.0, 0.0, 0.0}, {0.0, 2.5, 0.0}, {0.0, 0.0, 4.0}, 7000);
  room.sheet({0.1, 0.8, 0.1}, {4.8, 0.0, 0.0}, {0.0, 0.0, 3.8}, 3000);
  EXPECT_TRUE(around(room.points).planes.empty());

  EXPECT_TRUE(around({}).planes.empty());
  EXPECT_TRUE(around(Points(1000, Eigen::Vector3d::Ones())).planes.empty());
}

TEST(FloorsAndWalls, ANewConfigurationTakesThemAwayAndShowsTheStatue) {
  const test::TestFolder folder;
  std::string text;
  const Scanner scan = statue_in_a_room(7);
  for (const Eigen::Vector3d& p : scan.points) text += fmt::format("{:.5f} {:.5f} {:.5f}\n", p.x(), p.y(), p.z());
  write_file(folder / "room.xyz", text);
  Progress progress;
  const Suggestion suggestion = suggest_config({folder / "room.xyz"}, folder.path(), progress);
  EXPECT_NE(suggestion.yaml.find("remove_plane"), std::string::npos) << suggestion.yaml;
  EXPECT_NE(suggestion.yaml.find("#   with it: "), std::string::npos) << suggestion.yaml;
  // From a side of what stands, never from above or below.
  EXPECT_NEAR(suggestion.config.orientation.scan_to_grid(1, 1), 1.0, 0.05) << suggestion.yaml;
  const BuildResult built = build_scene(suggestion.config, {}, progress);
  const scene::Lattice& lattice = built.scene->description().levels.front();
  EXPECT_LT((lattice.nx - 1) * lattice.spacing_m, 0.6);
  EXPECT_NEAR((lattice.ny - 1) * lattice.spacing_m, 1.0, 0.08);
}

}  // namespace
}  // namespace sparsha::pipeline
