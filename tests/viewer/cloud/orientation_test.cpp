// Rotations by hand: their inverses, their axes, and the angles of a configuration.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

#include "base/yaml/yaml.h"
#include "scene/config/config.h"
#include "viewer/cloud/orientation.h"

namespace sparsha::viewer::test {
namespace {

constexpr double kTurn = std::numbers::pi / 36.0;
const double kRounding = 1e-12;

Eigen::Matrix4d random_orientation(std::mt19937& random, double scale) {
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = scale * q.normalized().toRotationMatrix();
  return m;
}

TEST(CloudOrientation, TiltGoesAllTheWayRound) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  for (int k = 0; k < 72; ++k) m = turned(m, true, 0.0, kTurn);
  EXPECT_TRUE(m.isIdentity(kRounding));
  for (int k = 0; k < 18; ++k) m = turned(m, true, 0.0, kTurn);
  const Eigen::Matrix3d quarter =
      Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Eigen::Matrix3d linear = m.topLeftCorner<3, 3>();
  EXPECT_TRUE(linear.isApprox(quarter, kRounding));
}

TEST(CloudOrientation, TheTurntableTurnsAboutTheObjectsOwnAxis) {
  std::mt19937 random(5);
  for (int k = 0; k < 1000; ++k) {
    const Eigen::Matrix4d m = random_orientation(random, 2.5);
    for (const bool z_up : {true, false}) {
      const Eigen::Matrix4d next = turned(m, z_up, 0.3, 0.0);
      const Eigen::Vector4d axis = z_up ? Eigen::Vector4d::UnitZ() : Eigen::Vector4d::UnitY();
      EXPECT_TRUE((next * axis).isApprox(m * axis, kRounding));
      EXPECT_NEAR(scale_of(next), 2.5, kRounding * 10.0);
    }
  }
}

TEST(CloudOrientation, FacesShowTheSideThatTheyName) {
  const Eigen::Matrix4d one = Eigen::Matrix4d::Identity();
  const auto to_viewer = [&](Face face, bool z_up, const Eigen::Vector3d& side, const Eigen::Vector3d& up) {
    const Eigen::Matrix3d r = seen_from(face, z_up, one).topLeftCorner<3, 3>();
    EXPECT_TRUE((r * side).isApprox(Eigen::Vector3d::UnitZ(), kRounding)) << name_of(face) << z_up;
    EXPECT_TRUE((r * up).isApprox(Eigen::Vector3d::UnitY(), kRounding)) << name_of(face) << z_up;
  };
  const Eigen::Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  to_viewer(Face::front, true, -y, z);
  to_viewer(Face::back, true, y, z);
  to_viewer(Face::right, true, x, z);
  to_viewer(Face::left, true, -x, z);
  to_viewer(Face::top, true, z, y);
  to_viewer(Face::bottom, true, -z, -y);
  to_viewer(Face::front, false, z, y);
  to_viewer(Face::back, false, -z, y);
  to_viewer(Face::right, false, x, y);
  to_viewer(Face::left, false, -x, y);
  to_viewer(Face::top, false, y, -z);
  to_viewer(Face::bottom, false, -y, z);
}

TEST(CloudOrientation, UprightRollsAndNothingElse) {
  std::mt19937 random(6);
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Matrix4d m = random_orientation(random, 1.0);
    const Eigen::Matrix3d before = m.topLeftCorner<3, 3>();
    for (const bool z_up : {true, false}) {
      const Eigen::Matrix3d after = upright(m, z_up).topLeftCorner<3, 3>();
      EXPECT_TRUE(after.row(2).isApprox(before.row(2), kRounding)) << "the view stays";
      const Eigen::Vector3d up = after.col(z_up ? 2 : 1);
      if (up.head<2>().norm() < 0.1) continue;
      EXPECT_NEAR(up.x(), 0.0, kRounding);
      EXPECT_GT(up.y(), 0.0);
    }
  }
  // Along the axis itself, the nearest of the others is put upright.
  const Eigen::Matrix4d top = rolled(Eigen::Matrix4d::Identity(), 0.0, 0.0, 0.2);
  EXPECT_TRUE(upright(top, true).isIdentity(kRounding));
}

TEST(CloudOrientation, AnglesAreThoseOfAConfiguration) {
  std::mt19937 random(7);
  for (int k = 0; k < 2000; ++k) {
    const double scale = k % 2 == 0 ? 1.0 : 12.0;
    const Eigen::Matrix4d m = random_orientation(random, scale);
    const Eigen::Vector3d angles = euler_deg(m);
    EXPECT_TRUE(with_euler(angles, m).isApprox(m, 1e-11));
    if (k >= 20) continue;
    char text[300];
    std::snprintf(text, sizeof text,
                  "scans: [{file: a.ply}]\norientation: {euler_deg: [%.17g, %.17g, %.17g], scale: %.17g}\n", angles.x(),
                  angles.y(), angles.z(), scale);
    const scene::Config config = scene::parse_config(yaml::parse_text(text, "test"), {});
    EXPECT_TRUE(config.orientation.scan_to_grid.isApprox(m, 1e-11)) << text;
  }
  for (const double y : {90.0, -90.0}) {
    const Eigen::Matrix4d locked = with_euler({20.0, y, 50.0}, Eigen::Matrix4d::Identity());
    EXPECT_TRUE(with_euler(euler_deg(locked), locked).isApprox(locked, 1e-9));
  }
}

}  // namespace
}  // namespace sparsha::viewer::test
