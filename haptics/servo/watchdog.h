// Zero force when the servo falls silent: a thread of its own, with a higher priority than the servo's.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "haptics/device/device.h"

namespace sparsha::haptics {

class Watchdog {
 public:
  /// Calls device.zero() once the servo has been silent for `silence_s`, and again after 2, 4, 8 ms
  /// and then every `silence_s` until it speaks.
  explicit Watchdog(Device& device, double silence_s = 0.010);
  ~Watchdog();
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  /// Watches from the first feed() on: a servo that still asks for memory holds no force. `priority` > 0 asks for
  /// SCHED_FIFO.
  void start(int priority);
  void stop();

  /// Servo thread: a sign of life.
  void feed(std::int64_t time_ns) noexcept { fed_ns_.store(time_ns, std::memory_order_relaxed); }
  /// Servo thread: has it acted since the last acknowledge()? Its zero must not be overwritten by an old force.
  [[nodiscard]] bool tripped() const noexcept { return tripped_.load(std::memory_order_acquire); }
  void acknowledge() noexcept { tripped_.store(false, std::memory_order_release); }
  [[nodiscard]] std::uint64_t trips() const noexcept { return trips_.load(std::memory_order_relaxed); }

 private:
  void run(int priority);

  Device& device_;
  std::int64_t silence_ns_;
  std::atomic<std::int64_t> fed_ns_{0};
  std::atomic<bool> tripped_{false};
  std::atomic<bool> stopping_{false};
  std::atomic<std::uint64_t> trips_{0};
  std::thread thread_;
};

}  // namespace sparsha::haptics
