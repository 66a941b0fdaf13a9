#include "haptics/governor/governor.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

constexpr double kPeriod = 0.001;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

GovernorInput still(const Vector3d& force_n, bool contact = true) {
  GovernorInput input;
  input.force_n = force_n;
  input.contact = contact;
  input.spring_energy_j = contact ? 0.5 * force_n.squaredNorm() / 800.0 : 0.0;
  return input;
}

Governor armed_governor(const DeviceLimits& limits = {}) {
  Governor governor(limits);
  governor.arm();
  return governor;
}

}  // namespace

TEST(Governor, LimitsStiffnessToFourFifthsOfTheOnsetOfOscillation) {
  DeviceLimits limits;
  limits.least_damping_n_s_per_m = 3.0;
  EXPECT_DOUBLE_EQ(stiffness_limit(limits, kPeriod), 1600.0);
  EXPECT_DOUBLE_EQ(governed_stiffness(500.0, limits, kPeriod), 500.0);
  EXPECT_DOUBLE_EQ(governed_stiffness(5000.0, limits, kPeriod), 1600.0);
}

TEST(Governor, GivesZeroForAStaleHandAndAtOnceForAnInvalidOne) {
  Governor governor = armed_governor();
  for (int k = 0; k < 10; ++k) (void)governor.update(still({0, 0, 3}));
  GovernorInput stale = still({0, 0, 3});
  stale.fresh = false;
  for (int k = 1; k < 7; ++k) EXPECT_EQ(governor.update(stale).force_n, Vector3d(0, 0, 3)) << k;
  EXPECT_EQ(governor.update(stale).force_n, Vector3d::Zero()) << "7 ms without news";
  GovernorInput invalid = still({0, 0, 3});
  invalid.position_m.y() = kNan;
  EXPECT_EQ(governor.update(invalid).force_n, Vector3d::Zero());
  invalid = still({0, kNan, 3});
  const GovernorOutput output = governor.update(invalid);
  EXPECT_EQ(output.force_n, Vector3d::Zero());
  EXPECT_FALSE(output.armed) << "what is not a number is a fault";
}

TEST(Governor, ArmsOnlyAfterFiftyMillisecondsInFreeSpace) {
  Governor governor{DeviceLimits{}};
  for (int k = 0; k < 100; ++k) EXPECT_EQ(governor.update(still({0, 0, 1})).force_n, Vector3d::Zero());
  for (int k = 0; k < 49; ++k) EXPECT_FALSE(governor.update(still(Vector3d::Zero(), false)).armed);
  EXPECT_FALSE(governor.update(still({0, 0, 1})).armed) << "a touch starts the count again";
  for (int k = 0; k < 51; ++k) (void)governor.update(still(Vector3d::Zero(), false));
  EXPECT_GT(governor.update(still({0, 0, 1})).force_n.z(), 0.0);
  governor.disarm();
  EXPECT_EQ(governor.update(still({0, 0, 1})).force_n, Vector3d::Zero());
}

TEST(Governor, ClampsTheMagnitudeAndKeepsTheDirection) {
  DeviceLimits limits;
  limits.max_force_n = 5.0;
  Governor governor = armed_governor(limits);
  const Vector3d wanted(30.0, -40.0, 120.0);
  GovernorOutput output;
  for (int k = 0; k < 100; ++k) output = governor.update(still(wanted));
  EXPECT_NEAR(output.force_n.norm(), 5.0, 1e-12);
  EXPECT_NEAR(output.force_n.normalized().dot(wanted.normalized()), 1.0, 1e-15);
  EXPECT_TRUE(output.saturated);
}

TEST(Governor, LimitsTheGrowthOfForceAndSpreadsALargeLossOverSomeTicks) {
  Governor governor = armed_governor();
  const double step = DeviceLimits{}.slew_n_per_s * kPeriod;
  Vector3d last = Vector3d::Zero();
  for (int k = 1; k <= 4; ++k) {
    last = governor.update(still({0, 0, 6})).force_n;
    EXPECT_NEAR(last.z(), std::min(6.0, k * step), 1e-12);
  }
  for (const double left : {5.5, 5.0, 4.5}) EXPECT_NEAR(governor.update(still({0, 0, 0.5})).force_n.z(), left, 1e-12);
  EXPECT_NEAR(governor.update(still({0, 0, 4.1})).force_n.z(), 4.1, 1e-12) << "a small decrease is free";
  const Vector3d turned = governor.update(still({1, 0, 3.9})).force_n;
  EXPECT_GT(turned.x(), 0.4) << "a new direction begins at once";
  EXPECT_LE((turned - Vector3d(0, 0, 4.1)).norm(), 0.5 + 1e-12);
  // Of a hand that goes away as fast as its spring gives way nothing is spread.
  Governor leaving = armed_governor();
  GovernorInput input = still({0, 0, 0.8});
  input.stiffness_n_per_m = 800.0;
  for (int k = 0; k < 3; ++k) last = leaving.update(input).force_n;
  input.position_m.z() += 0.001;
  input.force_n.setZero();
  EXPECT_NEAR(leaving.update(input).force_n.norm(), 0.0, 1e-12);
}

