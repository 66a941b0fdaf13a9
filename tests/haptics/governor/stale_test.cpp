// Ticks without news of the hand: the force of before for 7 ms or seven samples of a slow device, then none; the energy
// of the contact goes on being observed.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "haptics/governor/governor.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

constexpr double kPeriod = 0.001;
constexpr double kStiffness = 800.0;

/// A hand on a plane at z = 0, its places given.
GovernorInput at(double z_m, bool fresh = true) {
  const double depth_m = std::max(0.0, -z_m);
  GovernorInput input;
  input.position_m.z() = z_m;
  input.force_n.z() = kStiffness * depth_m;
  input.contact = depth_m > 0.0;
  input.normal = input.contact ? Vector3d(Vector3d::UnitZ()) : Vector3d(Vector3d::Zero());
  input.proxy_m = Vector3d(0, 0, std::max(0.0, z_m));
  input.stiffness_n_per_m = kStiffness;
  input.spring_energy_j = 0.5 * kStiffness * depth_m * depth_m;
  input.fresh = fresh;
  return input;
}

/// Presses with a newton, then lifts by `lift_m` in `ticks`. `stale` of the ticks before the lift are without news.
std::vector<double> lifted(int stale, double lift_m, int ticks) {
  constexpr double kDepth = 1.0 / kStiffness;
  constexpr int kPressTicks = 200;
  Governor governor{DeviceLimits{}};
  governor.arm();
  for (int k = 0; k <= kPressTicks; ++k) (void)governor.update(at(-kDepth * k / kPressTicks));
  for (int k = 0; k < 100; ++k) (void)governor.update(at(-kDepth));
  for (int k = 1; k <= stale; ++k) {
    const double force_n = governor.update(at(-kDepth, false)).force_n.z();
    EXPECT_DOUBLE_EQ(force_n, k < 7 ? 1.0 : 0.0) << k << " ms without news";
  }
  (void)governor.update(at(-kDepth));
  std::vector<double> forces;
  for (int k = 1; k <= ticks; ++k) forces.push_back(governor.update(at(-kDepth + lift_m * k / ticks)).force_n.z());
  return forces;
}

}  // namespace

TEST(Stale, ATickWithoutNewsTakesNothingFromTheForceOfTheWayOut) {
  const std::vector<double> whole = lifted(0, 0.2e-3, 20);
  for (const int stale : {1, 2, 5, 6}) {
    const std::vector<double> after = lifted(stale, 0.2e-3, 20);
    for (std::size_t k = 0; k < whole.size(); ++k) EXPECT_EQ(after[k], whole[k]) << stale << ", tick " << k;
  }
}

TEST(Stale, TheForceOfBeforeGoesOnForSevenMillisecondsOrSixSlowSamplesAndOnlyWhereItMay) {
  for (const double rate_hz : {100.0, 200.0, 333.0, 400.0, 851.0, 1000.0, 4000.0}) {
    const double stale_s = std::max(0.007, 7.0 / rate_hz);
    Governor governor{DeviceLimits{}};
    const auto go = [&](GovernorInput input) {
      input.period_s = input.nominal_period_s = 1.0 / rate_hz;
      return governor.update(input).force_n.z();
    };
    governor.arm();
    double pressed_n = 0.0;
    for (int k = 0; k <= 500; ++k) pressed_n = go(at(-1e-3 * std::min(1.0, k / 400.0)));
    ASSERT_GT(pressed_n, 0.7);
    for (int k = 1; k < rate_hz; ++k) {
      const double age_s = k / rate_hz;
      ASSERT_DOUBLE_EQ(go(at(-1e-3, false)), age_s < stale_s - 1e-9 ? pressed_n : 0.0) << rate_hz << " Hz, " << age_s;
    }
    EXPECT_GT(go(at(-1e-3)), 0.0);
    governor.disarm();
    EXPECT_EQ(go(at(-1e-3, false)), 0.0) << "disarmed";
    GovernorInput broken = at(-1e-3, false);
    broken.position_m.x() = NAN;
    governor.arm();
    for (int k = 0; k < 50; ++k) static_cast<void>(go(at(-1e-3)));
    EXPECT_EQ(go(broken), 0.0);
    EXPECT_EQ(go(at(-1e-3, false)), 0.0) << "after what is not a number";
  }
}

TEST(Stale, SamplesThatComeMoreSlowlyThanThePlanAreJudgedByTheirOwnPace) {
  // A servo planned for a kilohertz, a device of 400 Hz: five ticks in two samples.
  Governor governor{DeviceLimits{}};
  governor.arm();
  int tick = 0;
  const auto go = [&](bool lost) {
    const bool fresh = tick * 2 / 5 != (tick - 1) * 2 / 5 && !lost;
    ++tick;
    return governor.update(at(-1e-3 * std::min(1.0, tick / 400.0), fresh)).force_n.z();
  };
  double pressed_n = 0.0;
  while (tick < 1000) pressed_n = go(false);
  ASSERT_GT(pressed_n, 0.7);
  int held = 0;
  while (go(true) == pressed_n && held < 100) ++held;
  // The median of two and three ticks is two: seven times that, not the seven samples of 17.5 ms.
  EXPECT_GE(held, 13) << "five samples of the device are 12.5 ms";
  EXPECT_LE(held, 18);
}

