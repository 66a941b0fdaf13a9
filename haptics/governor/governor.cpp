#include "haptics/governor/governor.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "base/numbers/smooth_step.h"
#include "haptics/governor/clamped.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;

constexpr double kArming_s = 0.050;  // in free space

// Nothing that a hand holds is stronger, stiffer or more damped.
constexpr double kMostForce_n = 100.0;
constexpr double kMostSlew_n_per_s = 1e6;
constexpr double kMostDamping_n_s_per_m = 100.0;
constexpr double kMostUndeclared_s = 0.004;
constexpr double kMostStep_m = 0.001;

// What no loop through a bus and motors undercuts, whatever is declared.
constexpr double kLeastDelay_s = 0.001;
constexpr double kJitter = 1.15;       // of the pace: not yet jitter; of the nominal period: not yet another rate
constexpr double kSlower = 1.05;       // of the nominal period, more than a bin of the meter: a loop that is slower
constexpr double kNoLoop_s = 0.014;    // beyond the nominal period: gaps, and no loop
constexpr double kAnotherRate = 1.4;   // of the period of some seconds: the loop has become slower
constexpr double kSoften_s = 0.020;    // time constants of the stiffness in contact
constexpr double kSoftenSwings = 3.0;  // half-swings
// The percentiles of a jittering loop scatter by some percent. Followed to its lowest, the limit would fall for as long
// as the contact lasts.
constexpr double kSameLimit = 0.8;
constexpr double kReached = 0.995;
constexpr double kWish_s = 0.120;  // until a new wish is fulfilled in contact
constexpr double kSofter = 0.5;    // after each onset of oscillation
constexpr double kSoftest = 0.06;
constexpr double kMeasuredFor_s = 0.5;    // with a force, after a delay that was told, without another one
constexpr double kForget_s = 10.0;        // in free space, until the whole stiffness is tried again
constexpr double kStrike_m_per_s = 0.08;  // a faster touch is a strike
constexpr double kBounce_s = 0.100;       // a hand that comes back sooner has bounced
constexpr double kThrown_s = 0.090;       // longest touch of a hand that is thrown back
constexpr double kFlight_s = 0.400;
constexpr double kRestitution = 0.8;
constexpr int kMostThrows = 2;
constexpr double kDampingRatio = 0.7;  // of the added damping, once the half-period of the swing is known
constexpr double kFirstHalfPeriod_s = 0.040;
constexpr double kCalm_s = 0.200;
constexpr double kPatience_s = 0.5;  // of the damping with a swing that does not become calm
constexpr double kLarge_m = 55e-6;   // smaller swings do not soften the wall further
constexpr double kLargeSteps = 2.7;
constexpr double kDecay = 0.8;  // of a swing's size in that time
constexpr double kAxis_s = 0.3;
constexpr double kDeadSteps = 0.4;  // encoder steps in the longest window that are no velocity
constexpr double kSideDamping_n_s_per_m = 1.0;
constexpr double kMostSideShare = 0.5;  // of the force

constexpr double kUnbraked_j = 0.1e-3;   // from an undeclared delay, if there is one
constexpr double kBraked_j = 0.5e-3;     // by the whole brake
constexpr double kSoftening_j = 1.2e-3;  // in spite of the brake
constexpr double kForgotten_w = 0.05e-3;
constexpr double kBounces_s = 1.0;  // a hand that bounces comes back sooner

/// NaN becomes zero.
double between_zero_and(double most, double value) noexcept { return value > 0.0 ? std::min(value, most) : 0.0; }

}  // namespace

DeviceLimits usable(const DeviceLimits& limits) noexcept {
  DeviceLimits result;
  result.max_force_n = between_zero_and(kMostForce_n, limits.max_force_n);
  result.slew_n_per_s = between_zero_and(kMostSlew_n_per_s, limits.slew_n_per_s);
  result.least_damping_n_s_per_m = between_zero_and(kMostDamping_n_s_per_m, limits.least_damping_n_s_per_m);
  result.undeclared_s = between_zero_and(kMostUndeclared_s, limits.undeclared_s);
  result.encoder_step_m = between_zero_and(kMostStep_m, limits.encoder_step_m);
  result.delay_ticks = std::clamp(limits.delay_ticks, 0, kLongestDelayTicks);
  return result;
}

