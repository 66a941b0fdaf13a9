#include "base/system/terminal.h"

#include <charconv>
#include <cstdlib>
#include <string_view>

#include "base/system.h"

namespace sparsha::system {

bool redraws_lines() noexcept {
  const char* const term = std::getenv("TERM");
  return stderr_is_terminal() && (term == nullptr || std::string_view(term) != "dumb");
}

namespace {

int columns_wished() noexcept {
  const char* const wish = std::getenv("COLUMNS");
  const std::string_view text = wish == nullptr ? "" : wish;
  int columns = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), columns);
  return code == std::errc{} && end == text.data() + text.size() ? columns : 0;
}

constexpr int kUsualColumns = 80;

}  // namespace
}  // namespace sparsha::system

#if defined(_WIN32)

namespace sparsha::system {

TerminalInput::TerminalInput() = default;
TerminalInput::~TerminalInput() = default;
std::string TerminalInput::read() { return {}; }
bool stdin_is_terminal() { return false; }
void forget_typed() noexcept {}
std::optional<std::string> typed_line(const std::function<bool()>&) { return std::nullopt; }
void restore_terminal() noexcept {}
std::filesystem::path standard_output_file() { return {}; }
int terminal_columns() noexcept { return columns_wished() > 0 ? columns_wished() : kUsualColumns; }

}  // namespace sparsha::system

#else

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>

#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

namespace sparsha::system {
namespace {

// Written before `changed` is set, and only read while it is.
termios before{};
termios keys{};
std::atomic<bool> changed{false};
std::atomic<bool> lent{false};  // back as it was, for as long as the program is stopped
static_assert(std::atomic<bool>::is_always_lock_free);

// Elsewhere the terminal is someone else's, and a program that touches it is stopped.
bool in_foreground() noexcept { return tcgetpgrp(STDIN_FILENO) == getpgrp(); }

// As the system would have handled it, with the terminal as it was.
void on_fault(int number) {
  restore_terminal();
  std::signal(number, SIG_DFL);
  raise(number);
}

void on_stop(int number) {
  const int error = errno;
  if (changed.load() && in_foreground()) tcsetattr(STDIN_FILENO, TCSANOW, &before);
  lent.store(true);
  struct sigaction standard {};
  struct sigaction ours {};
  standard.sa_handler = SIG_DFL;
  sigaction(number, &standard, &ours);
  sigset_t one, old;
  sigemptyset(&one);
  sigaddset(&one, number);
  raise(number);
  sigprocmask(SIG_UNBLOCK, &one, &old);  // stops here
  sigprocmask(SIG_SETMASK, &old, nullptr);
  sigaction(number, &ours, nullptr);
  errno = error;
}

void handle(int number, void (*handler)(int)) {
  struct sigaction action {};
  struct sigaction old {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  // A handler of someone else's (a sanitizer's) stays.
  if (sigaction(number, nullptr, &old) == 0 && old.sa_handler == SIG_DFL) sigaction(number, &action, nullptr);
}

}  // namespace

bool stdin_is_terminal() { return in_foreground(); }

int terminal_columns() noexcept {
  if (const int wished = columns_wished(); wished > 0) return wished;
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsualColumns;
}

void restore_terminal() noexcept {
  if (changed.exchange(false) && in_foreground()) tcsetattr(STDIN_FILENO, TCSANOW, &before);
}

void forget_typed() noexcept {
  if (!in_foreground()) return;
  restore_terminal();
  tcflush(STDIN_FILENO, TCIFLUSH);
}

std::optional<std::string> typed_line(const std::function<bool()>& stop) {
  if (!in_foreground()) return std::nullopt;
  constexpr int kWait_ms = 50;
  constexpr std::size_t kMost = 4096;  // a terminal's own lines are no longer
  std::array<char, 256> block{};
  std::string line;
  while (!stop()) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    const int ready = poll(&input, 1, kWait_ms);
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t got = ready < 0 ? -1 : ::read(STDIN_FILENO, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    line.append(block.data(), static_cast<std::size_t>(got));
    const std::size_t end = line.find('\n');
    if (end != std::string::npos || line.size() > kMost) return line.substr(0, std::min(end, kMost));
  }
  return std::nullopt;
}

TerminalInput::TerminalInput() {
  if (changed.load() || !in_foreground() || tcgetattr(STDIN_FILENO, &before) != 0) return;
  keys = before;
  keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  keys.c_cc[VMIN] = 0;
  keys.c_cc[VTIME] = 0;
  lent.store(false);
  changed.store(true);
  static const bool registered = std::atexit([] { restore_terminal(); }) == 0;
  static_cast<void>(registered);
  for (const int number : {SIGSEGV, SIGABRT, SIGFPE, SIGILL}) handle(number, on_fault);
  handle(SIGTSTP, on_stop);
  active_ = tcsetattr(STDIN_FILENO, TCSANOW, &keys) == 0;
  if (!active_) restore_terminal();
}

TerminalInput::~TerminalInput() {
  if (active_) restore_terminal();
}

std::filesystem::path standard_output_file() {
  struct stat open {};
  struct stat named {};
  if (::fstat(STDOUT_FILENO, &open) != 0 || !S_ISREG(open.st_mode)) return {};
  std::error_code code;
  std::filesystem::path file = std::filesystem::read_symlink("/proc/self/fd/1", code);
  // The name may be of before a move, or of another file since.
  const bool same =
      !code && ::stat(file.c_str(), &named) == 0 && named.st_dev == open.st_dev && named.st_ino == open.st_ino;
  return same && file.is_absolute() ? file : std::filesystem::path();
}

std::string TerminalInput::read() {
  std::string typed;
  if (active_ && tcgetpgrp(STDIN_FILENO) < 0) gone_ = true;
  if (!active_ || gone_ || !in_foreground()) return typed;
  if (lent.exchange(false)) tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  std::array<char, 256> block{};
  pollfd input{STDIN_FILENO, POLLIN, 0};
  constexpr std::size_t kMost = 4096;
  while (typed.size() < kMost && poll(&input, 1, 0) > 0 && (input.revents & POLLIN) != 0) {
    const ssize_t got = ::read(STDIN_FILENO, block.data(), block.size());
    if (got == 0 || (got < 0 && errno == EIO)) gone_ = true;
    if (got <= 0) break;
    typed.append(block.data(), static_cast<std::size_t>(got));
  }
  return typed;
}

}  // namespace sparsha::system

#endif
