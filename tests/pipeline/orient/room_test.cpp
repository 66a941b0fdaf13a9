// Rooms that were scanned from inside, and solids that have floor, ceiling and sides as rooms have.
#include "pipeline/orient/room.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "pipeline/orient/front.h"
#include "pipeline/scan/reader.h"
#include "tests/support/turned_points.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

using test::angle_deg;
using test::kDegree;
using test::Points;
using test::turned;

// A room of 6 x 4.5 x 2.8 m as a scanner in it sees it: floor, ceiling, four walls of which one has a door, tables and
// chairs. z is up; the walls are turned by 20 degrees.
Points room(std::size_t count = 40'000) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit;
  std::normal_distribution<double> normal(0.0, 0.004);
  const Eigen::Vector3d size(6.0, 4.5, 2.8);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(20.0 * kDegree, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Points points;
  while (points.size() < count) {
    Eigen::Vector3d p(unit(random), unit(random), unit(random));
    const double kind = unit(random);
    const bool furniture = kind < 0.12;
    if (furniture) {  // two tables
      const double beside = unit(random) < 0.5 ? 1.2 : 3.6;
      const bool leg = unit(random) < 0.2;
      if (leg) p.head<2>() = p.head<2>().array().round();
      p = Eigen::Vector3d(beside + 1.4 * p.x(), 1.5 + 0.8 * p.y(), leg ? 0.74 * p.z() : 0.74);
    } else {
      // Sides by their areas: floor and ceiling 54, walls 58.8 square metres.
      const double side = unit(random);
      const int axis = side < 0.48 ? 2 : side < 0.78 ? 1 : 0;
      p[axis] = std::round(p[axis]);
      p = p.cwiseProduct(size);
      if (axis == 1 && p.y() == 0.0 && p.x() > 4.0 && p.x() < 5.0 && p.z() < 2.0) continue;
    }
    points.push_back(turn * p + Eigen::Vector3d(normal(random), normal(random), normal(random)));
  }
  return points;
}

// Turns by which z becomes y, x and -z.
std::vector<Eigen::Matrix3d> other_ups() {
  const auto turn = [](const Eigen::Vector3d& up) {
    return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), up).toRotationMatrix();
  };
  return {Eigen::Matrix3d::Identity(), turn(Eigen::Vector3d::UnitY()), turn(Eigen::Vector3d::UnitX()),
          Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix()};
}

TEST(Room, IsFromFloorToCeilingHoweverItWasTurnedAndWhateverTheFormat) {
  const Points points = room();
  std::vector<Eigen::Matrix3d> turns = other_ups();
  turns.emplace_back(Eigen::AngleAxisd(40.0 * kDegree, Eigen::Vector3d(1, 0.4, 0).normalized()).toRotationMatrix());
  for (const Eigen::Matrix3d& turn : turns) {
    const EvenPoints even = even_points(turned(points, turn));
    for (const bool z_up : {false, true}) {
      const std::optional<Standing> standing = standing_of(even, z_up);
      ASSERT_TRUE(standing);
      EXPECT_TRUE(standing->room) << standing->reason;
      EXPECT_LT(angle_deg(standing->up, turn * Eigen::Vector3d::UnitZ()), 2.0) << standing->reason;
    }
  }
}

TEST(Room, RealScanIsUprightHoweverItIsTurned) {
  const char* folder = std::getenv("SPARSHA_SCANS_DIR");
  if (folder == nullptr) GTEST_SKIP() << "SPARSHA_SCANS_DIR is not set: no real scans at hand";
  const Points points = read_scan(fs::path(folder) / "scans" / "room_scan1.pcd").points;
  for (const Eigen::Matrix3d& turn : other_ups()) {
    const std::optional<Standing> standing = standing_of(even_points(turned(points, turn)), false);
    ASSERT_TRUE(standing);
    EXPECT_LT(angle_deg(standing->up, turn * Eigen::Vector3d::UnitZ()), 3.0) << standing->reason;
  }
}

// A part of a solid: a ball or a block, stretched to half sides and turned.
struct Part {
  Eigen::Vector3d middle;
  Eigen::Vector3d half;
  bool block = false;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();

  [[nodiscard]] bool holds(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d d = (turn.transpose() * (p - middle)).cwiseQuotient(half);
    return block ? d.cwiseAbs().maxCoeff() < 1.0 : d.norm() < 1.0;
  }
};

Part ball(const Eigen::Vector3d& middle, const Eigen::Vector3d& half) { return {middle, half}; }
Part block(const Eigen::Vector3d& middle, const Eigen::Vector3d& half) { return {middle, half, true}; }
// A limb between two ends.
Part limb(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius) {
  Part part{0.5 * (from + to), {radius, radius, 0.55 * (to - from).norm()}};
  part.turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), to - from).toRotationMatrix();
  return part;
}