Vector3d deliverable(const Vector3d& force_n, double most_n) noexcept {
  const double magnitude = force_n.norm();
  if (!(magnitude > 0.0) || !std::isfinite(magnitude) || !(most_n > 0.0)) return Vector3d::Zero();
  return clamped(force_n, most_n);
}

double stiffness_limit(const DeviceLimits& limits, double period_s, double delay_s) noexcept {
  const double declared_s = limits.delay_ticks * period_s;
  const double delay = std::max({declared_s, delay_s, kLeastDelay_s});
  return 0.8 * limits.least_damping_n_s_per_m / (0.5 * period_s + delay);
}

double Governor::pace_s(double nominal_period_s) const noexcept {
  const double median_s = recent_periods_.median_s(nominal_period_s);
  const bool slower = median_s > kSlower * nominal_period_s && median_s < nominal_period_s + kNoLoop_s;
  return slower ? median_s : nominal_period_s;
}

/// The 95th percentile of this loop's periods.
double Governor::slow_period_s(double nominal_period_s) const noexcept {
  const double recent_s = recent_periods_.p95_s(nominal_period_s);
  const double lasting_s = periods_.p95_s(nominal_period_s);
  return std::max(nominal_period_s, recent_s > kAnotherRate * lasting_s ? recent_s : lasting_s);
}

double Governor::stiffness(double wish_n_per_m, double nominal_period_s, double look_s) noexcept {
  const double slow_s = std::max(slow_period_s(nominal_period_s), look_s);
  const double period_s = slow_s >= kJitter * nominal_period_s ? slow_s : nominal_period_s;
  // This is called each tick, also between two looks of a slow device.
  const double tick_s = std::min(ticks_.median_s(nominal_period_s), pace_s(nominal_period_s));
  const double limit = limit_n_per_m_ = stiffness_limit(limits_, period_s, delays_.p95_s(0.0));
  const double target = borne_share_ * (wish_n_per_m > 0.0 ? std::min(wish_n_per_m, limit) : 0.0);
  if (wish_n_per_m != wish_n_per_m_) {
    wished_s_ = 0.0;
    falling_ = true;  // a lower wish counts however little lower it is
  }
  wish_n_per_m_ = wish_n_per_m;
  if (stiffness_n_per_m_ < 0.0 || !in_contact_) {
    stiffness_n_per_m_ = target;
    wished_s_ = kWish_s;
  } else if (wished_s_ < kWish_s && stiffness_n_per_m_ <= borne_share_ * limit) {
    // A changed wish is followed smoothly, without a jump of force. What the loop does not bear goes at once, below.
    const double left = 1.0 - smooth_step(wished_s_ / kWish_s);
    wished_s_ = std::min(kWish_s, wished_s_ + tick_s);
    stiffness_n_per_m_ += (target - stiffness_n_per_m_) * (1.0 - (1.0 - smooth_step(wished_s_ / kWish_s)) / left);
  } else if (target < (falling_ ? 1.0 : kSameLimit) * stiffness_n_per_m_) {
    // Softened faster than a heavy hand can follow, the wall would set it swinging.
    const double time_s = std::max(kSoften_s, kSoftenSwings * swing_.half_period_s());
    stiffness_n_per_m_ += (target - stiffness_n_per_m_) * std::min(1.0, tick_s / time_s);
    falling_ = target < kReached * stiffness_n_per_m_;
  } else {
    falling_ = false;
  }
  return stiffness_n_per_m_;
}

void Governor::disarm() noexcept {
  armed_ = false;
  free_s_ = 0.0;
}

GovernorOutput Governor::forget() noexcept {
  has_last_ = false;
  gap_s_ = 0.0;
  gap_n_.setZero();
  energy_j_ = std::min(energy_j_, 0.0);
  return command(Vector3d::Zero(), false);
}

void Governor::stop() noexcept {
  static_cast<void>(forget());
  disarm();
}

