// A hand that is told where to go: it keeps its force, goes by its steps, climbs walls, and waits in the air for
// forces.
#include "haptics/device/steered/steered_device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;

/// A stone of springs: pushes along its normal, and back by friction; the walls of a ridge push across.
class Steered : public ::testing::Test {
 protected:
  void run(double seconds, const std::function<Vector3d(const Vector3d&)>& force_n) {
    for (const double end_s = time_s_ + seconds; time_s_ < end_s; time_s_ += 0.001) {
      hand_m_ = device_->read(time_s_, 0.001).position_m;
      force_n_ = force_n(hand_m_);
      most_n_ = std::max(most_n_, force_n_.norm());
      device_->write(force_n_);
    }
  }
  void wish(double x_m, double y_m, double press_n, bool armed = true) {
    SteeringSample sample;
    sample.wanted_m = {x_m, y_m};
    sample.press_n = press_n;
    sample.armed = armed ? 1 : 0;
    sample.sequence = ++sequence_;
    wish_->publish(sample);
  }
  static Vector3d plane(const Vector3d& hand_m) { return {0.0, 0.0, 800.0 * std::max(0.0, -hand_m.z())}; }
  /// 6 mm high, its face at x = 10 mm, with a proxy that stays on the face until the hand has come above it.
  static Vector3d step(const Vector3d& hand_m) {
    const double top_m = 0.006, wall_m = 0.01;
    if (hand_m.x() < wall_m) return plane(hand_m);
    const double up_m = top_m - hand_m.z(), back_m = hand_m.x() - wall_m;
    if (up_m <= 0.0) return Vector3d::Zero();
    if (up_m < back_m) return {0.0, 0.0, 800.0 * up_m};
    return {-800.0 * back_m, 0.0, 800.0 * std::max(0.0, -hand_m.z())};
  }

  std::shared_ptr<Seqlock<SteeringSample>> wish_ = std::make_shared<Seqlock<SteeringSample>>();
  std::unique_ptr<Device> device_ = make_steered_device(wish_);
  Vector3d hand_m_ = Vector3d::Zero(), force_n_ = Vector3d::Zero();
  double time_s_ = 0.0, most_n_ = 0.0;
  std::uint64_t sequence_ = 0;
};

TEST_F(Steered, KeepsTheForceThatIsWantedOnAPlaneAndOnASlope) {
  run(1.0, plane);
  EXPECT_GT(hand_m_.z(), 0.02) << "nobody has said anything yet";
  for (const double press_n : {0.3, 1.0, 3.5}) {
    wish(0.0, 0.0, press_n);
    run(2.0, plane);
    EXPECT_NEAR(force_n_.z(), press_n, 0.05 * press_n + 0.02);
  }
  const auto slope = [](const Vector3d& hand_m) -> Vector3d {
    const Vector3d normal = Vector3d(-0.5, 0.0, 1.0).normalized();
    return 800.0 * std::max(0.0, -normal.dot(hand_m)) * normal;
  };
  wish(0.0, 0.0, 1.0);
  run(1.0, slope);
  wish(0.03, 0.0, 1.0);
  double least_n = 10.0, most_n = 0.0;
  for (int k = 0; k < 500; ++k) {
    run(0.001, slope);
    least_n = std::min(least_n, force_n_.z());
    most_n = std::max(most_n, force_n_.z());
  }
  EXPECT_GT(least_n, 0.3) << "it follows the slope while it goes up";
  EXPECT_LT(most_n, 2.5);
  run(1.0, slope);
  EXPECT_NEAR(hand_m_.x(), 0.03, 0.002);
}

TEST_F(Steered, ComesDownWithoutABlow) {
  wish(0.0, 0.0, 1.0);
  run(3.0, plane);
  EXPECT_LT(most_n_, 1.6);
}

TEST_F(Steered, ClimbsAWallThatIsInItsWayAndNeverPressesHardAgainstIt) {
  wish(0.0, 0.0, 1.0);
  run(1.5, step);
  wish(0.02, 0.0, 1.0);
  run(2.0, step);
  EXPECT_NEAR(hand_m_.x(), 0.02, 0.001);
  EXPECT_NEAR(hand_m_.z(), 0.006 - 1.0 / 800.0, 0.0005);
  EXPECT_LT(most_n_, 4.0);
  wish(0.0, 0.0, 1.0);
  run(2.0, step);
  EXPECT_NEAR(hand_m_.x(), 0.0, 0.001);
  EXPECT_NEAR(force_n_.z(), 1.0, 0.1) << "down again";
}

TEST_F(Steered, RisesUntilForcesAreDeliveredAndWhenItIsLifted) {
  wish(0.0, 0.0, 1.0);
  run(2.0, plane);
  wish(0.01, 0.0, 1.0, false);  // after a fault
  run(0.4, plane);
  EXPECT_GT(hand_m_.z(), 0.02);
  wish(0.01, 0.0, 1.0);
  run(2.0, plane);
  EXPECT_NEAR(force_n_.z(), 1.0, 0.1);
  wish(0.02, 0.0, 0.0);
  run(1.5, plane);
  EXPECT_NEAR(hand_m_.z(), 0.01, 0.003);
  EXPECT_NEAR(hand_m_.x(), 0.02, 0.001) << "it moves through the air as well";
}

TEST_F(Steered, StaysInItsWorkspaceAndIgnoresWhatIsNoPlace) {
  const auto nothing = [](const Vector3d&) -> Vector3d { return Vector3d::Zero(); };
  wish(1.0, -1.0, 1.0);
  run(5.0, nothing);
  EXPECT_TRUE((hand_m_.cwiseAbs().array() <= 0.0491).all()) << hand_m_.transpose();
  wish(std::nan(""), 0.0, 1.0);
  run(0.2, nothing);
  EXPECT_TRUE(hand_m_.allFinite());
}

}  // namespace
}  // namespace sparsha::haptics
