// The delta's geometry against golden values, finite differences and virtual work.
#include "haptics/device/falcon/kinematics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include <Eigen/Geometry>

#include "haptics/device/falcon/falcon.h"
#include "haptics/governor/look_meter.h"

namespace {

using namespace sparsha::haptics::falcon;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
/// Golden values are given to 0.00001 mm and 0.00001 degrees.
constexpr double kHalfDigit_m = 0.6e-8, kHalfDigit_deg = 0.6e-5;

TEST(FalconKinematics, ForwardGivesTheGoldenPositionsOfCounts) {
  const struct {
    Counts counts;
    Vector3d position_mm;
  } golden[] = {
      {{0, 0, 0}, {0, 0, 134.60243}},
      {{500, 500, 500}, {0, 0, 156.86047}},
      {{-500, -500, -500}, {0, 0, 110.75450}},
      {{1000, 1000, 1000}, {0, 0, 173.60325}},
      {{-800, -800, -800}, {0, 0, 97.50572}},
      {{300, 0, -300}, {-4.11766, -21.65349, 132.31603}},
      {{-250, 100, 50}, {-5.68761, 12.17320, 132.15669}},
      {{1447, 0, 0}, {21.97878, -73.52398, 128.14347}},
  };
  for (const auto& [counts, position_mm] : golden) {
    const auto position = forward(angles_from_counts(counts), kNeutral_m);
    ASSERT_TRUE(position) << position_mm.transpose();
    EXPECT_LT((*position - 1e-3 * position_mm).cwiseAbs().maxCoeff(), kHalfDigit_m) << position_mm.transpose();
  }
  // Thigh and shin are in line at 97.9 degrees (1727 counts): beyond, no pose has these angles.
  EXPECT_TRUE(forward(angles_from_counts({1700, 1700, 1700}), kNeutral_m));
  EXPECT_FALSE(forward(angles_from_counts({1750, 1750, 1750}), kNeutral_m));
}

TEST(FalconKinematics, SlowHandsAreNotTakenForADeviceThatRepeats) {
  const double step_m = falcon_info({}).limits.encoder_step_m;
  std::mt19937 random(3);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int circles = 0;
  while (circles < 200) {
    const Vector3d centre(between(-0.04, 0.04), between(-0.04, 0.04), between(0.1, 0.175));
    const double radius_m = between(0.003, 0.008), speed_m_per_s = between(0.006, 0.025);
    const Vector3d u = Vector3d(between(-1, 1), between(-1, 1), between(-1, 1)).normalized();
    const Vector3d v = u.cross(Vector3d(between(-1, 1), between(-1, 1), between(-1, 1))).normalized();
    sparsha::haptics::LookMeter meter(step_m);
    Vector3d seen_m = centre;
    bool reached = true;
    for (int tick = 0; tick < 2850 && reached; ++tick) {
      const double angle = speed_m_per_s / radius_m * tick / 950.0;
      const auto angles = inverse(centre + radius_m * (std::cos(angle) * u + std::sin(angle) * v));
      const auto found = angles ? forward(angles_from_counts(counts_from_angles(*angles)), seen_m) : std::nullopt;
      reached = found.has_value();
      if (!reached) break;
      seen_m = *found;
      ASSERT_FALSE(meter.repeats(seen_m, 1.0 / 950.0)) << centre.transpose() << ", " << speed_m_per_s << ", " << tick;
    }
    circles += reached ? 1 : 0;
  }
}

TEST(FalconKinematics, InverseGivesTheGoldenAnglesOfPositions) {
  const struct {
    Vector3d position_m, degrees;
  } golden[] = {
      {{0, 0, 0.11}, {16.18796, 16.18796, 16.18796}},     {{0.03, 0, 0.11}, {26.68847, -1.21729, 33.96612}},
      {{0, 0.03, 0.12}, {8.37036, 32.57685, 41.02729}},   {{0.03, 0.03, 0.13}, {27.45513, 26.05263, 60.28081}},
      {{-0.05, 0, 0.12}, {26.99312, 60.23775, 12.13494}},
  };
  for (const auto& [position_m, degrees] : golden) {
    const auto angles = inverse(position_m);
    ASSERT_TRUE(angles);
    EXPECT_LT((*angles / kDegree - degrees).cwiseAbs().maxCoeff(), kHalfDigit_deg) << position_m.transpose();
  }
}

TEST(FalconKinematics, JacobianAndTorquesAreTheGoldenOnes) {
  Matrix3d golden;
  golden << 3.20162, -10.6993, 13.2812, -10.8666, 2.57695, 13.2812, 7.66503, 8.12232, 13.2812;
  const Vector3d at(0, 0, 0.12);
  EXPECT_LT((*jacobian(at) - golden).cwiseAbs().maxCoeff(), 0.6e-4);
  EXPECT_LT((*torques(at, {1, 0, 0}) - Vector3d(0.0171, -0.0581, 0.0410)).cwiseAbs().maxCoeff(), 0.6e-4);
  EXPECT_LT((*torques(at, {0, 0, 1}) - Vector3d::Constant(0.0251)).cwiseAbs().maxCoeff(), 0.6e-4);
}

/// Seeded poses of a sphere in the middle of the workspace.
std::vector<Vector3d> poses(std::size_t count, double radius) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<Vector3d> result;
  while (result.size() < count) {
    const Vector3d p(unit(random), unit(random), unit(random));
    if (p.norm() < 1.0) result.push_back(Vector3d(0, 0, 0.14) + radius * p);
  }
  return result;
}

