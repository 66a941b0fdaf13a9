// The real-time loop: reads the hand, decides the force, writes it, a thousand times a second and more.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "haptics/device/device.h"
#include "haptics/servo/command.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/servo/histogram.h"
#include "haptics/servo/pace.h"
#include "haptics/servo/publisher.h"
#include "haptics/servo/real_time.h"
#include "haptics/servo/watchdog.h"
#include "haptics/state/seqlock.h"
#include "haptics/state/spsc_queue.h"
#include "haptics/state/state.h"

namespace sparsha::haptics {

struct ServoOptions {
  RendererOptions renderer;  ///< its longest gap is the watchdog's patience too, but never below two periods
  bool real_time = true;     ///< ask for SCHED_FIFO and locked memory
  ServoClock clock;          ///< the servo's; the watchdog has its own
};

/// Read after stop().
struct ServoFigures {
  std::uint64_t ticks = 0;
  std::uint64_t missed_ticks = 0;
  std::uint64_t faults = 0;       ///< ticks with NaN, unplugging, lateness or after the watchdog has tripped
  std::uint64_t late_faults = 0;  ///< pauses beyond the patience that the servo itself noticed
  std::uint64_t runaways = 0;     ///< ticks that a device's wait() asked for far sooner than planned
  std::uint64_t jumps = 0;        ///< positions that no hand can have come to
  std::uint64_t watchdog_trips = 0;
  std::uint64_t ticks_in_time = 0;  ///< begun within 1 ms of plan
  double share_in_time = 1.0;       ///< of all ticks, missed ones in the count
  bool real_time = false;           ///< SCHED_FIFO was granted
  bool locked_memory = false;
  double swap_ns_max = 0.0;  ///< longest command
  TimeHistogram tick_ns;
  LatenessHistogram lateness;

  /// Counts one tick; `paced` false: its time was no plan's. Servo thread.
  void count(std::int64_t took_ns, std::int64_t late_ns, bool paced = true) noexcept;
};

/// One thread calls start(), post(), collect() and stop(); the servo's own thread does the rest.
class Servo {
 public:
  /// `device`, `state`, `consumers` and `recorder` outlive the servo. `recorder` may be null.
  Servo(Device& device, const ServoOptions& options, HapticWindow window, Seqlock<State>& state,
        std::vector<std::shared_ptr<ContactQueue>> consumers, RecordSink* recorder);
  ~Servo();
  Servo(const Servo&) = delete;
  Servo& operator=(const Servo&) = delete;

  void start();
  /// Ends in zero force.
  void stop();

  /// False when the queue is full; the command is then unchanged.
  [[nodiscard]] bool post(Command&& command) noexcept { return commands_.push(std::move(command)); }
  /// Frees what the servo has retired.
  void collect() noexcept;

  /// The device has no more samples.
  [[nodiscard]] bool finished() const noexcept { return finished_.load(std::memory_order_acquire); }
  /// Whether the thread has asked for real time, and what came of it.
  [[nodiscard]] bool asked_for_real_time() const noexcept { return asked_.load(std::memory_order_acquire); }
  [[nodiscard]] bool real_time() const noexcept { return real_time_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool locked_memory() const noexcept { return locked_.load(std::memory_order_relaxed); }
  /// Ticks with a fault so far.
  [[nodiscard]] std::uint64_t faults() const noexcept { return faults_.load(std::memory_order_relaxed); }
  /// Ticks so far whose position was not a number.
  [[nodiscard]] std::uint64_t bad_positions() const noexcept { return bad_positions_.load(std::memory_order_relaxed); }
  /// Ticks so far that the device asked for far too soon, without force (Pace).
  [[nodiscard]] std::uint64_t runaways() const noexcept { return runaways_.load(std::memory_order_relaxed); }
  /// Positions so far that no hand can have come to (DeviceInfo::fastest_m_per_s).
  [[nodiscard]] std::uint64_t jumps() const noexcept { return jumps_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t watchdog_trips() const noexcept { return watchdog_.trips(); }
  /// Pauses so far that ended the force: seen by the watchdog or, where that slept too, by the servo itself.
  [[nodiscard]] std::uint64_t silences() const noexcept {
    return watchdog_.trips() + late_faults_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] bool unplugged() const noexcept { return unplugged_.load(std::memory_order_relaxed); }
  /// Only after stop().
  [[nodiscard]] const ServoFigures& figures() const noexcept { return figures_; }

 private:
  void run() noexcept;
  void prepare_thread() noexcept;
  void run_by_the_clock() noexcept;
  void wait_until(std::int64_t planned_ns) noexcept;
  void run_paced() noexcept;
  void watched_tick(std::int64_t planned_ns, std::int64_t woke_ns, double time_s) noexcept;
  void tick(std::int64_t late_ns, double time_s, bool late_wake) noexcept;
  void take_commands() noexcept;
  [[nodiscard]] bool is_late(std::int64_t time_ns) const noexcept;
  void stop_force() noexcept;
  void deliver(const std::array<double, 3>& force_n) noexcept;
  void publish() noexcept;

  Device& device_;
  ServoOptions options_;
  double period_s_;
  std::int64_t period_ns_;
  std::int64_t patience_ns_;
  double most_force_n_;          // of the device
  bool planned_time_;            // the device's time is the plan's
  bool own_clock_;               // or that of a recording, which is played at its own rate
  std::int64_t decided_ns_ = 0;  // when the last force was decided
  bool has_decided_ = false;
  bool tripped_ = false;  // the watchdog has, when this tick began
  Pace pace_;
  HandSpeed hand_speed_;
  HapticRenderer renderer_;
  Publisher publisher_;
  Watchdog watchdog_;
  CommandQueue commands_{64};
  RetiredQueue retired_{128};
  Command command_;         // the one being carried out
  SurfacePointer leaving_;  // waiting for room in the queue of retired surfaces
  ServoFigures figures_;
  std::atomic<bool> stopping_{false};
  std::atomic<bool> finished_{false};
  std::atomic<bool> asked_{false};
  std::atomic<bool> real_time_{false};
  std::atomic<bool> locked_{false};
  std::atomic<bool> unplugged_{false};
  std::atomic<std::uint64_t> faults_{0};
  std::atomic<std::uint64_t> bad_positions_{0};
  std::atomic<std::uint64_t> late_faults_{0};
  std::atomic<std::uint64_t> runaways_{0};
  std::atomic<std::uint64_t> jumps_{0};
  std::thread thread_;
};

}  // namespace sparsha::haptics
