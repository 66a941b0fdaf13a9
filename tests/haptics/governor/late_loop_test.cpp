// What a later loop would give to a hand, against the integral over one swing, and what the governor makes of it.
#include "haptics/governor/late_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <numbers>

#include "haptics/governor/governor.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;

constexpr double kPeriod_s = 0.001;
constexpr double kStiffness_n_per_m = 800.0;
constexpr double kMiddle_m = 0.002;  // below the surface
constexpr double kSwing_m = 0.001;
constexpr double kRate = 2.0 * std::numbers::pi * 8.0;

double depth_m(double time_s) { return kMiddle_m + kSwing_m * std::sin(kRate * time_s); }

TEST(LateLoop, CountsWhatALaterForceWouldGiveToAHandThatGoesInAndOut) {
  for (const std::size_t ticks : {0U, 1U, 3U, 6U}) {
    LateLoop loop;
    constexpr int kSeconds = 2;
    for (int k = 1; k <= kSeconds * 1000; ++k) {
      const double before_m = depth_m(kPeriod_s * (k - 1));
      const double now_m = depth_m(kPeriod_s * k);
      const double stored_j = std::max(0.0, 0.5 * kStiffness_n_per_m * (now_m * now_m - before_m * before_m));
      const Vector3d moved_m(0.0, 0.0, before_m - now_m);
      // The force that was commanded in the tick before is the newest.
      loop.command({0.0, 0.0, kStiffness_n_per_m * before_m});
      loop.observe(moved_m, 0.0, 0.5 * kStiffness_n_per_m * now_m * now_m, stored_j, ticks);
    }
    // A force that is held for a tick comes half a tick late besides.
    const double late_s = kPeriod_s * (static_cast<double>(ticks) + 0.5);
    const double swing_j = std::numbers::pi * kStiffness_n_per_m * kSwing_m * kSwing_m * std::sin(kRate * late_s);
    EXPECT_NEAR(loop.debt_j() / (8.0 * kSeconds * swing_j), 1.0, 0.15) << ticks;
    loop.forgive(1.0);
    EXPECT_EQ(loop.debt_j(), 0.0);
  }
}

// From the air into the stone within half a second.
double stroke_m(double time_s) {
  const double share = std::min(1.0, 2.0 * time_s);
  return share * depth_m(time_s) - (1.0 - share) * 0.002;
}

// Work in joules that a hand gets in ten seconds which goes in and out 8 times a second as the stone under it does, of
// which it feels a part, whatever the force. `measured_s`: of the delay, what the device tells; 0 for none of it.
double given_j(double undeclared_s, double delay_s, double measured_s = 0.0) {
  DeviceLimits limits;
  limits.undeclared_s = undeclared_s;
  Governor governor(limits);
  governor.arm();
  std::deque<Vector3d> on_the_way(static_cast<std::size_t>(std::lround(delay_s / kPeriod_s)), Vector3d::Zero());
  double work_j = 0.0;
  double before_m = stroke_m(0.0);
  for (int k = 1; k <= 10'000; ++k) {
    const double now_m = stroke_m(kPeriod_s * k);
    GovernorInput input;
    const double stiffness = governor.stiffness(kStiffness_n_per_m, kPeriod_s);
    input.position_m = {0.0, 0.0, -now_m};
    if (now_m > 0.0) input.normal = Vector3d::UnitZ();
    input.proxy_m = {0.05 * kPeriod_s * k, 0.0, -0.9 * now_m};
    input.contact = now_m > 0.0;
    input.force_n = {0.0, 0.0, stiffness * std::max(0.0, now_m)};
    input.stiffness_n_per_m = stiffness;
    input.delay_s = measured_s;
    input.spring_energy_j = 0.5 * input.force_n.z() * std::max(0.0, now_m);
    work_j += on_the_way.front().z() * (before_m - now_m);
    on_the_way.pop_front();
    on_the_way.push_back(governor.update(input).force_n);
    before_m = now_m;
  }
  return work_j;
}

TEST(LateLoop, TheGovernorBoundsWhatAnUndeclaredDelayGivesAndLeavesAKnownLoopAlone) {
  const double known_j = given_j(0.0, 0.003);
  const double braked_j = given_j(0.002, 0.003);
  EXPECT_GT(known_j, 0.010) << "the case is one";
  EXPECT_LT(braked_j, 0.005);
}

TEST(LateLoop, WhatTheDeviceMeasuresOfItsDelayCountsAndOnlyTheRestHasToBeAssumed) {
  EXPECT_GT(given_j(0.001, 0.006), 0.010) << "the case is one";
  EXPECT_LT(given_j(0.001, 0.006, 0.005), 0.005);
  EXPECT_LT(given_j(0.0, 0.006, 0.006), 0.005);
}

}  // namespace
}  // namespace sparsha::haptics