TEST(Stale, AGapDeliversToAMovingHandNoMoreThanItPutInAndTheOverdraft) {
  // The device holds each force until the tick after next: a declared delay of one. Out at any speed, gaps of any
  // length, beginning anywhere on the way out. A hand that begins to leave within the gap is held to be at rest: the
  // newton of before goes on for 7 ms and the delay.
  for (const double speed_m_per_s : {0.02, 0.1, 0.3, 1.0})
    for (int stale = 1; stale <= 9; ++stale)
      for (int before = 0; before < 4; ++before) {
        constexpr double kDepth = 1.0 / kStiffness;
        Governor governor{DeviceLimits{}};
        governor.arm();
        double held_n[2] = {0.0, 0.0};
        double z_m = 0.0;
        double given_j = 0.0;  // to the hand
        double step_j = 0.0;   // by one tick at most
        const auto go = [&](double to_m, bool fresh) {
          given_j += held_n[1] * (to_m - z_m);
          step_j = std::max(step_j, std::abs(held_n[1] * (to_m - z_m)));
          z_m = to_m;
          const double force_n = governor.update(at(z_m, fresh)).force_n.z();
          held_n[1] = held_n[0];
          held_n[0] = force_n;
        };
        for (int k = 1; k <= 200; ++k) go(-kDepth * k / 200, true);
        for (int k = 0; k < 10; ++k) go(-kDepth, true);
        for (int k = 0; k < 1200 && z_m < kDepth; ++k)
          go(z_m + speed_m_per_s * kPeriod, k < before || k >= before + stale);
        const double unseen_j = before == 0 ? 1.0 * speed_m_per_s * kPeriod * std::min(stale, 8) : 0.0;
        EXPECT_LE(given_j, kOverdraft_j + 2.0 * step_j + unseen_j)
            << speed_m_per_s << " m/s, " << stale << " after " << before;
      }
}

TEST(Stale, AForceThatGoesOnFallsAsTheSpringWouldForAHandThatLeaves) {
  constexpr double kDepth = 2.0 / kStiffness;
  for (const double speed_m_per_s : {-0.1, 0.0, 0.02, 0.1}) {
    Governor governor{DeviceLimits{}};
    governor.arm();
    for (int k = 0; k <= 200; ++k) (void)governor.update(at(-kDepth * k / 200));
    double z_m = -kDepth;
    for (int k = 0; k < 10; ++k) (void)governor.update(at(z_m += speed_m_per_s * kPeriod));
    const double before_n = governor.update(at(z_m += speed_m_per_s * kPeriod)).force_n.z();
    for (int k = 1; k < 7; ++k) {
      const double spring_n = before_n - kStiffness * std::max(0.0, speed_m_per_s) * kPeriod * k;

      const double force_n = governor.update(at(z_m, false)).force_n.z();
      EXPECT_GE(force_n, spring_n - 0.01) << speed_m_per_s << ", " << k;
      EXPECT_LE(force_n, spring_n + 0.01) << speed_m_per_s << ", " << k;
      EXPECT_LE(force_n, before_n) << "it never grows";
    }
  }
}

TEST(Stale, LostTicksCountAsTimeOfTheLoop) {
  const auto limit_after = [](int lost_of_ten) {
    Governor governor{DeviceLimits{}};
    for (int k = 0; k < 3000; ++k) (void)governor.update(at(0.01, k % 10 >= lost_of_ten));
    return governor.stiffness(1e5, kPeriod);
  };
  EXPECT_DOUBLE_EQ(limit_after(0), stiffness_limit({}, kPeriod));
  // One entry in nine is of two ticks, one in seven of four; bins of 4.4 %.
  EXPECT_LE(limit_after(1), stiffness_limit({}, 2.0 * kPeriod));
  EXPECT_GE(limit_after(1), stiffness_limit({}, 2.0 * kPeriod) / 1.05);
  EXPECT_LE(limit_after(3), stiffness_limit({}, 4.0 * kPeriod));
  EXPECT_GE(limit_after(3), stiffness_limit({}, 4.0 * kPeriod) / 1.05);
}

TEST(Stale, TheHandsVelocityGoesOnOverAGap) {
  Governor governor{DeviceLimits{}};
  constexpr double kSpeed = 0.05;
  for (int k = 0; k < 60; ++k) (void)governor.update(at(0.05 - kSpeed * kPeriod * k, k % 10 != 5));
  (void)governor.update(at(0.05 - kSpeed * kPeriod * 60, false));
  (void)governor.update(at(0.05 - kSpeed * kPeriod * 61));
  EXPECT_NEAR(governor.velocity().z(), -kSpeed, 1e-9);
}

}  // namespace sparsha::haptics::test
