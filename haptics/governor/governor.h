// Between the renderer's force and the hand: stiffness limit, clamp, slew, passivity, arming.
// Servo thread only; no allocation, no exceptions. Device frame, newtons, metres, seconds.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "haptics/governor/adaptive_velocity.h"
#include "haptics/governor/late_loop.h"
#include "haptics/governor/loop_meter.h"
#include "haptics/governor/swing.h"

namespace sparsha::haptics {

inline constexpr int kLongestDelayTicks = 4;
/// Energy that a contact may deliver before it has received any, joules: less than a touch feels.
inline constexpr double kOverdraft_j = 50e-6;

/// A hand without news for so long is stale, and its force zero. Until then the force of before goes on, as it does
/// over a tick that never comes: one answer in ten that is lost would shake the hand otherwise.
inline constexpr double kStale_s = 0.007;
/// Three samples of a slow device are older than that already: of its samples as many must be missing as at a
/// kilohertz, or a few that are lost in a row would take the force from a hand that rests.
inline constexpr double kStaleTicks = 7.0;
/// `pace_s`: between two samples that came.
[[nodiscard]] constexpr double stale_after_s(double pace_s) noexcept {
  return std::max(kStale_s, kStaleTicks * pace_s);
}
/// Without news for so many samples, and no less than RendererOptions::longest_gap_s, nobody knows where the hand is.
inline constexpr double kLongestGapTicks = 10.0;

/// What a device can bear.
struct DeviceLimits {
  double max_force_n = 8.0;
  double least_damping_n_s_per_m = 2.0;  ///< least damping of hand and device
  double slew_n_per_s = 1500.0;          ///< growth of force
  int delay_ticks = 1;                   ///< a force reaches the hand this many ticks after it was written, 0 to 4
  /// Delay beyond the declared and the measured one that cannot be ruled out, 0 to 4 ms: of what a hand would get from
  /// it, the governor brakes. 0 for a loop that is known, such as a simulated one.
  double undeclared_s = 0.002;
  /// Longest move of the hand that one count on every encoder at once may seem, m; 0: not known. Shorter moves say
  /// nothing about how often the device looks at the hand (LookMeter).
  double encoder_step_m = 0.0;
};

/// The same with every number in the range of things that hands hold: what is not a number, negative or absurd becomes
/// the safe end (no force, no damping, no growth). Whoever takes limits from outside goes through here.
[[nodiscard]] DeviceLimits usable(const DeviceLimits& limits) noexcept;

/// The last clamp before any device: at most `most_n` long, direction kept; zero when the force or the limit is not a
/// number.
[[nodiscard]] Eigen::Vector3d deliverable(const Eigen::Vector3d& force_n, double most_n) noexcept;

/// 0.8 b / (T / 2 + delay): below where a sampled wall goes unstable (0.8 since at the edge itself decay takes
/// minutes). The delay is the declared or the measured one, whichever is longer, and never below a millisecond.
[[nodiscard]] double stiffness_limit(const DeviceLimits& limits, double period_s, double delay_s = 0.0) noexcept;

/// What the renderer may use of the stiffness that the user wishes, N/m.
[[nodiscard]] inline double governed_stiffness(double requested_n_per_m, const DeviceLimits& limits,
                                               double period_s) noexcept {
  return std::min(requested_n_per_m, stiffness_limit(limits, period_s));
}

struct GovernorInput {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();     ///< the renderer's, at the governed stiffness
  Eigen::Vector3d effects_n = Eigen::Vector3d::Zero();   ///< of force_n, what is felt besides the surface
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< measured hand position
  Eigen::Vector3d proxy_m = Eigen::Vector3d::Zero();     ///< device frame; the hand itself when free
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();      ///< of the surface there, unit; zero when free
  double stiffness_n_per_m = 0.0;                        ///< that the force was rendered with
  double delay_s = 0.0;                                  ///< that the device measured; 0 = it does not measure
  double spring_energy_j = 0.0;                          ///< 0.5 k |X_p - X_h|^2, device frame
  /// What a guide has put into the springs of spring_energy_j since the last tick by moving them: the hand may have it.
  double supplied_j = 0.0;
  double period_s = 0.001;          ///< since the last tick
  double nominal_period_s = 0.001;  ///< of the servo's plan
  bool fresh = true;                ///< the position is new and finite
  bool repeated = false;            ///< and yet no news: what the device saw a look ago (LookMeter)
  bool contact = false;
  /// The surface may give way under a contact, or another one come: what the spring holds is not what the hand has put
  /// in, and the force is to become less before that is used up, and to come back as smoothly.
  bool gives_way = false;
  bool guided = false;  ///< a guide adds to the force: energy is observed in free space too
};

struct GovernorOutput {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  bool saturated = false;  ///< clamp, slew or passivity changed the force
  bool armed = false;
  double energy_j = 0.0;  ///< observed: negative means energy was delivered to the hand
};

/// The steps of docs/touch.md, "Governor", in that order. The passivity observer (Hannaford & Ryu 2002) counts
/// energy anew for each contact after 50 ms in free space.
class Governor {
 public:
  explicit Governor(const DeviceLimits& limits) noexcept : limits_(usable(limits)) {}
  [[nodiscard]] GovernorOutput update(const GovernorInput& input) noexcept;
  /// What the renderer may use of a wished stiffness now, N/m: no more than the measured loop bears and no more than
  /// the hand has shown to bear. In contact it falls within a few swings and rises only with the wish. Call before each
  /// update(). `look_s`: between two looks of a device that repeats without saying so; 0: there are no such.
  [[nodiscard]] double stiffness(double wish_n_per_m, double nominal_period_s, double look_s = 0.0) noexcept;
  /// How long a tick of this loop lasts: as planned, or the median of the measured ones where the loop is steadily
  /// slower. All time constants count a tick as no more, so that a gap earns nothing: no growth of force, no free time,
  /// no credit. Of the ticks before this one.
  [[nodiscard]] double pace_s(double nominal_period_s) const noexcept;
  /// The ticks before this one scattered: their 95th percentile was beyond the pace.
  [[nodiscard]] bool jitters() const noexcept { return jitters_; }
  /// Of the loop as planned or as measured, before what this hand has shown to bear; 0 before the first stiffness().
  [[nodiscard]] double limit_n_per_m() const noexcept { return limit_n_per_m_; }
  /// After start, fault or homing: force comes back only after 50 ms in free space.
  void disarm() noexcept;
  /// The same, and what was known of the hand is forgotten: a force that was commanded in this tick does not count.
  void stop() noexcept;
  /// Offline rendering needs no arming.
  void arm() noexcept { armed_ = true; }
  /// The encoder's step as far as it has shown, m; 0 before the first second has passed.
  [[nodiscard]] double encoder_step_m() const noexcept { return step_m_; }
  /// Of the hand, device frame, as far as the encoder tells.
  [[nodiscard]] Eigen::Vector3d velocity() const noexcept;