// Points of the surface that all parts have together, `density` to a square metre.
Points surface_of(const std::vector<Part>& parts, double density) {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::normal_distribution<double> normal;
  Points points;
  for (const Part& part : parts) {
    const Eigen::Vector3d& h = part.half;
    const double block_m2 = 8.0 * (h.x() * h.y() + h.y() * h.z() + h.z() * h.x());
    const auto count = static_cast<std::size_t>(density * block_m2 * (part.block ? 1.0 : 0.52));
    for (std::size_t i = 0; i < count; ++i) {
      Eigen::Vector3d p;
      if (part.block) {
        p = Eigen::Vector3d(unit(random), unit(random), unit(random));
        const double side = 0.5 * (unit(random) + 1.0) * block_m2 / 8.0;
        const int axis = side < h.x() * h.y() ? 2 : side < h.x() * h.y() + h.y() * h.z() ? 0 : 1;
        p[axis] = p[axis] < 0.0 ? -1.0 : 1.0;
      } else {
        p = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      }
      p = part.middle + part.turn * p.cwiseProduct(h);
      const bool hidden =
          std::any_of(parts.begin(), parts.end(), [&](const Part& other) { return &other != &part && other.holds(p); });
      if (!hidden) points.push_back(p + 0.003 * Eigen::Vector3d(normal(random), normal(random), normal(random)));
    }
  }
  return points;
}

struct Solid {
  std::string name;
  std::vector<Part> parts;
};

// z is up.
std::vector<Solid> solids() {
  std::vector<Part> horse = {block({0, 0, -0.1}, {1.2, 0.5, 0.1}), ball({0, 0, 1.1}, {0.9, 0.32, 0.36}),
                             limb({0.7, 0, 1.2}, {1.05, 0, 1.8}, 0.2), limb({1.0, 0, 1.8}, {1.45, 0, 1.55}, 0.15),
                             limb({-0.85, 0, 1.2}, {-1.15, 0, 0.6}, 0.08)};
  for (const double x : {-0.6, 0.6})
    for (const double y : {-0.2, 0.2}) horse.push_back(limb({x, y, 1.0}, {x, y, -0.05}, 0.11));
  std::vector<Part> column = {block({0, 0, 0.1}, {0.5, 0.5, 0.1}), block({0, 0, 3.1}, {0.5, 0.5, 0.1}),
                              limb({0, 0, 0.0}, {0, 0, 3.2}, 0.34)};
  std::vector<Part> relief = {block({0, 0, 1.0}, {0.9, 0.06, 1.0})};
  for (const double x : {-0.5, 0.0, 0.5}) {
    relief.push_back(ball({x, -0.06, 1.5}, {0.15, 0.1, 0.2}));
    relief.push_back(ball({x, -0.06, 0.8}, {0.2, 0.12, 0.55}));
  }
  const std::vector<Part> plaque = {block({0, 0, 0}, {1.0, 0.7, 0.03}), ball({-0.4, 0, 0.03}, {0.3, 0.4, 0.15}),
                                    ball({0.45, 0.1, 0.03}, {0.25, 0.3, 0.12})};
  const std::vector<Part> reclining = {block({0, 0, 0.12}, {1.5, 0.5, 0.12}),
                                       limb({-0.6, 0, 0.45}, {0.2, 0, 0.45}, 0.27),
                                       limb({-0.7, 0, 0.5}, {-0.85, 0, 1.1}, 0.25),
                                       ball({-0.95, 0, 1.35}, {0.17, 0.15, 0.2}),
                                       limb({0.2, -0.12, 0.4}, {0.8, -0.15, 0.75}, 0.14),
                                       limb({0.8, -0.15, 0.75}, {1.2, -0.15, 0.3}, 0.11),
                                       limb({0.2, 0.12, 0.4}, {1.35, 0.15, 0.3}, 0.14),
                                       limb({-0.8, -0.25, 0.95}, {-0.9, -0.3, 0.35}, 0.09)};
  const std::vector<Part> table = {
      block({0, 0, 0.72}, {0.8, 0.5, 0.03}),        block({-0.7, -0.4, 0.35}, {0.04, 0.04, 0.35}),
      block({0.7, -0.4, 0.35}, {0.04, 0.04, 0.35}), block({-0.7, 0.4, 0.35}, {0.04, 0.04, 0.35}),
      block({0.7, 0.4, 0.35}, {0.04, 0.04, 0.35}),  block({0, 0, 0.1}, {0.7, 0.4, 0.02})};
  return {{"a horse on a plinth", horse},
          {"a column", column},
          {"a relief that stands", relief},
          {"a relief that lies", plaque},
          {"a reclining figure", reclining},
          {"a table", table},
          {"a block", {block({0, 0, 0}, {0.5, 0.5, 0.5})}},
          {"a figure",
           {limb({0, 0, 0}, {0, 0, 1.2}, 0.3), ball({0, 0, 1.4}, {0.17, 0.17, 0.2}),
            block({0, 0, -0.1}, {0.5, 0.5, 0.1})}}};
}

