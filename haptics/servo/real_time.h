// What the servo needs of a POSIX system: an absolute clock, real-time scheduling, locked memory. All of it is in
// real_time.cpp.
#pragma once

#include <cstdint>
#include <functional>

namespace sparsha::haptics {

/// Monotonic time, nanoseconds, which goes on while the machine is suspended.
[[nodiscard]] std::int64_t now_ns() noexcept;
/// Sleeps until that clock shows `time_ns`; returns at once when that has passed.
void sleep_until_ns(std::int64_t time_ns) noexcept;

/// Where a servo takes its time from; tests put a clock of their own here. Neither function throws or allocates.
struct ServoClock {
  std::function<std::int64_t()> now_ns = haptics::now_ns;
  std::function<void(std::int64_t)> sleep_until_ns = haptics::sleep_until_ns;
};

inline constexpr int kServoPriority = 80;

/// Asks for SCHED_FIFO for the calling thread; false when the system does not grant it.
[[nodiscard]] bool request_real_time(int priority) noexcept;
/// Asks that pages once touched stay in memory, now and later; false when not granted.
[[nodiscard]] bool lock_memory() noexcept;
/// Touches the calling thread's stack, so that no tick meets its first use.
void touch_stack() noexcept;

}  // namespace sparsha::haptics