 private:
  static constexpr std::size_t kLongestDelay = kLongestDelayTicks;

  [[nodiscard]] double slow_period_s(double nominal_period_s) const noexcept;
  [[nodiscard]] GovernorOutput without_news(const GovernorInput& input) noexcept;
  [[nodiscard]] GovernorOutput forget() noexcept;
  void watch_hand(const GovernorInput& input) noexcept;
  void watch_strike(double speed_m_per_s, double away_s) noexcept;
  void watch_delay(const GovernorInput& input) noexcept;
  void damp() noexcept;
  void soften() noexcept;
  void learn_step(double moved_m, double period_s) noexcept;
  void watch_late_loop() noexcept;
  [[nodiscard]] Eigen::Vector3d braked(const Eigen::Vector3d& force_n, double stiffness_n_per_m) const noexcept;
  [[nodiscard]] Eigen::Vector3d damped(const GovernorInput& input) const noexcept;
  void count_free_time(const GovernorInput& input) noexcept;
  void observe_energy(const GovernorInput& input) noexcept;
  [[nodiscard]] double late_s() const noexcept;
  void observe_late_loop(const GovernorInput& input, const Eigen::Vector3d& held_n, double stored_j) noexcept;
  [[nodiscard]] Eigen::Vector3d slewed(const Eigen::Vector3d& force_n, double period_s) const noexcept;
  [[nodiscard]] Eigen::Vector3d tapered(const GovernorInput& input, const Eigen::Vector3d& force_n) const noexcept;
  [[nodiscard]] Eigen::Vector3d passive(const GovernorInput& input, const Eigen::Vector3d& force_n) const noexcept;
  [[nodiscard]] Eigen::Vector3d eased(const GovernorInput& input, const Eigen::Vector3d& force_n) const noexcept;
  [[nodiscard]] double balance_j() const noexcept;
  struct Range {
    double least_n, most_n;
  };
  [[nodiscard]] Range smooth_range(const GovernorInput& input) const noexcept;
  /// `effects_n`: of the force, what is felt besides the surface.
  [[nodiscard]] GovernorOutput command(const Eigen::Vector3d& force_n, bool saturated,
                                       const Eigen::Vector3d& effects_n = Eigen::Vector3d::Zero()) noexcept;
  [[nodiscard]] std::size_t delay() const noexcept { return static_cast<std::size_t>(limits_.delay_ticks); }

