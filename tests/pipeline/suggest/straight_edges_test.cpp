// A slab stands on one of its edges, and what has no four edges is left as it is.
#include "pipeline/suggest/straight_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

using Points = std::vector<Eigen::Vector3d>;
constexpr double kDegree = std::numbers::pi / 180.0;

/// Points of a shape in the square from -1 to 1, half as high as wide, turned within its plane and then in space.
Points turned(const std::function<bool(double, double)>& inside, double turn_deg, const Eigen::Quaterniond& lying,
              int strays = 0) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Eigen::Matrix3d motion =
      (lying * Eigen::AngleAxisd(turn_deg * kDegree, Eigen::Vector3d::UnitZ())).toRotationMatrix();
  Points points;
  while (points.size() < 30'000) {
    const double x = unit(random), y = unit(random);
    if (inside(x, y)) points.push_back(motion * Eigen::Vector3d(x, 0.5 * y, 0.01 * std::sin(9.0 * x)));
  }
  for (int k = 0; k < strays; ++k) points.push_back(3.0 * Eigen::Vector3d(unit(random), unit(random), unit(random)));
  return points;
}

bool rectangle(double, double) { return true; }

TEST(StraightEdges, TurnASlabOntoTheNearerOfThem) {
  for (const double lying_deg : {0.0, 37.0, 115.0}) {
    const Eigen::Quaterniond lying(Eigen::AngleAxisd(lying_deg * kDegree, Eigen::Vector3d(1.0, 0.4, 0.2).normalized()));
    for (const double turn_deg : {-30.0, -3.0, 2.0, 12.5, 44.0, 60.0}) {
      const auto up = up_along_edges(turned(rectangle, turn_deg, lying, 20), lying * Eigen::Vector3d::UnitZ(),
                                     lying * Eigen::Vector3d::UnitY());
      ASSERT_TRUE(up) << turn_deg;
      const double nearer_deg = turn_deg > 45.0 ? turn_deg - 90.0 : turn_deg;
      const Eigen::Vector3d wanted =
          lying * (Eigen::AngleAxisd(nearer_deg * kDegree, Eigen::Vector3d::UnitZ()) * Eigen::Vector3d::UnitY());
      EXPECT_LT(std::acos(std::min(1.0, up->dot(wanted))) / kDegree, 0.2) << turn_deg << " lying " << lying_deg;
    }
  }
}

TEST(StraightEdges, AreNotSeenWhereThereAreNone) {
  const auto found = [](const std::function<bool(double, double)>& inside, double turn_deg) {
    return up_along_edges(turned(inside, turn_deg, Eigen::Quaterniond::Identity()), Eigen::Vector3d::UnitZ(),
                          Eigen::Vector3d::UnitY())
        .has_value();
  };
  EXPECT_FALSE(found(rectangle, 0.0)) << "it stands straight";
  EXPECT_FALSE(found([](double x, double y) { return x * x + y * y < 1.0; }, 20.0)) << "an ellipse";
  EXPECT_FALSE(found([](double x, double y) { return x < 0.0 || y < 0.0; }, 20.0)) << "an L";
  EXPECT_FALSE(found([](double x, double y) { return std::abs(x) < 1.0 - 0.5 * (y + 1.0); }, 20.0)) << "a gable";
  EXPECT_TRUE(found([](double x, double y) { return x * x + y * y > 0.04; }, 20.0)) << "a slab with a hole";
}

TEST(StraightEdges, FewPointsAndNoDirectionsAreNothing) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ(), y = Eigen::Vector3d::UnitY();
  EXPECT_FALSE(up_along_edges({}, z, y));
  EXPECT_FALSE(up_along_edges(Points(5, Eigen::Vector3d::Zero()), z, y));
  EXPECT_FALSE(up_along_edges(Points(5000, Eigen::Vector3d::Zero()), z, y)) << "all in one place";
  EXPECT_FALSE(up_along_edges(turned(rectangle, 20.0, Eigen::Quaterniond::Identity()), z, z)) << "up along the view";
}

}  // namespace
}  // namespace sparsha::pipeline
