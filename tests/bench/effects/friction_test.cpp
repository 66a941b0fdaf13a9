// Every law of friction is right where its truth is known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "bench/effects/friction.h"
#include "bench/effects/friction_trials.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector2d;

constexpr double kPress = 2.0;  // N

const std::vector<FrictionRow>& rows() {
  static const std::vector<FrictionRow> all = friction_rows();
  return all;
}

TEST(FrictionLaws, BelowTheBreakEveryLawIsASpringFromTheFirstTouch) {
  const FrictionSetting setting;
  for (const FrictionEntrant& entrant : all_friction_laws()) {
    const auto law = entrant.make(setting);
    law->place(Vector2d::Zero());
    const Vector2d way(0.8, 0.6);
    for (int tick = 1; tick <= 500; ++tick) {
      const double moved = 1e-6 * tick;  // half of what dynamic friction bears
      const Vector2d force = law->update(moved * way, kPress);
      // Kikuuwe's damper of 0.2 N s/m adds 0.2 mN at 1 mm/s; the paper's iteration ends 1e-3 of a cell off at most.
      EXPECT_NEAR((force + setting.stiffness_n_per_m * moved * way).norm(), 0.0, 3e-4) << entrant.law;
    }
  }
}

TEST(FrictionLaws, SlidingForceIsTheDynamicCoefficientTimesThePressAgainstTheMotion) {
  const FrictionSetting setting;
  for (const FrictionEntrant& entrant : all_friction_laws())
    for (const double mu : {0.1, 0.4}) {
      FrictionSetting other = setting;
      other.mu_dynamic = mu;
      const auto law = entrant.make(other);
      law->place(Vector2d::Zero());
      const Vector2d way(-0.6, 0.8);
      Vector2d force = Vector2d::Zero();
      for (int tick = 1; tick <= 2000; ++tick) force = law->update(0.0001 * tick * way, kPress);
      EXPECT_NEAR((force + mu * kPress * way).norm(), 0.0, 2e-3 * mu * kPress) << entrant.law << " at " << mu;
    }
}

TEST(FrictionLaws, TheHandIsHeldUpToItsCoefficientAndNoFarther) {
  for (const FrictionRow& row : rows()) {
    // A micrometre per tick, of the 1 mm or more at which it breaks.
    EXPECT_NEAR(row.break_error, 0.0, 2e-3) << row.law;
    EXPECT_LE(row.tick_p50_ns, row.tick_p99_ns) << row.law;
    EXPECT_LE(row.ratio_low, row.ratio) << row.law;
    EXPECT_GE(row.ratio_high, row.ratio) << row.law;
  }
}

TEST(FrictionLaws, AHeldHandDoesNotCreep) {
  for (const FrictionRow& row : rows()) EXPECT_LT(row.drift_m, 1e-6) << row.law;
}

TEST(FrictionLaws, StickSlipOfTheContinuousLawHasThePeriodOfTheClosedForm) {
  // A contact 1000 times as stiff as the drawing spring. y = V t - x - F_d / K: the pull's excess, over K.
  FrictionSetting setting;
  setting.stiffness_n_per_m = 2e5;
  DrawnMass drawn;
  drawn.damping_n_s_per_m = 2.0;
  drawn.speed_m_per_s = 0.005;
  const double k = drawn.stiffness_n_per_m, v = drawn.speed_m_per_s, b = drawn.damping_n_s_per_m;
  const double decay = 0.5 * b / drawn.mass_kg;
  const double turn = std::sqrt(k / drawn.mass_kg - decay * decay);
  const double start = (setting.mu_static - setting.mu_dynamic) * drawn.press_n / k - b * v / k;
  // Sliding: y'' + 2 decay y' + (k / m) y = 0, y(0) = start, y'(0) = V, until the mass stands again, y' = V.
  const double sine = (v + decay * start) / turn;
  const auto y = [&](double t) {
    return std::exp(-decay * t) * (start * std::cos(turn * t) + sine * std::sin(turn * t));
  };
  const auto slope = [&](double t) { return (y(t + 1e-7) - y(t - 1e-7)) / 2e-7; };
  double slid = std::numbers::pi / turn;  // past the middle of the slip
  while (slope(slid) < v) slid += 1e-6;
  const double expected = slid + (start - y(slid)) / v;
  // At the end of a slip the contact's own spring rings with what it was stretched by and is damped in 0.1 s.
  EXPECT_NEAR(continuous_period(setting, drawn), expected, 0.02 * expected);
}

TEST(FrictionLaws, SamplingChangesTheStickSlipOfTheTwoCoefficientLawsLittleAndTheOthersHaveNone) {
  for (const FrictionRow& row : rows()) {
    std::printf(
        "%-18s slide %+.4f angle %.2f break %+.4f drift %.3g um chatter %.4f slow %+.4f period %.4f true %.4f s "
        "%.1f ns\n",
        row.law.c_str(), row.slide_error, row.angle_deg, row.break_error, 1e6 * row.drift_m, row.chatter,
        row.slow_error, row.period_s, row.period_true_s, row.tick_p50_ns);
    if (row.period_true_s == 0.0) {
      EXPECT_EQ(row.period_s, 0.0) << row.law;
    } else {
      // A tick of 1 ms at each of the two transitions.
      EXPECT_NEAR(row.period_s, row.period_true_s, 0.004) << row.law;
    }
  }
}

}  // namespace
}  // namespace sparsha::bench