  DeviceLimits limits_;
  bool armed_ = false;
  double free_s_ = 0.0;
  bool has_last_ = false;
  double gap_s_ = 0.0;     ///< without news of the hand
  double unseen_s_ = 0.0;  // since the last fresh sample, through stops too: the pace of a slow device
  Eigen::Vector3d gap_n_ = Eigen::Vector3d::Zero();  ///< the largest force that the device held meanwhile
  double gap_least_n_ = 0.0;                         ///< and the size of the least
  std::array<Eigen::Vector3d, kLongestDelay + 1> commanded_n_ = zeros();  ///< newest first
  Eigen::Vector3d surface_n_ = Eigen::Vector3d::Zero();                   ///< of the newest, without effects
  Eigen::Vector3d last_position_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d displacement_m_ = Eigen::Vector3d::Zero();
  double damped_j_ = 0.0;
  double last_spring_energy_j_ = 0.0;
  double energy_j_ = 0.0;
  Eigen::Vector3d observed_m_ = Eigen::Vector3d::Zero();  // the hand without the encoder's flicker

  LoopMeter<2048> periods_;  // some seconds: its percentile hardly moves with jitter
  LoopMeter<> recent_periods_;
  LoopMeter<> ticks_;  // with and without news
  LoopMeter<> delays_;
  double unmeasured_s_ = 0.0;  // with a force, since the device told a delay
  double pace_s_ = 0.0;        // of this tick
  bool jitters_ = false;
  bool repeats_ = false;  // the device was found to repeat
  SwingDetector swing_;
  LateLoop late_;
  double wish_n_per_m_ = -1.0;
  double wished_s_ = 1.0;  // since the wish has changed in this contact
  double limit_n_per_m_ = 0.0;
  double stiffness_n_per_m_ = -1.0;  // allowed now; negative before the first tick
  bool falling_ = false;             // on its way to a lower limit
  double borne_share_ = 1.0;         // of the wish, that this hand has shown to bear
  bool in_contact_ = false;
  bool damping_ = false;         // against a strike or a growing swing
  bool unstable_ = false;        // a swing has grown in this contact
  double damping_s_ = 0.0;       // since it began, or since the wall was softened last
  double damped_m_ = 0.0;        // the swing's size then
  bool released_ = false;        // from the damping, in this contact
  double contact_s_ = 0.0;       // of this touch
  double struck_m_per_s_ = 0.0;  // at its beginning
  int throws_ = 0;
  double away_s_ = 0.0;                             // since the last contact
  Eigen::Vector3d axis_ = Eigen::Vector3d::Zero();  // the last normal
  Eigen::Vector3d last_proxy_m_ = Eigen::Vector3d::Zero();
  AdaptiveVelocity motion_;       // of the hand
  double step_m_ = 0.0;           // the encoder's, as far as it has shown
  double least_moves_m_[2] = {};  // of this second and of the last one
  double learning_s_ = 0.0;

  static std::array<Eigen::Vector3d, kLongestDelay + 1> zeros() {
    std::array<Eigen::Vector3d, kLongestDelay + 1> forces;
    forces.fill(Eigen::Vector3d::Zero());
    return forces;
  }
};

}  // namespace sparsha::haptics
