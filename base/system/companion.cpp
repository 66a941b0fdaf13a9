// POSIX: a process that outlives this one; Linux: the node of a USB device.
#include "base/error.h"
#include "base/system/confinement.h"
#include "base/system/process.h"

#if !defined(_WIN32)
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <new>
#endif
#if defined(__linux__)
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>

#include <cstdio>
#endif

namespace sparsha::system {

static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "shared between processes");

#if defined(_WIN32)

Companion::Companion(const Watch&, int) {
  throw Error(ErrorKind::failure, {}, "this system has no companion processes", "a POSIX system");
}
Companion::~Companion() = default;

#else

namespace {

constexpr int kCompanionPriority = 85;

[[noreturn]] void fail(const char* what) {
  throw Error(ErrorKind::failure, {}, std::string(what) + " fails: " + std::strerror(errno),
              "a system that lets this program start a process of its own");
}

/// Keeps `end` alone, as descriptor 3.
int keep_only(int end) {
  constexpr int kKept = 3;
  end = ::fcntl(end, F_DUPFD, kKept);
  const int null = ::open("/dev/null", O_RDWR);
  for (int standard = 0; standard < kKept; ++standard) ::dup2(null, standard);
  if (end != kKept) ::dup2(end, kKept);
#if defined(__linux__)
  if (::close_range(kKept + 1, ~0U, 0) == 0) return kKept;
#endif
  const long most = ::sysconf(_SC_OPEN_MAX);
  for (int other = kKept + 1; other < most; ++other) ::close(other);
  return kKept;
}

/// One that was killed is started again: the watch is another process, and this one waits for it. Whichever of the two
/// somebody ends, this program is watched over.
void stay_behind_the_watch() {
  for (;;) {
    const pid_t watch = ::fork();
    if (watch <= 0) return;  // the watch; or no process is to be had, and this one has to do
    int status = 0;
    while (::waitpid(watch, &status, 0) < 0 && errno == EINTR) {
    }
    if (!WIFSIGNALED(status)) ::_exit(0);
  }
}

[[noreturn]] void be_the_companion(const Companion::Watch& watch, int end, SharedWords& words, int look_ms) {
  ::setsid();
  for (int number = 1; number < NSIG; ++number) ::signal(number, SIG_DFL);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGUSR1, SIGUSR2, SIGALRM})
    ::signal(number, SIG_IGN);
  end = keep_only(end);
#if defined(__linux__)
  ::prctl(PR_SET_NAME, "sparsha-guard");
#endif
  sched_param priority{};
  priority.sched_priority = kCompanionPriority;
  static_cast<void>(::sched_setscheduler(0, SCHED_FIFO, &priority));  // where it is granted
  confine_thread(Confinement::helper);
  stay_behind_the_watch();
  for (;;) {
    pollfd ended{end, POLLIN, 0};
    const int found = ::poll(&ended, 1, look_ms);
    const bool alive = found == 0 || (found < 0 && errno == EINTR);  // nothing is ever written: the end of the pipe
    watch(words, alive);
    if (!alive) ::_exit(0);
  }
}

}  // namespace

Companion::Companion(const Watch& watch, int look_ms) {
  void* const page = ::mmap(nullptr, sizeof(SharedWords), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (page == MAP_FAILED) fail("shared memory");
  words_ = new (page) SharedWords{};
  int ends[2] = {-1, -1};
  if (::pipe(ends) != 0) fail("a pipe");
  for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);
  process_ = ::fork();
  if (process_ == 0) be_the_companion(watch, ends[0], *words_, look_ms);
  ::close(ends[0]);
  pipe_ = ends[1];
  if (process_ < 0) {
    ::close(pipe_);
    ::munmap(words_, sizeof(SharedWords));
    fail("a process");
  }
}

Companion::~Companion() {
  ::close(pipe_);
  int status = 0;
  while (::waitpid(static_cast<pid_t>(process_), &status, 0) < 0 && errno == EINTR) {
  }
  ::munmap(words_, sizeof(SharedWords));
}

#endif

#if defined(__linux__)

UsbNode::UsbNode(unsigned bus, unsigned address) noexcept {
  char name[64] = {};
  std::snprintf(name, sizeof name, "/dev/bus/usb/%03u/%03u", bus, address);
  file_ = ::open(name, O_RDWR | O_CLOEXEC);
}

UsbNode::~UsbNode() {
  if (file_ >= 0) ::close(file_);
}

bool UsbNode::write_taking_over(unsigned interface_number, unsigned endpoint, std::span<const std::uint8_t> bytes,
                                int times) noexcept {
  constexpr unsigned kTimeout_ms = 50;
  if (file_ < 0) return false;
  usbdevfs_disconnect_claim claim{};
  claim.interface = interface_number;  // without flags: from whoever holds it
  if (::ioctl(file_, USBDEVFS_DISCONNECT_CLAIM, &claim) != 0) return false;
  bool all = true;
  for (int i = 0; i < times; ++i) {
    usbdevfs_bulktransfer transfer{};
    transfer.ep = endpoint;
    transfer.len = static_cast<unsigned>(bytes.size());
    transfer.timeout = kTimeout_ms;
    transfer.data = const_cast<std::uint8_t*>(bytes.data());
    all = ::ioctl(file_, USBDEVFS_BULK, &transfer) >= 0 && all;
  }
  static_cast<void>(::ioctl(file_, USBDEVFS_RELEASEINTERFACE, &interface_number));
  return all;
}

#else

UsbNode::UsbNode(unsigned, unsigned) noexcept {}
UsbNode::~UsbNode() = default;
bool UsbNode::write_taking_over(unsigned, unsigned, std::span<const std::uint8_t>, int) noexcept { return false; }

#endif

}  // namespace sparsha::system