TEST(Governor, HoldsAStaticForceExactly) {
  Governor governor = armed_governor();
  GovernorOutput output;
  for (int k = 0; k < 600'000; ++k) output = governor.update(still({0.3, -0.2, 4.0}));
  EXPECT_EQ(output.force_n, Vector3d(0.3, -0.2, 4.0));
  EXPECT_FALSE(output.saturated);
}

TEST(Governor, BooksTheForceThatTheDeviceHeldTheDelayIncluded) {
  for (int delay = 0; delay <= 4; ++delay) {
    DeviceLimits limits;
    limits.delay_ticks = delay;
    limits.least_damping_n_s_per_m = 0.0;
    limits.slew_n_per_s = 1e9;
    Governor governor = armed_governor(limits);
    // Pressing in at constant speed against k = 800 N/m from the surface at 0.
    constexpr double kStiffness = 800.0;
    constexpr double kStep = 1e-5;
    double expected = 0.0;
    double energy = 0.0;
    for (int k = 0; k <= 50; ++k) {
      const double depth = k * kStep;
      GovernorInput input = still({0, 0, kStiffness * depth}, depth > 0.0);
      input.position_m.z() = -depth;
      input.spring_energy_j = 0.5 * kStiffness * depth * depth;
      energy = governor.update(input).energy_j;
      if (k > 0) expected += kStiffness * kStep * std::max(0, k - 1 - delay) * kStep;
    }
    EXPECT_NEAR(energy, expected, 1e-12) << "delay " << delay;
  }
}

TEST(Governor, DoesNotCutTheForceOfARestingHandWhoseEncoderFlickers) {
  Governor governor = armed_governor();
  std::mt19937_64 random(5);
  constexpr double kStep = 5.8e-5;
  const double stiffness = stiffness_limit(DeviceLimits{}, kPeriod);
  double cut = 0.0;
  for (int k = 0; k < 600'000; ++k) {
    const double depth = 0.0005 * std::min(1.0, k / 100.0) + (random() % 4 == 0 ? kStep : 0.0);
    GovernorInput input = still({0, 0, stiffness * depth});
    input.position_m.z() = -depth;
    input.spring_energy_j = 0.5 * stiffness * depth * depth;
    const GovernorOutput output = governor.update(input);
    if (k > 1000) cut = std::max(cut, (output.force_n - input.force_n).norm());
  }
  EXPECT_EQ(cut, 0.0) << "ten minutes of flicker";
}

TEST(Governor, NeverGivesBackMoreThanOneTicksWorkBeyondWhatWasPutIn) {
  constexpr unsigned kSeed = 7;
  std::mt19937_64 random(kSeed);
  std::normal_distribution<double> normal;
  constexpr double kStiffness = 2500.0;  // far beyond the limit, so that delay makes energy
  for (int run = 0; run < 200; ++run) {
    Governor governor = armed_governor();
    double z = 0.001;
    double speed = 0.0;
    double delivered_j = 0.0;  // to the hand, by the force that the device held
    double damped_j = 0.0;     // by the least damping of hand and device
    double most_work = 0.0;
    Vector3d held[2] = {Vector3d::Zero(), Vector3d::Zero()};
    for (int k = 0; k < 2000; ++k) {
      speed = 0.98 * speed + 0.004 * normal(random);
      const double step = speed * kPeriod * 10.0;
      z += step;
      if (std::abs(z) > 0.004) speed = -speed, z = std::copysign(0.004, z);
      const double work = held[1].z() * step;
      delivered_j += work;
      damped_j += DeviceLimits{}.least_damping_n_s_per_m * step * step / kPeriod;
      most_work = std::max(most_work, std::abs(work));
      const double depth = std::max(0.0, -z);
      GovernorInput input = still({0, 0, kStiffness * depth}, depth > 0.0);
      input.position_m.z() = z;
      input.spring_energy_j = 0.5 * kStiffness * depth * depth;
      const GovernorOutput output = governor.update(input);
      EXPECT_GE(output.energy_j, -2.0 * most_work - kOverdraft_j - 1e-12);
      EXPECT_LE(delivered_j - damped_j, 2.0 * most_work + 1e-12);
      held[1] = held[0];
      held[0] = output.force_n;
    }
  }
}

TEST(Governor, GivesNoCreditForEnergyThatFrictionAte) {
  Governor governor = armed_governor();
  // Stroking with friction: force against the motion, the spring's energy constant.
  GovernorOutput output;
  GovernorInput input = still({-1.0, 0, 2.0});
  for (int k = 0; k < 1000; ++k) {
    input.position_m.x() += 1e-4;
    output = governor.update(input);
  }
  EXPECT_LE(output.energy_j, input.spring_energy_j);
  EXPECT_LE(output.energy_j, 1e-12) << "the spring was loaded without motion, so nothing was put in";
}

TEST(Governor, GrowsByOneNominalStepWhateverTheGap) {
  const double step = DeviceLimits{}.slew_n_per_s * kPeriod;
  for (const double gap : {0.001, 0.009, 0.3, 1.0, 3600.0, 1e300}) {
    Governor governor = armed_governor();
    GovernorInput input = still({0, 0, 6});
    input.period_s = gap;
    for (int k = 1; k <= 3; ++k) EXPECT_NEAR(governor.update(input).force_n.z(), k * step, 1e-12) << gap;
  }
}

TEST(Governor, AGapIsNoTimeInFreeSpace) {
  Governor governor{DeviceLimits{}};
  GovernorInput input = still(Vector3d::Zero(), false);
  input.period_s = 1.0;
  for (int k = 0; k < 49; ++k) EXPECT_FALSE(governor.update(input).armed) << k;
}

TEST(Governor, ABurstOfTicksEarnsNoCredit) {
  DeviceLimits limits;
  limits.least_damping_n_s_per_m = 0.1;
  Governor governor = armed_governor(limits);
  (void)governor.update(still(Vector3d::Zero()));
  GovernorInput input = still(Vector3d::Zero());
  input.position_m.z() = -1e-4;
  input.spring_energy_j = 1.0;
  input.period_s = 1e-6;
  const double nominal_j = limits.least_damping_n_s_per_m * 1e-8 / kPeriod;
  EXPECT_NEAR(governor.update(input).energy_j, nominal_j, 1e-15) << "what the damping takes in a nominal tick";
}

TEST(Governor, NeverPushesHarderThanTheLimitsWhateverTheyClaim) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double claim : {-1.0, 0.0, kNan, kInfinity, -kInfinity, 1e9, 1e308, -1e-300})
    for (int field = 0; field < 3; ++field) {
      DeviceLimits limits;
      (field == 0 ? limits.max_force_n : field == 1 ? limits.slew_n_per_s : limits.least_damping_n_s_per_m) = claim;
      limits.delay_ticks = field == 0 ? 1'000'000 : -7;
      Governor governor = armed_governor(limits);
      for (int k = 0; k < 200; ++k) {
        GovernorInput input = still({3000.0, -4000.0, 12000.0});
        input.spring_energy_j = 1e6;
        const Vector3d force = governor.update(input).force_n;
        ASSERT_TRUE(force.allFinite());
        ASSERT_LE(force.norm(), 100.0) << "nothing that hands hold is stronger";
        if (!(claim > 0.0) && field == 0) {
          ASSERT_EQ(force, Vector3d::Zero()) << claim;
        }
        if (field != 0) {
          ASSERT_LE(force.norm(), DeviceLimits{}.max_force_n * (1.0 + 1e-15));
        }
        ASSERT_GE(force.dot(input.force_n), 0.0) << "never the other way round";
      }
      EXPECT_GE(stiffness_limit(usable(limits), kPeriod), 0.0);
      EXPECT_TRUE(std::isfinite(stiffness_limit(usable(limits), kPeriod)));
    }
}

