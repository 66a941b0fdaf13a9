// Work in a child process: pipes, limits and signals of POSIX; in this process on other systems.
#include <atomic>

#include "base/error.h"
#include "base/system.h"

#if !defined(_WIN32)
#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <new>
#include <vector>
#endif
#if defined(__linux__)
#include <sys/prctl.h>
#endif

namespace sparsha::system {

#if defined(_WIN32)

ChildEnd run_in_child(const ChildWork& work, const ChildReceiver& receive, const std::function<void()>& while_waiting,
                      const ChildLimits&) {
  std::atomic<std::uint64_t> step{0};
  work({[&](std::span<const std::byte> bytes) {
          while_waiting();
          receive(bytes);
        },
        step});
  return {{}, step.load()};
}

#else

namespace {

static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "the step is shared between processes");

// What stands before each piece in the pipe: its size, or how the work ended.
constexpr std::uint32_t kReturned = 0xFFFFFFFFU;
constexpr std::uint32_t kOutOfMemory = 0xFFFFFFFEU;
constexpr int kExitOfException = 70;

[[noreturn]] void fail_to_start(const char* what) {
  throw Error(ErrorKind::failure, {}, std::string(what) + " fails: " + std::strerror(errno),
              "a system that lets this program start a process of its own");
}

/// The step counter, in memory that both processes see.
class SharedStep {
 public:
  SharedStep() {
    void* const page = ::mmap(nullptr, sizeof(Counter), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (page == MAP_FAILED) fail_to_start("shared memory");
    counter_ = new (page) Counter{0};
  }
  ~SharedStep() { ::munmap(counter_, sizeof(Counter)); }
  SharedStep(const SharedStep&) = delete;
  SharedStep& operator=(const SharedStep&) = delete;
  std::atomic<std::uint64_t>& operator*() { return *counter_; }

 private:
  using Counter = std::atomic<std::uint64_t>;
  Counter* counter_ = nullptr;
};

class Pipe {
 public:
  Pipe() {
    if (::pipe(ends_) != 0) fail_to_start("a pipe");
    for (const int end : ends_) ::fcntl(end, F_SETFD, FD_CLOEXEC);
  }
  ~Pipe() {
    ::close(ends_[0]);
    close_write_end();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  [[nodiscard]] int read_end() const { return ends_[0]; }
  [[nodiscard]] int write_end() const { return ends_[1]; }
  void close_write_end() {
    if (ends_[1] >= 0) ::close(ends_[1]);
    ends_[1] = -1;
  }

 private:
  int ends_[2] = {-1, -1};
};

/// A child that never outlives this object.
class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  ~Child() { static_cast<void>(stop()); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// The status of a child whose pipe is at its end: one that is ending already keeps its own status.
  int stop() {
    if (id_ <= 0) return status_;
    ::kill(id_, SIGKILL);
    while (::waitpid(id_, &status_, 0) < 0 && errno == EINTR) {
    }
    id_ = 0;
    return status_;
  }