// Mask: a face's front and its hollow back, 12 mm of wall on 0.3 m.
Points mask() {
  std::mt19937 random(29);
  std::normal_distribution<double> normal;
  Points points;
  while (points.size() < 60'000) {
    Eigen::Vector3d d = Eigen::Vector3d(normal(random), normal(random), std::abs(normal(random))).normalized();
    const bool eye = std::abs(std::abs(d.x()) - 0.35) < 0.1 && std::abs(d.y() - 0.2) < 0.06;
    const double wall = points.size() % 2 == 0 ? 1.0 : 0.94;
    if (!eye)
      points.push_back(wall * d.cwiseProduct(Eigen::Vector3d(0.75, 1.0, 0.7)) +
                       0.003 * Eigen::Vector3d(normal(random), normal(random), normal(random)));
  }
  return points;
}

TEST(Room, SolidsAreNoneHoweverTheyWereTurned) {
  std::vector<Eigen::Matrix3d> turns = other_ups();
  turns.emplace_back(Eigen::AngleAxisd(25.0 * kDegree, Eigen::Vector3d(0.3, 1, 0.2).normalized()).toRotationMatrix());
  std::vector<std::pair<std::string, Points>> clouds = {{"a mask", mask()}};
  for (const Solid& solid : solids())
    for (const double density : {2'000.0, 20'000.0}) clouds.emplace_back(solid.name, surface_of(solid.parts, density));
  for (const auto& [name, points] : clouds) {
    for (const Eigen::Matrix3d& turn : turns) {
      const Eigen::Vector3d up = turn * Eigen::Vector3d::UnitZ();
      EXPECT_FALSE(room_of(even_points(turned(points, turn)), {up})) << name << " of " << points.size() << " points";
    }
  }
}

// A figure on a block before the back wall of a box without its front wall, which looks to -y. z is up.
Points shrine(const Eigen::Vector3d& size) {
  const Eigen::Vector3d half = 0.5 * size;
  const double height = size.z();
  return surface_of(
      {block({0, 0, -0.04}, {half.x(), half.y(), 0.04}), block({0, 0, height + 0.04}, {half.x(), half.y(), 0.04}),
       block({-half.x() + 0.03, 0, half.z()}, {0.03, half.y(), half.z()}),
       block({half.x() - 0.03, 0, half.z()}, {0.03, half.y(), half.z()}),
       block({0, half.y() - 0.03, half.z()}, {half.x(), 0.03, half.z()}),
       block({0, 0.1, 0.1 * height}, {0.3, 0.2, 0.1 * height}),
       limb({0, 0.1, 0.2 * height}, {0, 0.1, 0.65 * height}, 0.14), ball({0, 0.1, 0.76 * height}, {0.1, 0.1, 0.13})},
      8'000.0);
}

// What of it a scanner before its open side may see.
Points inside_of(const Points& points, const Eigen::Vector3d& size) {
  Points inside;
  for (const Eigen::Vector3d& p : points) {
    const bool within = std::abs(p.x()) < 0.5 * size.x() - 0.03 && p.y() < 0.5 * size.y() - 0.03 &&
                        p.y() > -0.5 * size.y() + 0.01 && p.z() > -0.02 && p.z() < size.z() + 0.02;
    if (within) inside.push_back(p);
  }
  return inside;
}

TEST(Room, OfWhichOneSideIsOpenStandsOnItsFloorAndIsSeenFromThatSide) {
  const bool nightly = std::getenv("SPARSHA_NIGHTLY") != nullptr;
  const std::vector<Eigen::Matrix3d> turns = {
      other_ups()[1], Eigen::AngleAxisd(25.0 * kDegree, Eigen::Vector3d(0.3, 1, 0.2).normalized()).toRotationMatrix()};
  const std::vector<Eigen::Vector3d> sizes = {{1.2, 0.9, 1.8}, {2.0, 1.0, 1.5}, {1.0, 1.5, 1.5}};
  int upright = 0, seen = 0, said = 0, all = 0;
  for (const Eigen::Vector3d& size : sizes) {
    for (const bool from_inside : {false, true}) {
      const Points points = from_inside ? inside_of(shrine(size), size) : shrine(size);
      for (std::size_t t = 0; t < turns.size(); ++t) {
        if (!nightly && (t == 0) == from_inside) continue;
        const EvenPoints even = even_points(turned(points, turns[t]));
        const std::optional<Standing> standing = standing_of(even, false);
        ASSERT_TRUE(standing);
        const std::optional<FrontView> front = find_front(even, *standing);
        ASSERT_TRUE(front);
        upright += angle_deg(standing->up, turns[t] * Eigen::Vector3d::UnitZ()) < 5.0 ? 1 : 0;
        seen += angle_deg(front->look_from, turns[t] * -Eigen::Vector3d::UnitY()) < 10.0 ? 1 : 0;
        said += standing->open_side ? 1 : 0;
        ++all;
      }
    }
  }
  EXPECT_GE(upright, all - 1);
  EXPECT_GE(seen, all - 2);
  EXPECT_GE(said, all - 3);
}

}  // namespace
}  // namespace sparsha::pipeline