TEST(Governor, TheLastClampDeliversNothingThatIsNoForce) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(deliverable({kNan, 0, 1}, 8.0), Vector3d::Zero());
  EXPECT_EQ(deliverable({kInfinity, 0, 1}, 8.0), Vector3d::Zero());
  EXPECT_EQ(deliverable({1e300, 1e300, 0}, 8.0), Vector3d::Zero()) << "longer than any number";
  EXPECT_EQ(deliverable({1, 2, 3}, kNan), Vector3d::Zero());
  EXPECT_EQ(deliverable({1, 2, 3}, -1.0), Vector3d::Zero());
  EXPECT_EQ(deliverable({1, 2, 2}, 8.0), Vector3d(1, 2, 2));
  EXPECT_LT((deliverable({1, 2, 2}, 1.5) - Vector3d(0.5, 1, 1)).norm(), 1e-15);
}

TEST(Governor, TheStiffnessFollowsThePeriodAndTheDelayThatAreMeasured) {
  Governor governor = armed_governor();
  EXPECT_DOUBLE_EQ(governor.stiffness(1e5, kPeriod), stiffness_limit({}, kPeriod)) << "nothing is known yet";
  // 4 % of the ticks take 4 ms: beyond the 95th percentile. 8 %: they count.
  const auto after = [](int slow_of_100, double delay_s) {
    Governor other = armed_governor();
    for (int k = 0; k < 2000; ++k) {
      GovernorInput input = still(Vector3d::Zero(), false);
      input.period_s = k % 100 < slow_of_100 ? 0.004 : kPeriod;
      input.delay_s = delay_s;
      (void)other.update(input);
    }
    return other.stiffness(1e5, kPeriod);
  };
  EXPECT_DOUBLE_EQ(after(0, 0.0), stiffness_limit({}, kPeriod));
  EXPECT_DOUBLE_EQ(after(4, 0.0), stiffness_limit({}, kPeriod));
  // Bins of 4.4 %: the limit is that of the period or a little lower.
  EXPECT_LE(after(8, 0.0), stiffness_limit({}, 0.004));
  EXPECT_GE(after(8, 0.0), stiffness_limit({}, 0.004) / 1.05);
  EXPECT_LE(after(0, 0.003), stiffness_limit({}, kPeriod, 0.003));
  EXPECT_GE(after(0, 0.003), stiffness_limit({}, kPeriod, 0.003) / 1.05);
}