TEST(FalconKinematics, JacobianIsTheDerivativeOfTheInverse) {
  const double h = 1e-6;  // central differences: error about h^2 times the third derivative, 1e-12 * 1e5
  for (const Vector3d& p : poses(2000, 0.035)) {
    const Matrix3d rates = *jacobian(p);
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = h * Vector3d::Unit(axis);
      const Vector3d slope = (*inverse(p + step) - *inverse(p - step)) / (2.0 * h);
      EXPECT_LT((rates.col(axis) - slope).cwiseAbs().maxCoeff(), 1e-6 * rates.cwiseAbs().maxCoeff()) << p.transpose();
    }
  }
}

TEST(FalconKinematics, ForwardUndoesInverseEverywhereFromAColdAndAWarmStart) {
  for (const Vector3d& p : poses(20000, 0.038)) {
    const auto angles = inverse(p);
    ASSERT_TRUE(angles) << p.transpose();
    const auto cold = forward(*angles, kNeutral_m);
    ASSERT_TRUE(cold) << p.transpose();
    // 1e-9 rad of arm moves the grip by at most 1e-9 / 1 rad/m.
    EXPECT_LT((*cold - p).norm(), 1e-9) << p.transpose();
    EXPECT_LT((*forward(*angles, p + Vector3d(1e-4, -1e-4, 1e-4)) - p).norm(), 1e-9);
  }
}

TEST(FalconKinematics, TorquesDoTheWorkOfTheForce) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const Vector3d& p : poses(2000, 0.035)) {
    const Vector3d force(normal(random), normal(random), normal(random)),
        move(normal(random), normal(random), normal(random));
    const Vector3d torque = *torques(p, force);
    const Vector3d turn = *inverse(p + 1e-7 * move) - *inverse(p - 1e-7 * move);
    EXPECT_NEAR(torque.dot(turn), force.dot(2e-7 * move), 1e-6 * 2e-7 * force.norm() * move.norm()) << p.transpose();
  }
}

TEST(FalconKinematics, CountsAndAnglesRoundTrip) {
  for (int count = -2000; count <= 2000; count += 7)
    EXPECT_EQ(counts_from_angles(angles_from_counts({count, -count, 0})), (Counts{count, -count, 0}));
  EXPECT_NEAR((angles_from_counts({1, 0, 0})[0] - angles_from_counts({0, 0, 0})[0]) / kDegree, 0.036434659, 1e-9);
}

TEST(FalconKinematics, OutOfReachAndNotANumberGiveNothing) {
  for (const Vector3d& p :
       {Vector3d(0, 0, 0.5), Vector3d(0.3, 0, 0.1), Vector3d(std::nan(""), 0, 0.1), Vector3d(0, 0, 1e300)}) {
    EXPECT_FALSE(inverse(p));
    EXPECT_FALSE(jacobian(p));
    EXPECT_FALSE(torques(p, {1, 0, 0}));
  }
  EXPECT_FALSE(torques(kNeutral_m, {std::nan(""), 0, 0}));
  EXPECT_FALSE(forward({std::nan(""), 0, 0}, kNeutral_m));
  EXPECT_FALSE(forward({100.0, -100.0, 50.0}, kNeutral_m));
}

TEST(FalconKinematics, MaximumForceIsAvailableInEveryDirectionOfTheWorkspaceBeforeSaturation) {
  // 5 N at 10000 counts a newton metre and 4095 counts: what falcon_info() promises, over the middle of the workspace.
  double least = 1e9;
  for (const Vector3d& p : poses(500, 0.02))
    for (const Vector3d& direction : poses(40, 1.0)) {
      const Vector3d unit = (direction - Vector3d(0, 0, 0.14)).normalized();
      least = std::min(least, 4095.0 / (10000.0 * torques(p, unit)->cwiseAbs().maxCoeff()));
    }
  EXPECT_GT(least, 4.0);
  RecordProperty("least_force_n", std::to_string(least));
  std::printf("least force before saturation: %.2f N\n", least);
}

}  // namespace