/// The force of before goes on until the hand is stale, less what the spring would lose if the hand goes on leaving as
/// it did last. Until the command of this tick arrives, the device holds an older one.
GovernorOutput Governor::without_news(const GovernorInput& input) noexcept {
  const Vector3d& held_n = commanded_n_[delay()];
  if (gap_s_ == 0.0) gap_least_n_ = held_n.norm();
  gap_s_ += input.period_s;
  unseen_s_ += input.period_s;
  if (held_n.squaredNorm() > gap_n_.squaredNorm()) gap_n_ = held_n;
  Vector3d next_n = Vector3d::Zero();
  const double last = commanded_n_[0].norm();
  const bool stale = !input.fresh && gap_s_ >= stale_after_s(pace_s(input.nominal_period_s));
  if (armed_ && !stale && last > 0.0) {
    const double out_m_per_s = velocity().dot(commanded_n_[0]) / last;
    const double lost_n = input.stiffness_n_per_m * out_m_per_s * input.period_s;
    next_n = commanded_n_[0] * std::clamp(1.0 - lost_n / last, 0.0, 1.0);
  }
  gap_least_n_ = std::min({gap_least_n_, held_n.norm(), next_n.norm()});
  return command(next_n, false);
}

void Governor::count_free_time(const GovernorInput& input) noexcept {
  free_s_ = input.contact ? 0.0 : free_s_ + std::min(gap_s_ + input.period_s, pace_s_);
  if (free_s_ < kArming_s) return;
  armed_ = true;
  if (input.guided) return;
  energy_j_ = 0.0;
  if (free_s_ > kBounces_s) late_.reset();
}

/// The smallest move of the last one to two seconds is taken for the encoder's step.
void Governor::learn_step(double moved_m, double period_s) noexcept {
  constexpr double kLeast_m = 1e-6;
  constexpr double kMost_m = 100e-6;
  learning_s_ += std::min(period_s, 0.01);
  if (moved_m > kLeast_m && moved_m < kMost_m && (least_moves_m_[0] == 0.0 || moved_m < least_moves_m_[0]))
    least_moves_m_[0] = moved_m;
  if (learning_s_ < 1.0) return;
  learning_s_ = 0.0;
  if (least_moves_m_[0] > 0.0)
    step_m_ = least_moves_m_[1] > 0.0 ? std::min(least_moves_m_[0], least_moves_m_[1]) : least_moves_m_[0];
  least_moves_m_[1] = least_moves_m_[0];
  least_moves_m_[0] = 0.0;
}

void Governor::damp() noexcept {
  if (!damping_) {
    damping_s_ = 0.0;
    damped_m_ = HUGE_VAL;
  }
  damping_ = true;
}

void Governor::soften() noexcept {
  wished_s_ = kWish_s;
  borne_share_ = std::max(kSoftest, kSofter * borne_share_);
  damping_s_ = 0.0;
}

/// A hand that comes back from the wall as fast as it went in, again and again, is thrown by it.
void Governor::watch_strike(double speed_m_per_s, double away_s) noexcept {
  const bool thrown = contact_s_ < kThrown_s && away_s < kFlight_s && speed_m_per_s > kRestitution * struck_m_per_s_;
  throws_ = thrown && speed_m_per_s > kStrike_m_per_s ? throws_ + 1 : 0;
  struck_m_per_s_ = speed_m_per_s;
  if (speed_m_per_s > kStrike_m_per_s) damp();
  if (throws_ < kMostThrows) return;
  throws_ = 0;
  unstable_ = true;
  soften();
}

/// Delays that the device no longer measures though a force acts are forgotten in free space.
void Governor::watch_delay(const GovernorInput& input) noexcept {
  if (input.delay_s > 0.0) {
    delays_.add(input.delay_s);
    unmeasured_s_ = 0.0;
    return;
  }
  // A device that measures while a force acts tells nothing in the air.
  if (!commanded_n_[delay()].isZero(0.0)) unmeasured_s_ += input.period_s;
  if (unmeasured_s_ > kMeasuredFor_s && !input.contact && delays_.p95_s(0.0) > 0.0) delays_ = {};
}