 private:
  pid_t id_;
  int status_ = 0;
};

void limit(int resource, rlim_t most) {
  struct rlimit value {};
  if (::getrlimit(resource, &value) != 0) return;
  value.rlim_cur = value.rlim_max == RLIM_INFINITY ? most : std::min(value.rlim_max, most);
  ::setrlimit(resource, &value);
}

/// Address space of this process, bytes; 0 when unknown.
std::uint64_t address_space_bytes() {
  char text[64] = {};
  const int file = ::open("/proc/self/statm", O_RDONLY);
  if (file < 0) return 0;
  const ssize_t size = ::read(file, text, sizeof text - 1);
  ::close(file);
  return size > 0 ? std::strtoull(text, nullptr, 10) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

/// Signal handlers are the parent's, and so is the terminal: no signal but the child's own faults and SIGKILL ends it.
void leave_signals_to_parent() {
  for (int number = 1; number < NSIG; ++number) ::signal(number, SIG_DFL);
  sigset_t blocked;
  ::sigfillset(&blocked);
  for (const int own : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS, SIGXCPU}) {
    ::sigdelset(&blocked, own);
  }
  ::sigprocmask(SIG_SETMASK, &blocked, nullptr);
}

/// Keeps `out` alone, as descriptor 3. What the library prints, and what exit() would flush, goes nowhere; pipes of
/// other children must not stay open here.
int keep_only(int out) {
  constexpr int kOut = 3;
  out = ::fcntl(out, F_DUPFD, kOut);
  const int null = ::open("/dev/null", O_RDWR);
  for (int standard = 0; standard < kOut; ++standard) ::dup2(null, standard);
  if (out != kOut) ::dup2(out, kOut);
#if defined(__linux__)
  if (::close_range(kOut + 1, ~0U, 0) == 0) return kOut;
#endif
  const long most = ::sysconf(_SC_OPEN_MAX);
  for (int other = kOut + 1; other < most; ++other) ::close(other);
  return kOut;
}

/// Ends the child when nobody reads.
void write_all(int out, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t done = ::write(out, bytes, size);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) ::_exit(kExitOfException);
    bytes += done;
    size -= static_cast<std::size_t>(done);
  }
}

[[noreturn]] void be_the_child(const ChildWork& work, int write_end, std::atomic<std::uint64_t>& step, pid_t parent,
                               const ChildLimits& limits) {
#if defined(__linux__)
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kExitOfException);
#else
  static_cast<void>(parent);
#endif
  leave_signals_to_parent();
  const int out = keep_only(write_end);
  limit(RLIMIT_CORE, 0);
  if (const std::uint64_t taken = address_space_bytes(); taken > 0) limit(RLIMIT_AS, taken + limits.memory_bytes);
#if defined(__linux__)
  ::prctl(PR_SET_DUMPABLE, 0);  // no core either where cores go to a program
#endif
  const auto allow_time = [&] {
    struct rusage used {};
    ::getrusage(RUSAGE_SELF, &used);
    // Both at once: their whole seconds alone may be almost two less than their sum.
    const auto microseconds = used.ru_utime.tv_usec + used.ru_stime.tv_usec;
    const auto whole = used.ru_utime.tv_sec + used.ru_stime.tv_sec + microseconds / 1'000'000;
    limit(RLIMIT_CPU, static_cast<rlim_t>(whole) + limits.seconds + 1);
  };
  std::uint32_t end = kReturned;
  try {
    allow_time();
    work({[&](std::span<const std::byte> bytes) {
            const auto size = static_cast<std::uint32_t>(bytes.size());
            write_all(out, &size, sizeof size);
            write_all(out, bytes.data(), bytes.size());
            allow_time();
          },
          step});
  } catch (const std::bad_alloc&) {
    end = kOutOfMemory;
  } catch (...) {
    ::_exit(kExitOfException);
  }
  write_all(out, &end, sizeof end);
  ::_exit(0);
}

/// Waits for all these bytes; false when the pipe ends before.
bool read_all(int in, void* data, std::size_t size, const std::function<void()>& while_waiting) {
  constexpr int kPatience_ms = 100;
  auto* bytes = static_cast<char*>(data);
  while (size > 0) {
    struct pollfd waiting {
      in, POLLIN, 0
    };
    if (::poll(&waiting, 1, kPatience_ms) <= 0) {
      while_waiting();
      continue;
    }
    const ssize_t done = ::read(in, bytes, size);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    bytes += done;
    size -= static_cast<std::size_t>(done);
  }
  return true;
}

/// What it says between "it" and the end of a sentence.
std::string describe(int status, const ChildLimits& limits) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
    return "did nothing for " + std::to_string(limits.seconds) + " s of processor time";
  }
  if (WIFSIGNALED(status)) {
    const int number = WTERMSIG(status);
    return "was ended by signal " + std::to_string(number) + " (" + ::strsignal(number) + ")";
  }
  return "ended the process with code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

ChildEnd run_in_child(const ChildWork& work, const ChildReceiver& receive, const std::function<void()>& while_waiting,
                      const ChildLimits& limits) {
  SharedStep step;
  Pipe pipe;
  const pid_t parent = ::getpid();
  const pid_t id = ::fork();
  if (id < 0) fail_to_start("a child process");
  if (id == 0) be_the_child(work, pipe.write_end(), *step, parent, limits);
  Child child(id);
  pipe.close_write_end();
  std::vector<std::byte> piece;
  std::uint32_t size = 0;
  while (read_all(pipe.read_end(), &size, sizeof size, while_waiting)) {
    while_waiting();
    if (size == kOutOfMemory) {
      return {"wants more than " + std::to_string(limits.memory_bytes >> 20U) + " MB of memory", (*step).load()};
    }
    if (size == kReturned) {
      const bool rest = read_all(pipe.read_end(), &size, 1, while_waiting);  // the end of the pipe
      const int status = child.stop();
      if (!rest && WIFEXITED(status) && WEXITSTATUS(status) == 0) return {{}, (*step).load()};
      return {describe(status, limits), (*step).load()};
    }
    if (size > kLargestPiece) return {"sent what makes no sense", (*step).load()};
    piece.resize(size);
    if (!read_all(pipe.read_end(), piece.data(), size, while_waiting)) break;
    receive(piece);
  }
  return {describe(child.stop(), limits), (*step).load()};
}

#endif

}  // namespace sparsha::system
