#include "haptics/servo/real_time.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

namespace sparsha::haptics {
namespace {

// Where the system has it, the clock that counts the time of a suspended machine too: a servo that wakes after an hour
// must know.
#ifdef CLOCK_BOOTTIME
constexpr clockid_t kClock = CLOCK_BOOTTIME;
#else
constexpr clockid_t kClock = CLOCK_MONOTONIC;
#endif

}  // namespace

std::int64_t now_ns() noexcept {
  timespec time{};
  clock_gettime(kClock, &time);
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

void sleep_until_ns(std::int64_t time_ns) noexcept {
  timespec time{};
  time.tv_sec = static_cast<time_t>(time_ns / 1'000'000'000);
  time.tv_nsec = static_cast<long>(time_ns % 1'000'000'000);
  while (clock_nanosleep(kClock, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

bool request_real_time(int priority) noexcept {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
}

bool lock_memory() noexcept {
  // Under a finite limit, later allocations of the whole process would fail once it is reached: rather not lock.
  rlimit limit{};
  if (geteuid() != 0 && (getrlimit(RLIMIT_MEMLOCK, &limit) != 0 || limit.rlim_cur != RLIM_INFINITY)) return false;
#ifdef MCL_ONFAULT
  return mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0;  // big scenes stay on disk until they are touched
#else
  return mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
#endif
}

void touch_stack() noexcept {
  constexpr std::size_t kBytes = 128 * 1024;
  volatile unsigned char pages[kBytes];
  for (std::size_t i = 0; i < kBytes; i += 1024) pages[i] = 0;
  static_cast<void>(pages[0]);
}

}  // namespace sparsha::haptics