/// Strikes and growing swings: both get damping until they are calm, a growing swing a softer wall besides.
void Governor::watch_hand(const GovernorInput& input) noexcept {
  const Vector3d moved_m = has_last_ ? Vector3d(input.position_m - last_position_m_) : Vector3d::Zero();
  const double since_last_s = gap_s_ + input.period_s;
  const double period_s = std::max(since_last_s, 0.1 * input.nominal_period_s);
  motion_.add(input.position_m, has_last_ ? period_s : 0.0);
  learn_step(moved_m.norm(), period_s);
  const double seen_s = std::exchange(unseen_s_, 0.0) + input.period_s;
  periods_.add(seen_s);
  recent_periods_.add(seen_s);
  watch_delay(input);
  in_contact_ = input.contact;
  if (input.contact) {
    const bool comes = away_s_ > 0.005;
    if (away_s_ > kBounce_s || axis_.isZero(0.0)) {
      swing_.reset();
      axis_ = input.normal;
    }
    const double away_s = std::exchange(away_s_, 0.0);
    // A mean normal: along it the rise and fall of what is stroked shows.
    axis_ += (input.normal - axis_) * std::min(1.0, period_s / kAxis_s);
    if (comes) watch_strike(-velocity().dot(input.normal), away_s);
    contact_s_ = comes ? 0.0 : contact_s_ + period_s;
  } else {
    away_s_ += std::min(period_s, 2.0 * pace_s_);
    borne_share_ = std::min(1.0, borne_share_ + std::min(period_s, pace_s_) / kForget_s);
    if (away_s_ > kBounce_s) damping_ = unstable_ = released_ = false;
  }
  const Vector3d surface_m = has_last_ ? Vector3d(input.proxy_m - last_proxy_m_) : Vector3d::Zero();
  last_proxy_m_ = input.proxy_m;
  using Finding = SwingDetector::Finding;
  Finding finding = Finding::none;
  if (away_s_ <= kBounce_s)
    finding = swing_.update(period_s, moved_m.dot(axis_), input.contact ? surface_m.dot(axis_) : 0.0,
                            input.contact ? surface_m.norm() : 0.0, step_m_, {released_, jitters_});
  if (finding != Finding::none) damp();
  if (finding == Finding::lasting && released_) unstable_ = true;  // it would begin again
  if (finding == Finding::growing) {
    soften();
    unstable_ = true;
  }
  if (!damping_) return;
  damping_s_ += std::min(period_s, 0.01);
  if (damping_s_ > kPatience_s) {
    const double large_m = std::max(kLarge_m, kLargeSteps * step_m_);
    if (unstable_ && swing_.quiet_s() < kCalm_s && swing_.size_m() > std::max(large_m, kDecay * damped_m_)) soften();
    damping_s_ = 0.0;
    damped_m_ = swing_.size_m();
  }
  if (input.contact && !unstable_ && swing_.quiet_s() > kCalm_s) {
    damping_ = false;
    released_ = true;
  }
}

Vector3d Governor::velocity() const noexcept {
  return motion_.velocity(step_m_ > 0.0 ? step_m_ : kLikelyEncoderStep_m);
}

/// Takes from the force where the hand moves out, never below zero: the wall returns less energy than it received. A
/// hand that has swung is braked along the surface too: on bumps the wall's side forces come as late as its normal
/// ones.
Vector3d Governor::damped(const GovernorInput& input) const noexcept {
  const double magnitude_n = input.force_n.norm();
  if (!damping_ || !(magnitude_n > 0.0)) return input.force_n;
  const double half_s = swing_.half_period_s() > 0.0 ? swing_.half_period_s() : kFirstHalfPeriod_s;
  const double damping = 2.0 * kDampingRatio * input.stiffness_n_per_m * half_s / std::numbers::pi;
  const Vector3d along = input.force_n / magnitude_n;
  const Vector3d hand_m_per_s = velocity();
  const double out = hand_m_per_s.dot(along);
  const double moving_out = out - kDeadSteps * step_m_ / AdaptiveVelocity::kLongest_s;
  Vector3d force_n = input.force_n;
  if (moving_out > 0.0) force_n *= std::max(0.0, 1.0 - damping * moving_out / magnitude_n);
  if (unstable_)
    force_n -= clamped(kSideDamping_n_s_per_m * (hand_m_per_s - out * along), kMostSideShare * force_n.norm());
  return force_n;
}