TEST(Governor, ADelayIsForgottenInFreeSpaceOnceNoneHasBeenToldThoughAForceActed) {
  Governor governor = armed_governor();
  const auto after = [&governor](int ticks, double delay_s, bool contact) {
    for (int k = 0; k < ticks; ++k) {
      GovernorInput input = still(contact ? Vector3d{0, 0, 0.1} : Vector3d::Zero(), contact);
      input.delay_s = k % 2 == 0 ? delay_s : 0.0;
      (void)governor.update(input);
      (void)governor.stiffness(1e5, kPeriod);
    }
    return governor.limit_n_per_m();
  };
  const double soft_n_per_m = stiffness_limit({}, kPeriod, 0.1);
  EXPECT_LE(after(300, 0.1, true), soft_n_per_m);
  EXPECT_LE(after(3000, 0.0, false), soft_n_per_m) << "a device may measure only while a force acts";
  EXPECT_LE(after(400, 0.0, true), soft_n_per_m) << "less than half a second with a force";
  EXPECT_LE(after(3000, 0.0, true), soft_n_per_m) << "in contact nothing becomes stiffer";
  EXPECT_DOUBLE_EQ(after(2, 0.0, false), stiffness_limit({}, kPeriod));
  EXPECT_LE(after(300, 0.1, false), soft_n_per_m) << "and is learned anew";
}

TEST(Governor, TheStiffnessNeverRisesInContactUnlessTheWishDoes) {
  Governor governor = armed_governor();
  double last = governor.stiffness(800.0, kPeriod);
  for (int k = 0; k < 3000; ++k) {
    GovernorInput input = still({0, 0, 1});
    input.period_s = k < 1000 ? 0.005 : kPeriod;
    (void)governor.update(input);
    const double now = governor.stiffness(800.0, kPeriod);
    EXPECT_LE(now, last);
    last = now;
  }
  EXPECT_LT(last, 800.0);
  double most = 0.0;
  const double whole = 900.0 - last;
  for (int k = 0; k < 3000; ++k) {
    (void)governor.update(still({0, 0, 1}));
    const double now = governor.stiffness(900.0, kPeriod);
    most = std::max(most, now - last);
    last = now;
  }
  EXPECT_NEAR(last, 900.0, 1.0);
  EXPECT_LT(most, 1.55 * whole / 120.0) << "N/m per tick: the steepest of a smooth step over 120 ms";
}

TEST(Governor, ALowerWishIsFollowedInContactAlsoWhereTheLimitHasComeALittleBelowTheStiffness) {
  Governor governor = armed_governor();
  double stiffness = 0.0;
  const auto hold = [&](double wish_n_per_m, double delay_s) {
    for (int k = 0; k < 2000; ++k) {
      GovernorInput input = still({0, 0, 1});
      input.delay_s = delay_s;
      (void)governor.update(input);
      stiffness = governor.stiffness(wish_n_per_m, kPeriod);
    }
  };
  hold(1000.0, 0.0);
  ASSERT_NEAR(stiffness, 1000.0, 1.0);
  hold(1000.0, 0.00115);
  ASSERT_LT(stiffness_limit({}, kPeriod, 0.00115), 990.0) << "the case that is meant";
  hold(850.0, 0.00115);
  EXPECT_NEAR(stiffness, 850.0, 850.0 * 0.006);
}

}  // namespace sparsha::haptics::test
