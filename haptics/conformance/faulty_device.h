// A device between the servo and another one: the other's timing, a hand of its own, and faults on request.
#pragma once

#include <atomic>
#include <cstdint>

#include <Eigen/Core>

#include "haptics/device/device.h"

namespace sparsha::haptics {

/// What a driver, its service or its cable may do.
enum class Fault : std::uint8_t {
  none,
  early,         ///< wait() returns at once, and the position is said to be new
  dead,          ///< wait() returns at once, and nothing is new
  silent,        ///< nothing is new
  late,          ///< one call comes back somewhat later than the servo's patience
  hangs,         ///< one call comes back long after
  not_a_number,  ///< a coordinate is none
  infinite,
  jump,       ///< the hand is somewhere else at once
  unplugged,  ///< `connected` is false
  stopped,    ///< `homed` is false: an emergency stop, encoders that lost their place
  loose,      ///< `connected` is false in every other reading: a plug that does not hold
  own_clock,  ///< its times run nine times too fast, which would excuse that the hand is somewhere else at once
  no_time,    ///< its times are no numbers
  lies,       ///< delay, share of the force and force on the motors are none that can be
  hasty,      ///< a force is said to be at the hand at once, or before it was written
  stuck,      ///< one write() comes back long after
  ended,      ///< `finished` is true
  trembles,   ///< each position is 1 mm from the one before
  repeats,    ///< it looks at the hand every kRepeat_s, and says between that what it tells is new
};

constexpr double kRepeat_s = 0.01;

/// What the servo wrote, as it would have reached a hand.
struct Felt {
  double strongest_n = 0.0;
  double weakest_n = 0.0;    ///< of what was written after the first read since inject()
  double shaken_n = 0.0;     ///< by which the force differs from that of the tick before, the mean of those ticks
  double delivered_j = 0.0;  ///< most that the hand got along z beyond what it gave, from any moment since inject() on
  /// Integral of the hand's squared speed along z over the time in which a force was held: a damper takes so much.
  double square_m2_per_s = 0.0;
  bool finite = true;
  std::uint64_t reads_with_force = 0;  ///< reads since inject() after which a force was written
  double last_force_s = 0.0;           ///< from inject() to the last moment at which a force was held
  double first_zero_s = -1.0;          ///< from inject() to the first zero; negative: none yet
};

/// The hand goes up and down at 0.1 m/s between the air and 2 mm below z = 0. Threads: as for any device; move_to(),
/// inject() and felt() from another.
class FaultyDevice final : public Device {
 public:
  /// `inner` outlives this. `with_force` false: it is only ever told zero. `patience_s`: the servo's.
  FaultyDevice(Device& inner, bool with_force, double patience_s);

  [[nodiscard]] DeviceInfo info() const override;
  void wait(double timeout_s) noexcept override;
  [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override;
  void write(const Eigen::Vector3d& force_n) noexcept override;
  [[nodiscard]] double force_share() const noexcept override;
  void zero() noexcept override;

  void move_to(double height_m) noexcept { wish_m_.store(height_m); }
  /// From the next call on; what is felt is counted anew.
  void inject(Fault fault) noexcept;
  [[nodiscard]] double height_m() const noexcept { return height_m_.load(); }
  [[nodiscard]] double force_n() const noexcept { return force_n_.load(); }
  /// Reads since inject().
  [[nodiscard]] std::uint64_t reads() const noexcept { return reads_.load(); }
  [[nodiscard]] Felt felt() const noexcept;

 private:
  void pause_once() noexcept;
  void note(double force_n) noexcept;
  void account(double z_m, double passed_s) noexcept;
  void compare(double force_n) noexcept;

  Device& inner_;
  bool with_force_;
  bool paced_;
  double patience_s_;
  double time_s_ = 0.0;
  double ahead_s_ = 0.0;  // of the clock of its own
  double looked_s_ = 0.0, told_m_ = 0.0;
  double z_m_ = 0.0, work_j_ = 0.0, least_j_ = 0.0, last_n_ = 0.0, shaken_sum_n_ = 0.0, squares_ = 0.0;
  std::atomic<Fault> fault_{Fault::none};
  std::atomic<bool> paused_{false};  // the one pause has been
  std::atomic<double> wish_m_;
  std::atomic<double> height_m_;
  std::atomic<double> force_n_{0.0};
  std::atomic<std::int64_t> injected_ns_{0};
  std::atomic<std::uint64_t> reads_{0}, reads_with_force_{0};
  std::atomic<unsigned> injections_{0};  // twice their number; odd while one begins
  unsigned read_of_ = 0;                 // injections_ when the last read began
  std::atomic<std::int64_t> last_force_ns_{0}, first_zero_ns_{-1};
  std::atomic<double> strongest_n_{0.0}, weakest_n_{0.0}, shaken_n_{0.0}, delivered_j_{0.0}, held_z_n_{0.0},
      square_m2_per_s_{0.0};
  std::atomic<bool> counted_{false};  // the accounts have begun anew
  std::atomic<bool> finite_{true};
};

}  // namespace sparsha::haptics
