// POSIX: fork, and futexes where there are some.
#include "base/system/worker.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>

#include "base/error.h"

#if !defined(_WIN32)
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#endif
#if defined(__linux__)
#include <linux/futex.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <climits>
#endif

namespace sparsha::system {

static_assert(std::atomic<std::uint64_t>::is_always_lock_free && sizeof(std::atomic<std::uint32_t>) == 4);

std::int64_t shared_time_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void sleep_until_shared_ns(std::int64_t time_ns) noexcept {
  std::this_thread::sleep_until(std::chrono::steady_clock::time_point(std::chrono::nanoseconds(time_ns)));
}

#if defined(__linux__)

// Not private to a process.
void wait_for_change(const std::atomic<std::uint32_t>& word, std::uint32_t old, double timeout_s) noexcept {
  const std::int64_t until_ns = shared_time_ns() + static_cast<std::int64_t>(std::clamp(timeout_s, 0.0, 3600.0) * 1e9);
  while (word.load(std::memory_order_acquire) == old) {
    const std::int64_t left_ns = until_ns - shared_time_ns();
    if (left_ns <= 0) return;
    const timespec left{static_cast<time_t>(left_ns / 1'000'000'000), static_cast<long>(left_ns % 1'000'000'000)};
    ::syscall(SYS_futex, &word, FUTEX_WAIT, old, &left, nullptr, 0);
  }
}

void wake_waiting(const std::atomic<std::uint32_t>& word) noexcept {
  ::syscall(SYS_futex, &word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
}

#else

constexpr std::chrono::microseconds kPoll{100};

void wait_for_change(const std::atomic<std::uint32_t>& word, std::uint32_t old, double timeout_s) noexcept {
  const std::int64_t until_ns = shared_time_ns() + static_cast<std::int64_t>(std::clamp(timeout_s, 0.0, 3600.0) * 1e9);
  while (word.load(std::memory_order_acquire) == old && shared_time_ns() < until_ns) std::this_thread::sleep_for(kPoll);
}

void wake_waiting(const std::atomic<std::uint32_t>&) noexcept {}

#endif

#if defined(_WIN32)

Worker::Worker(std::size_t, const Work&, const Work&, double, int) {
  throw Error(ErrorKind::failure, {}, "this system has no worker processes", "a POSIX system");
}
Worker::~Worker() = default;

#else

namespace {

using Steady = std::chrono::steady_clock;
constexpr int kLook_ms = 2;
constexpr std::chrono::seconds kGrace{2};  // a worker that was asked to return

[[noreturn]] void fail(const char* what) {
  throw Error(ErrorKind::failure, {}, std::string(what) + " fails: " + std::strerror(errno),
              "a system that lets this program start a process of its own");
}

/// Descriptors 0 to 2 and `end`, as 3: no other file of the program is held open by those that outlive it.
int keep_few(int end) {
  constexpr int kKept = 3;
  const int null = ::open("/dev/null", O_RDWR);
  if (null >= 0) ::dup2(null, 0);
  ::dup2(2, 1);
  if (end != kKept) ::dup2(end, kKept);
#if defined(__linux__)
  if (::close_range(kKept + 1, ~0U, 0) == 0) return kKept;
#endif
  const long most = ::sysconf(_SC_OPEN_MAX);
  for (int other = kKept + 1; other < most; ++other) ::close(other);
  return kKept;
}

void name_process(const char* name) {
#if defined(__linux__)
  ::prctl(PR_SET_NAME, name);
#else
  static_cast<void>(name);
#endif
}

/// In the worker: without its supervisor it is asked to return, and killed where it does not.
void end_without(pid_t supervisor, WorkerHead& head) {
  std::thread([supervisor, &head] {
    while (::getppid() == supervisor) std::this_thread::sleep_for(std::chrono::milliseconds(kLook_ms));
    head.end.store(static_cast<std::uint32_t>(WorkerEnd::unknown));
    head.stop.store(1);
    std::this_thread::sleep_for(kGrace);
    ::kill(::getpid(), SIGKILL);
  }).detach();
}

/// A child that calls `work` and ends. `supervised`: it ends with this process, too.
pid_t start(const Worker::Work& work, void* shared, int priority, bool supervised) {
  const pid_t supervisor = ::getpid();
  const pid_t id = ::fork();
  if (id != 0) return id;
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (priority > 0) static_cast<void>(::sched_setscheduler(0, SCHED_FIFO, &parameters));
  try {
    if (supervised) end_without(supervisor, *static_cast<WorkerHead*>(shared));
    work(shared);
  } catch (...) {
    ::abort();
  }
  ::_exit(0);
}

void wait_or_kill(pid_t id, Steady::duration patience) {
  const Steady::time_point began = Steady::now();
  int status = 0;
  while (::waitpid(id, &status, WNOHANG) == 0) {
    if (Steady::now() - began > patience) ::kill(id, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(kLook_ms));
  }
}

/// Watches over the worker until it has ended; how that was.
WorkerEnd supervise(pid_t worker, WorkerHead& head, int pipe) {
  std::uint64_t beats = 0;
  Steady::time_point heard = Steady::now();
  Steady::time_point asked{};
  for (;;) {
    pollfd ended{pipe, POLLIN, 0};
    if (asked == Steady::time_point{} && ::poll(&ended, 1, kLook_ms) > 0) {
      head.stop.store(1);  // nothing is ever written: the end of the pipe is that of the program, or its wish
      asked = Steady::now();
    } else if (asked != Steady::time_point{}) {
      std::this_thread::sleep_for(std::chrono::milliseconds(kLook_ms));
    }
    int status = 0;
    if (::waitpid(worker, &status, WNOHANG) == worker) {
      if (WIFSIGNALED(status)) head.signal.store(static_cast<std::uint32_t>(WTERMSIG(status)));
      if (WIFSIGNALED(status) || WEXITSTATUS(status) != 0) return WorkerEnd::crashed;
      return head.stop.load() != 0 ? WorkerEnd::returned : WorkerEnd::unknown;
    }
    const Steady::time_point now = Steady::now();
    if (head.beats.load() != beats) {
      beats = head.beats.load();
      heard = now;
    }
    const auto patience = std::chrono::milliseconds(head.hangs_after_ms.load());
    const bool hangs = patience.count() > 0 && now - heard > patience;
    if (hangs || (asked != Steady::time_point{} && now - asked > kGrace)) {
      ::kill(worker, SIGKILL);
      ::waitpid(worker, &status, 0);
      return WorkerEnd::hung;
    }
  }
}

[[noreturn]] void be_the_supervisor(int end, void* shared, const Worker::Work& work, const Worker::Work& rescue,
                                    double rescue_s, int priority) {
  ::setsid();
  for (int number = 1; number < NSIG; ++number) ::signal(number, SIG_DFL);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGUSR1, SIGUSR2, SIGALRM})
    ::signal(number, SIG_IGN);
  end = keep_few(end);
  name_process("sparsha-plugin");
  WorkerHead& head = *static_cast<WorkerHead*>(shared);
  const pid_t worker = start(work, shared, priority, true);
  const WorkerEnd how = worker < 0 ? WorkerEnd::crashed : supervise(worker, head, end);
  head.end.store(static_cast<std::uint32_t>(how));
  if (how != WorkerEnd::returned && head.rescue.load() != 0) {
    const pid_t rescuer = start(rescue, shared, priority, false);
    if (rescuer > 0)
      wait_or_kill(rescuer, std::chrono::duration_cast<Steady::duration>(std::chrono::duration<double>(rescue_s)));
    head.rescue.store(0);
  }
  ::_exit(0);
}

}  // namespace

Worker::Worker(std::size_t bytes, const Work& work, const Work& rescue, double rescue_s, int priority)
    : bytes_(std::max(bytes, sizeof(WorkerHead))) {
  memory_ = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory_ == MAP_FAILED) fail("shared memory");
  new (memory_) WorkerHead{};
  int ends[2] = {-1, -1};
  if (::pipe(ends) != 0) fail("a pipe");
  for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);
  process_ = ::fork();
  if (process_ == 0) {
    ::close(ends[1]);
    be_the_supervisor(ends[0], memory_, work, rescue, rescue_s, priority);
  }
  ::close(ends[0]);
  pipe_ = ends[1];
  if (process_ < 0) {
    ::close(pipe_);
    ::munmap(memory_, bytes_);
    fail("a process");
  }
}

Worker::~Worker() {
  ::close(pipe_);
  int status = 0;
  while (::waitpid(static_cast<pid_t>(process_), &status, 0) < 0 && errno == EINTR) {
  }
  ::munmap(memory_, bytes_);
}

#endif

}  // namespace sparsha::system