/// What would have come from a later loop is forgotten as slowly as nobody feels it; of much of it the wall becomes
/// softer, since then a brake has not been enough.
void Governor::watch_late_loop() noexcept {
  late_.forgive(kForgotten_w * pace_s_);
  if (late_.debt_j() < kSoftening_j) return;
  late_.forgive(kSoftening_j - kBraked_j);
  soften();
}

/// How much later than it declares the loop may be: by what it measures beyond that, and by what nobody can measure.
double Governor::late_s() const noexcept {
  return std::max(0.0, delays_.p95_s(0.0) - limits_.delay_ticks * pace_s_) + limits_.undeclared_s;
}

/// Takes from the force where the hand moves out what an undeclared delay would add there and on the way in. More would
/// chatter at the encoder's steps.
Vector3d Governor::braked(const Vector3d& force_n, double stiffness_n_per_m) const noexcept {
  const double share = smooth_step((late_.debt_j() - kUnbraked_j) / (kBraked_j - kUnbraked_j));
  const double magnitude_n = force_n.norm();
  if (!(share > 0.0) || !(magnitude_n > 0.0)) return force_n;
  const double out_m_per_s = velocity().dot(force_n) / magnitude_n - step_m_ / AdaptiveVelocity::kLongest_s;
  if (!(out_m_per_s > 0.0)) return force_n;
  const double less_n = share * 2.0 * late_s() * stiffness_n_per_m * out_m_per_s;
  return force_n * std::max(0.0, 1.0 - less_n / magnitude_n);
}

/// Growth beyond the slew limit is cut. Whatever lies between zero and the last force is a decrease and free.
Vector3d Governor::slewed(const Vector3d& force_n, double period_s) const noexcept {
  const Vector3d& last = commanded_n_[0];
  const double squared = last.squaredNorm();
  const double share = squared > 0.0 ? std::clamp(force_n.dot(last) / squared, 0.0, 1.0) : 0.0;
  const Vector3d from = share * last;
  return from + clamped(force_n - from, limits_.slew_n_per_s * period_s);
}

GovernorOutput Governor::command(const Vector3d& force_n, bool saturated, const Vector3d& effects_n) noexcept {
  for (std::size_t k = kLongestDelay; k > 0; --k) commanded_n_[k] = commanded_n_[k - 1];
  commanded_n_[0] = force_n;
  surface_n_ = force_n - effects_n;
  late_.command(surface_n_);
  return {force_n, saturated, armed_, energy_j_};
}

GovernorOutput Governor::update(const GovernorInput& input) noexcept {
  const bool finite = input.position_m.allFinite() && input.force_n.allFinite() &&
                      std::isfinite(input.spring_energy_j) && std::isfinite(input.supplied_j) &&
                      input.stiffness_n_per_m >= 0.0 && input.proxy_m.allFinite() && input.normal.allFinite();
  if (!finite) disarm();
  if (!finite || !(input.period_s > 0.0) || !(input.nominal_period_s > 0.0)) return forget();
  ticks_.add(input.period_s);
  if (input.repeated && !repeats_) periods_ = {}, recent_periods_ = {};  // of repeats that were taken for looks
  repeats_ = repeats_ || input.repeated;
  if (!input.fresh || input.repeated) return without_news(input);
  pace_s_ = pace_s(input.nominal_period_s);
  jitters_ = slow_period_s(input.nominal_period_s) >= kJitter * pace_s_;
  count_free_time(input);
  watch_hand(input);
  observe_energy(input);
  if (!armed_) return command(Vector3d::Zero(), false);
  watch_late_loop();
  const Vector3d most = clamped(braked(damped(input), input.stiffness_n_per_m), limits_.max_force_n);
  const Vector3d grown = slewed(most, std::min(input.period_s, pace_s_));
  const Vector3d safe = deliverable(passive(input, eased(input, tapered(input, grown))), limits_.max_force_n);
  // Effects are not a spring's: a later loop moves them along the stone, and that alone is no energy of the surface.
  const double wished = input.force_n.norm();
  const double given = wished > 0.0 ? std::min(1.0, safe.norm() / wished) : 0.0;
  return command(safe, safe != input.force_n, given * input.effects_n);
}

}  // namespace sparsha::haptics
