// A loop that only sleeps: what the machine and its scheduler do to any loop of 1 kHz in these very minutes.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>

namespace sparsha::bench {

inline constexpr std::size_t kLateBins = 20;          // of 100 us, the last one open: as `explore --json` counts
inline constexpr std::int64_t kLateBin_ns = 100'000;  // ns
inline constexpr std::int64_t kLoopPeriod_ns = 1'000'000;

struct Lateness {
  std::array<std::uint64_t, kLateBins> bins{};
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0;  ///< periods that passed asleep
  std::int64_t longest_ns = 0;
  bool real_time = false;  ///< SCHED_FIFO was granted

  /// Share of the planned ticks that began within a millisecond of their plan.
  [[nodiscard]] double in_time() const;
};

/// Wakes every millisecond on an absolute clock with the servo's scheduling, one step of priority below it, from
/// construction to stop(). Periods that were slept through are skipped, as the servo skips them.
class BareLoop {
 public:
  BareLoop();
  ~BareLoop();
  BareLoop(const BareLoop&) = delete;
  BareLoop& operator=(const BareLoop&) = delete;
  [[nodiscard]] Lateness stop();

 private:
  std::atomic<bool> over_{false};
  Lateness lateness_;
  std::thread thread_;
};

}  // namespace sparsha::bench
