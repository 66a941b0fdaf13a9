// What a law of friction does to a hand: force while sliding and at the break, creep while held, chatter, stick-slip,
// time.
#pragma once

#include <string>
#include <vector>

#include "bench/effects/friction.h"

namespace sparsha::bench {

struct FrictionRow {
  std::string law;
  std::string source;
  double slide_error = 0.0;  ///< mean force at 0.1 m/s round a circle, over mu_dynamic times the press, less 1
  double angle_deg = 0.0;    ///< mean, between that force and the direction against the motion
  double break_error = 0.0;  ///< largest force of a slow pull, over the coefficient that should hold, less 1
  double drift_m = 0.0;      ///< of the anchor in 9 s, held at half of sliding while hand and press tremble
  double chatter = 0.0;      ///< standard deviation of the force at 2 mm/s on encoder steps of 0.058 mm, over its mean
  double slow_error = 0.0;   ///< that mean over mu_dynamic times the press, less 1
  double period_s = 0.0;     ///< of stick-slip; 0: none
  double period_true_s = 0.0;  ///< of Coulomb's law in continuous time, for laws with two coefficients; else 0
  double tick_p50_ns = 0.0;    ///< of updates, each the mean of twenty in a row, best of the rounds
  double tick_p99_ns = 0.0;
  double ratio = 1.0;  ///< median over the rounds of the mean time of an update over that of the first law
  double ratio_low = 1.0, ratio_high = 1.0;  ///< least and greatest of these
};

/// All laws; their times are taken in turns.
[[nodiscard]] std::vector<FrictionRow> friction_rows();

/// A mass on a spring and a damper, drawn over a plane: where stick-slip is looked for.
struct DrawnMass {
  double mass_kg = 0.1;
  double stiffness_n_per_m = 200.0;
  double damping_n_s_per_m = 1.0;
  double speed_m_per_s = 0.01;
  double press_n = 2.0;
};

/// Mean time between slips under the law of `entrant`, sampled at its tick; 0 when there are fewer than three.
[[nodiscard]] double stick_slip_period(const FrictionEntrant& entrant, const FrictionSetting& setting,
                                       const DrawnMass& drawn);
/// The same under Coulomb's law with a coefficient each for rest and sliding and the stiffness of the contact, in steps
/// of 2 us: what sampling should not change.
[[nodiscard]] double continuous_period(const FrictionSetting& setting, const DrawnMass& drawn);

}  // namespace sparsha::bench
