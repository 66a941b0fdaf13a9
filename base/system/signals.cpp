// POSIX: sigaction; elsewhere the C library's two signals.
#include "base/system/signals.h"

#include <csignal>

#if !defined(_WIN32)
#include <fcntl.h>
#include <unistd.h>

#include "base/system/ending_signals.h"
#include "base/system/terminal.h"
#endif

namespace sparsha::system {

#if defined(_WIN32)

namespace {
void (*asked_to_end)(int) = nullptr;
void on_ending(int number) {
  std::signal(number, on_ending);
  asked_to_end(number);
}
}  // namespace

void route_ending_signals(void (*asked)(int)) noexcept {
  asked_to_end = asked;
  for (const int number : {SIGINT, SIGTERM}) std::signal(number, on_ending);
}
void open_standard_streams() noexcept {}

#else

namespace {

void (*asked_to_end)(int) = nullptr;

sigset_t ending_signals() noexcept {
  sigset_t set;
  ::sigemptyset(&set);
  for (const int number : kEndingSignals) ::sigaddset(&set, number);
  return set;
}

void on_ending(int number, siginfo_t*, void*) { asked_to_end(number); }

// abort() is this program's own end; what others send asks for one.
void on_abort(int number, siginfo_t* info, void*) {
  if (info->si_pid != ::getpid()) return asked_to_end(number);
  restore_terminal();
  std::signal(number, SIG_DFL);
  ::raise(number);  // on return: blocked while it is handled
}

void handle(int number, void (*handler)(int, siginfo_t*, void*)) noexcept {
  struct sigaction action {};
  action.sa_sigaction = handler;
  action.sa_flags = SA_SIGINFO | SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  ::sigaction(number, &action, nullptr);
}

bool is_ignored(int number) noexcept {
  struct sigaction present {};
  return ::sigaction(number, nullptr, &present) == 0 && present.sa_handler == SIG_IGN;
}

}  // namespace

void route_ending_signals(void (*asked)(int)) noexcept {
  asked_to_end = asked;
  for (const int number : kEndingSignals) {
    if (number == SIGHUP && is_ignored(number)) continue;
    handle(number, number == SIGABRT ? on_abort : on_ending);
  }
  for (const int number : {SIGXFSZ, SIGPIPE}) std::signal(number, SIG_IGN);
  const sigset_t set = ending_signals();
  ::sigprocmask(SIG_UNBLOCK, &set, nullptr);
}

void open_standard_streams() noexcept {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) >= 0) continue;
    // The lowest number that is free is the one looked at. Writing to what is open for reading alone is an error.
    (void)::open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
  }
}

#endif

}  // namespace sparsha::system
