// Faces of things that were turned by known rotations.
#include "pipeline/orient/face.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/error.h"

namespace sparsha::pipeline {
namespace {

using Face = scene::OrientationConfig::Face;
using Points = std::vector<Eigen::Vector3d>;

constexpr double kDegree = std::numbers::pi / 180.0;

// The surface of a slab of 60 x 100 x 20 mm, its broad faces at z = +-10 mm, all faces as dense.
Points slab(std::mt19937& random, double noise_m = 0.0002, std::size_t count = 12000) {
  const Eigen::Vector3d half(0.03, 0.05, 0.01);
  const Eigen::Vector3d area(half.y() * half.z(), half.x() * half.z(), half.x() * half.y());
  std::discrete_distribution<int> axis({area.x(), area.y(), area.z()});
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::normal_distribution<double> noise;
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3d p(unit(random), unit(random), unit(random));
    const int a = axis(random);
    p[a] = p[a] < 0.0 ? -1.0 : 1.0;
    points.push_back(p.cwiseProduct(half) + noise_m * Eigen::Vector3d(noise(random), noise(random), noise(random)));
  }
  return points;
}

Points ball(std::mt19937& random, std::size_t count = 12000) {
  std::normal_distribution<double> normal;
  Points points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(0.05 * Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
  return points;
}

Points moved(const Points& points, const Eigen::Isometry3d& by) {
  Points out;
  for (const Eigen::Vector3d& p : points) out.emplace_back(by * p);
  return out;
}

Eigen::Matrix3d random_turn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized().matrix();
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) / kDegree;
}

Eigen::Vector3d towards(const FoundFace& found) { return found.scan_to_grid.row(2).head<3>(); }
Eigen::Vector3d upward(const FoundFace& found) { return found.scan_to_grid.row(1).head<3>(); }

void expect_rotation(const FoundFace& found, double scale) {
  const Eigen::Matrix3d turn = found.scan_to_grid.topLeftCorner<3, 3>() / scale;
  EXPECT_LT((turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_GT(turn.determinant(), 0.0);
  EXPECT_EQ(found.scan_to_grid.col(3), Eigen::Vector4d(0, 0, 0, 1));
}

TEST(Face, TheBroadFaceOfATurnedSlabIsFoundWithinATenthOfADegreeFromAnyDirection) {
  std::mt19937 random(3);
  for (const Face face : {Face::plane, Face::automatic}) {
    for (int turn = 0; turn < 10; ++turn) {
      const Eigen::Matrix3d rotation = random_turn(random);
      Eigen::Isometry3d by(rotation);
      by.pretranslate(Eigen::Vector3d(4.0, -3.0, 2.0));
      const FoundFace found = find_face(FacePoints{moved(slab(random), by)}, face, std::nullopt, 1.0);
      expect_rotation(found, 1.0);
      const double angle = angle_between(towards(found), rotation.col(2));
      EXPECT_LT(std::min(angle, 180.0 - angle), 0.1) << found.reason;
      // Upright: one of the slab's own edges, the one nearest to the customary direction.
      const double wide = std::abs(upward(found).dot(rotation.col(0)));
      const double tall = std::abs(upward(found).dot(rotation.col(1)));
      EXPECT_GT(std::max(wide, tall), 0.999) << found.reason;
      const Eigen::Vector3d custom = customary_up(towards(found), false);
      EXPECT_GE(std::abs(upward(found).dot(custom)),
                std::min(std::abs(rotation.col(0).dot(custom)), std::abs(rotation.col(1).dot(custom))));
      EXPECT_GE(upward(found).dot(custom), 0.0);
    }
  }
}

TEST(Face, AStationOrWhatHidesItTellsTheSide) {
  std::mt19937 random(4);
  // A face with a lump behind it, as a relief's wall: seen from where nothing hides it.
  std::uniform_real_distribution<double> place(-0.05, 0.05);
  Points wall;
  for (int i = 0; i < 8000; ++i) wall.emplace_back(place(random), place(random), 0.0);
  for (const Eigen::Vector3d& p : ball(random, 6000)) wall.push_back(0.6 * p + Eigen::Vector3d(0, 0, -0.04));
  for (const double side : {1.0, -1.0}) {
    Eigen::Isometry3d by = Eigen::Isometry3d::Identity();
    if (side < 0.0) by = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitY());
    const FoundFace found = find_face(FacePoints{moved(wall, by)}, Face::plane, std::nullopt, 1.0);
    EXPECT_LT(angle_between(towards(found), {0, 0, side}), 1.0) << found.reason;
    Station station{"scan", true, Eigen::Vector3d(0.1, 0.2, -2.0 * side), moved(wall, by), {}};
    const FoundFace seen = find_face(FacePoints{moved(wall, by), {station}}, Face::plane, std::nullopt, 1.0);
    EXPECT_LT(angle_between(towards(seen), {0, 0, -side}), 1.0) << seen.reason;
  }
}

TEST(Face, NoiseAndFarPointsDoNotTurnIt) {
  std::mt19937 random(5);
  Points points = slab(random, 0.001);
  std::uniform_real_distribution<double> place(-5.0, 5.0);
  for (int i = 0; i < 100; ++i) points.emplace_back(place(random), place(random), place(random));
  const FoundFace found = find_face(FacePoints{points}, Face::plane, std::nullopt, 1.0);
  const double angle = angle_between(towards(found), Eigen::Vector3d::UnitZ());
  EXPECT_LT(std::min(angle, 180.0 - angle), 1.0) << found.reason;
}

TEST(Face, FarFromItsOriginItIsTheSameFace) {
  std::mt19937 random(6);
  const Eigen::Matrix3d rotation = random_turn(random);
  Eigen::Isometry3d by(rotation);
  const Points near = moved(slab(random), by);
  by = Eigen::Isometry3d(Eigen::Translation3d(512345.0, 4987654.0, 321.0));
  const FoundFace a = find_face(FacePoints{near}, Face::plane, Eigen::Vector3d::UnitX(), 1.0);
  const FoundFace b = find_face(FacePoints{moved(near, by)}, Face::plane, Eigen::Vector3d::UnitX(), 1.0);
  const double angle = angle_between(towards(a), towards(b));
  EXPECT_LT(std::min(angle, 180.0 - angle), 0.01);
}

TEST(Face, TheOrderOfThePointsDoesNotMatter) {
  std::mt19937 random(7);
  Points points = moved(slab(random), Eigen::Isometry3d(random_turn(random)));
  const FoundFace first = find_face(FacePoints{points}, Face::plane, std::nullopt, 1.0);
  std::shuffle(points.begin(), points.end(), random);
  EXPECT_EQ(find_face(FacePoints{points}, Face::plane, std::nullopt, 1.0).scan_to_grid, first.scan_to_grid);
}

TEST(Face, ABallHasNoFlatFaceAndIsToldSo) {
  std::mt19937 random(8);
  try {
    (void)find_face(FacePoints{ball(random)}, Face::plane, std::nullopt, 1.0);
    FAIL() << "a plane in a ball";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("the largest plane holds"), std::string::npos) << error.what();
  }
}

