// Each case in a process of its own, which is asked to end by its parent.
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <functional>

#include "base/system/signals.h"

namespace sparsha::system {
namespace {

volatile std::sig_atomic_t asked = 0;
void count(int) { asked = asked + 1; }

/// How a child ends that says when it is ready and is then sent `signal`; 0: nothing.
int status_of(const std::function<int(const std::function<void()>& ready)>& work, int signal) {
  int ends[2];
  EXPECT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::_exit(work([&] {
      if (::write(ends[1], "r", 1) != 1) ::_exit(99);
    }));
  }
  char byte = 0;
  EXPECT_EQ(::read(ends[0], &byte, 1), 1);
  if (signal != 0) ::kill(child, signal);
  int status = 0;
  ::waitpid(child, &status, 0);
  ::close(ends[0]);
  ::close(ends[1]);
  return status;
}

/// As a shell starts a program, however this test was started: nohup ignores SIGHUP.
int wait_to_be_asked(const std::function<void()>& ready) {
  std::signal(SIGHUP, SIG_DFL);
  route_ending_signals(count);
  ready();
  for (int k = 0; k < 10'000 && asked == 0; ++k) ::usleep(1'000);
  return asked == 1 ? 0 : 1;
}

}  // namespace

TEST(EndingSignals, AreHandedOverWhicheverComesFromAnotherProcess) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGABRT, SIGALRM, SIGXCPU, SIGVTALRM, SIGPROF, SIGUSR1}) {
    const int status = status_of(wait_to_be_asked, number);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << number;
  }
}

TEST(EndingSignals, HangUpStaysIgnoredWhereTheProgramWasStartedSo) {
  const int status = status_of(
      [](const std::function<void()>& ready) {
        std::signal(SIGHUP, SIG_IGN);
        route_ending_signals(count);
        std::raise(SIGHUP);
        const bool ignored = asked == 0;
        ready();
        return ignored ? 0 : 1;
      },
      0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(EndingSignals, ThatWereHeldAreLetThrough) {
  const int status = status_of(
      [](const std::function<void()>& ready) {
        sigset_t set;
        ::sigemptyset(&set);
        ::sigaddset(&set, SIGTERM);
        ::sigprocmask(SIG_BLOCK, &set, nullptr);
        ready();
        sigset_t pending;
        do {
          ::usleep(1'000);
          ::sigpending(&pending);
        } while (::sigismember(&pending, SIGTERM) == 0);
        route_ending_signals(count);
        return asked == 1 ? 0 : 1;
      },
      SIGTERM);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(EndingSignals, AnAbortOfItsOwnEndsAProgramAsItAlwaysDid) {
  const int status = status_of(
      [](const std::function<void()>& ready) -> int {
        route_ending_signals(count);
        ready();
        std::abort();
      },
      0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGABRT);
}

TEST(StandardStreams, ThatWereClosedAreOpenedWhereNothingCanBeReadOrPrinted) {
  const int status = status_of(
      [](const std::function<void()>& ready) {
        for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::close(stream);
        open_standard_streams();
        ready();
        char byte = 0;
        const bool ends = ::read(STDIN_FILENO, &byte, 1) == 0;
        const bool refuses = ::write(STDOUT_FILENO, "x", 1) < 0 && errno == EBADF;
        const bool swallows = ::write(STDERR_FILENO, "x", 1) == 1;
        const int next = ::open("/dev/null", O_RDONLY);
        return ends && refuses && swallows && next > STDERR_FILENO ? 0 : 1;
      },
      0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace sparsha::system
