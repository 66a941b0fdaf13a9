// Planes of symmetry of made things.
#include "pipeline/orient/mirror.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

// A wedge with a ridge: alike on both sides of x = 0.3 and of no other plane. `push` moves one side of it.
std::vector<Eigen::Vector3d> wedge(double push) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<Eigen::Vector3d> points;
  while (points.size() < 30'000) {
    const double x = unit(random);
    const double y = 1.5 * unit(random);
    const double side = points.size() % 2 == 0 ? 1.0 : -1.0;
    const double z = side * (1.1 - std::abs(x)) * (0.3 + 0.2 * y) + 0.4 * y * y + (x > 0.5 ? push : 0.0);
    points.emplace_back(x + 0.3, y, z);
  }
  return points;
}

TEST(MirrorPlanes, AreThoseOfTheObjectHoweverItIsTurned) {
  const Eigen::Matrix3d any = Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -0.8, 0.5).normalized()).toRotationMatrix();
  for (const Eigen::Matrix3d& turn : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), any}) {
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3d& p : wedge(0.0)) points.emplace_back(turn * p);
    const std::vector<MirrorPlane> planes = mirror_planes(even_points(points), 2);
    ASSERT_FALSE(planes.empty());
    // Cells of 2 pixels, of 150 along the diagonal.
    EXPECT_GT(std::abs(planes[0].normal.dot(turn * Eigen::Vector3d::UnitX())), std::cos(0.04));
    EXPECT_GT(planes[0].alike, 0.9);
    if (planes.size() > 1) {
      EXPECT_LT(planes[1].alike, planes[0].alike - 0.1);
    }
  }
}

TEST(MirrorPlanes, OfWhatIsNotLikeItsMirrorImageAreLessAlike) {
  const double alike = mirror_planes(even_points(wedge(0.0)), 1).at(0).alike;
  EXPECT_LT(mirror_planes(even_points(wedge(0.8)), 1).at(0).alike, alike - 0.05);
}

TEST(MirrorPlanes, OfNothingThereAreNone) { EXPECT_TRUE(mirror_planes({}, 3).empty()); }

}  // namespace
}  // namespace sparsha::pipeline