TEST(Face, WithoutAFlatFaceAutoTakesTheBroadSide) {
  std::mt19937 random(9);
  Points egg = ball(random);
  for (Eigen::Vector3d& p : egg) p = p.cwiseProduct(Eigen::Vector3d(1.0, 1.6, 0.6));
  const Eigen::Matrix3d rotation = random_turn(random);
  const Points turned = moved(egg, Eigen::Isometry3d(rotation));
  for (const Face face : {Face::automatic, Face::principal}) {
    const FoundFace found = find_face(FacePoints{turned}, face, rotation.col(1), 2.0);
    expect_rotation(found, 2.0);
    const double angle = angle_between(towards(found), rotation.col(2));
    EXPECT_LT(std::min(angle, 180.0 - angle), 2.0) << found.reason;
    EXPECT_LT(angle_between(upward(found), rotation.col(1)), 2.0);
  }
}

TEST(Face, ASquareFaceStandsAsUpSaysAndNotOnItsCorner) {
  std::mt19937 random(10);
  std::uniform_real_distribution<double> place(-0.05, 0.05);
  Points square;
  for (int i = 0; i < 8000; ++i) square.emplace_back(place(random), place(random), 0.0);
  const FoundFace found = find_face(FacePoints{square}, Face::plane, std::nullopt, 1.0);
  EXPECT_LT(angle_between(upward(found), Eigen::Vector3d::UnitY()), 0.5);
  FacePoints lying{moved(square, Eigen::Isometry3d(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX())))};
  lying.z_up = true;
  EXPECT_LT(angle_between(upward(find_face(lying, Face::plane, std::nullopt, 1.0)), Eigen::Vector3d::UnitZ()), 0.5);
}

TEST(Face, UpAlongTheViewAndPointsWithoutExtentAreErrors) {
  std::mt19937 random(11);
  EXPECT_THROW((void)find_face(FacePoints{slab(random, 0.0)}, Face::plane, Eigen::Vector3d::UnitZ(), 1.0), Error);
  EXPECT_THROW((void)find_face(FacePoints{Points(100, Eigen::Vector3d(1, 2, 3))}, Face::automatic, std::nullopt, 1.0),
               Error);
  EXPECT_THROW((void)find_face(FacePoints{}, Face::principal, std::nullopt, 1.0), Error);
  Points line;
  for (int i = 0; i < 500; ++i) line.emplace_back(0.001 * i, 0.0, 0.0);
  EXPECT_NO_THROW((void)find_face(FacePoints{line}, Face::principal, std::nullopt, 1.0))
      << "any view across it will do";
}

}  // namespace
}  // namespace sparsha::pipeline
