#include "haptics/servo/watchdog.h"

#include <algorithm>
#include <limits>

#include "haptics/servo/real_time.h"

namespace sparsha::haptics {
namespace {

// A zero may get lost, so it is said again; on a slow bus zeros that follow closely keep the servo from its answers.
constexpr std::int64_t kFirstRepeat_ns = 2'000'000;
constexpr std::int64_t kNotYet = std::numeric_limits<std::int64_t>::max() / 2;  // nobody has spoken

}  // namespace

Watchdog::Watchdog(Device& device, double silence_s)
    : device_(device), silence_ns_(static_cast<std::int64_t>(silence_s * 1e9)) {}

Watchdog::~Watchdog() { stop(); }

void Watchdog::start(int priority) {
  stop();
  stopping_.store(false);
  tripped_.store(false);
  feed(kNotYet);
  thread_ = std::thread([this, priority] { run(priority); });
}

void Watchdog::stop() {
  stopping_.store(true);
  if (thread_.joinable()) thread_.join();
}

void Watchdog::run(int priority) {
  if (priority > 0) static_cast<void>(request_real_time(priority));
  bool silent = false;
  std::int64_t repeat_ns = kFirstRepeat_ns;
  while (!stopping_.load(std::memory_order_relaxed)) {
    const std::int64_t now = now_ns();
    const std::int64_t deadline = fed_ns_.load(std::memory_order_relaxed) + silence_ns_;
    if (now < deadline) {
      silent = false;
      repeat_ns = kFirstRepeat_ns;
      sleep_until_ns(std::min(deadline, now + silence_ns_));
      continue;
    }
    tripped_.store(true, std::memory_order_release);
    device_.zero();
    if (!silent) trips_.fetch_add(1, std::memory_order_relaxed);
    silent = true;
    sleep_until_ns(now + repeat_ns);
    repeat_ns = std::min(2 * repeat_ns, silence_ns_);
  }
}

}  // namespace sparsha::haptics
