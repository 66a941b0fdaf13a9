// Axes and mantles of columns, cones and vases whose truth is known, and of things that have none.
#include "pipeline/orient/mantle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

#include "base/error.h"

namespace sparsha::pipeline {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;
using Shape = scene::UnrollConfig::Shape;
constexpr double kPi = std::numbers::pi;
const Vector3d kCentre_m(12.0, -3.0, 0.5);

/// A surface of revolution with noise; `radius` of height and angle.
Points turned_on_a_lathe(const Vector3d& axis, double height_m, double way,
                         const std::function<double(double, double)>& radius, double noise_m) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, noise_m);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis);
  Points points;
  for (int k = 0; k < 12000; ++k) {
    const double h = height_m * (unit(random) - 0.5), a = 2 * kPi * way * unit(random);
    const double r = radius(h, a) + noise(random);
    points.push_back(kCentre_m + turn * Vector3d(r * std::cos(a), r * std::sin(a), h));
  }
  return points;
}

double angle_deg(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), std::abs(a.dot(b))) * 180.0 / kPi;
}

double off_axis_m(const scene::UnrollConfig& found, const Vector3d& axis) {
  const Vector3d apart = *found.centre_m - kCentre_m;
  return (apart - apart.dot(axis.normalized()) * axis.normalized()).norm();
}

TEST(Mantle, FindsColumnsWhereverTheyPoint) {
  for (const Vector3d& axis :
       {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(0.4, -0.7, 0.5), Vector3d(0.1, 1.0, 0.02)}) {
    for (const double height_m : {axis.x() < 0.3 ? 0.5 : 3.0}) {
      const Points points = turned_on_a_lathe(
          axis, height_m, 1.0, [](double, double) { return 0.3; }, 0.001);
      const FoundMantle found = find_mantle(points, {}, Vector3d::UnitY());
      EXPECT_EQ(found.unroll.shape, Shape::cylinder);
      EXPECT_LT(angle_deg(*found.unroll.axis, axis), 0.02);
      EXPECT_LT(off_axis_m(found.unroll, axis), 1e-4);
      EXPECT_NEAR(*found.unroll.radius_m, 0.3, 1e-4);
    }
  }
}

TEST(Mantle, FindsConesOfBothWays) {
  for (const double slope_deg : {8.0, -15.0, 30.0}) {
    const Vector3d axis(0.2, 0.1, 1.0);
    const double grows = std::tan(slope_deg * kPi / 180.0);
    const FoundMantle found =
        find_mantle(turned_on_a_lathe(
                        axis, 0.6, 1.0, [&](double h, double) { return 0.4 + grows * h; }, 0.0005),
                    {}, Vector3d::UnitZ());
    EXPECT_EQ(found.unroll.shape, Shape::cone);
    EXPECT_NEAR(*found.unroll.slope_rad * 180.0 / kPi, slope_deg, 0.05);
    EXPECT_LT(angle_deg(*found.unroll.axis, axis), 0.03);
    EXPECT_NEAR(*found.unroll.radius_m, 0.4, 1e-3);
  }
}

TEST(Mantle, FindsVasesFlutesAndTheHalfOfAColumn) {
  const Vector3d axis(0, 0, 1);
  const auto vase = [](double h, double) { return 0.2 + 0.06 * std::cos(9.0 * h); };
  const auto fluted = [](double, double a) { return 0.4 - 0.02 * std::abs(std::sin(10.0 * a)); };
  EXPECT_LT(angle_deg(*find_mantle(turned_on_a_lathe(axis, 0.9, 1.0, vase, 0.0005), {}, axis).unroll.axis, axis), 0.1);
  EXPECT_LT(angle_deg(*find_mantle(turned_on_a_lathe(axis, 3.0, 1.0, fluted, 0.0005), {}, axis).unroll.axis, axis),
            0.1);
  const FoundMantle half = find_mantle(turned_on_a_lathe(
                                           axis, 2.0, 0.5, [](double, double) { return 0.3; }, 0.0005),
                                       {}, axis);
  EXPECT_LT(angle_deg(*half.unroll.axis, axis), 0.1);
  EXPECT_LT(off_axis_m(half.unroll, axis), 5e-4);
}

TEST(Mantle, DependsOnNoOrderAndUpTellsTheEnd) {
  Points points = turned_on_a_lathe(
      {0, 0, 1}, 2.0, 1.0, [](double, double) { return 0.3; }, 0.001);
  const FoundMantle found = find_mantle(points, {}, Vector3d::UnitZ());
  std::shuffle(points.begin(), points.end(), std::mt19937_64(2));
  const FoundMantle again = find_mantle(points, {}, Vector3d::UnitZ());
  EXPECT_EQ(*found.unroll.axis, *again.unroll.axis);
  EXPECT_EQ(*found.unroll.centre_m, *again.unroll.centre_m);
  EXPECT_EQ(*found.unroll.radius_m, *again.unroll.radius_m);
  EXPECT_GT(found.unroll.axis->z(), 0.9);
  EXPECT_LT(find_mantle(points, {}, -Vector3d::UnitZ()).unroll.axis->z(), -0.9);
}

TEST(Mantle, AnAxisThatIsGivenStays) {
  scene::UnrollConfig wanted;
  wanted.axis = Vector3d(0, 0, -3);
  const FoundMantle found = find_mantle(turned_on_a_lathe(
                                            {0, 0, 1}, 2.0, 1.0, [](double, double) { return 0.3; }, 0.001),
                                        wanted, Vector3d::UnitY());
  EXPECT_EQ(*found.unroll.axis, Vector3d(0, 0, -1));
  EXPECT_LT(off_axis_m(found.unroll, {0, 0, 1}), 1e-4);
}

TEST(Mantle, RefusesWhatHasNoAxis) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::normal_distribution<double> normal;
  Points ball, cube, plane;
  for (int k = 0; k < 6000; ++k) {
    ball.push_back(Vector3d(normal(random), normal(random), normal(random)).normalized());
    Vector3d p(unit(random), unit(random), unit(random));
    plane.emplace_back(p.x(), p.y(), 0.01 * p.z());
    p[k % 3] = k / 3 % 2 == 0 ? 1.0 : -1.0;
    cube.push_back(p);
  }
  for (const Points& points : {ball, cube, plane})
    EXPECT_THROW((void)find_mantle(points, {}, Vector3d::UnitZ()), Error);
  const Points sliver = turned_on_a_lathe(
      {0, 0, 1}, 2.0, 0.1, [](double, double) { return 0.3; }, 0.0005);
  EXPECT_THROW((void)find_mantle(sliver, {}, Vector3d::UnitZ()), Error);
}

}  // namespace
}  // namespace sparsha::pipeline
