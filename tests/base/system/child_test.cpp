// Work in a child process: what it sends arrives, and no way in which it ends harms this process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/system.h"
#include "tests/support/sanitized.h"

namespace sparsha {
namespace {

using ::testing::HasSubstr;

/// After each test no child is left, neither alive nor unreaped.
class ChildProcess : public ::testing::Test {
 protected:
  void TearDown() override {
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
  }
  system::ChildEnd run(const system::ChildWork& work, const system::ChildLimits& limits = {}) {
    received_.clear();
    return system::run_in_child(
        work,
        [&](std::span<const std::byte> bytes) {
          received_.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        },
        [] {}, limits);
  }
  std::vector<std::string> received_;
};

void send(const system::ChildOutput& output, const std::string& text) {
  output.send(std::as_bytes(std::span(text.data(), text.size())));
}

[[noreturn]] void spin() {
  for (std::atomic<unsigned> turns{0};;) ++turns;
}

TEST_F(ChildProcess, EveryPieceArrivesWholeAndInOrder) {
  const auto piece = [](int i) { return std::string(static_cast<std::size_t>(i * i) % 200'000, static_cast<char>(i)); };
  const system::ChildEnd end = run([&](const system::ChildOutput& output) {
    for (int i = 0; i < 1000; ++i) send(output, piece(i));
    send(output, std::string(system::kLargestPiece, 'x'));
    output.step = 77;
  });
  EXPECT_EQ(end.failure, "");
  EXPECT_EQ(end.step, 77U);
  ASSERT_EQ(received_.size(), 1001U);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(received_[static_cast<std::size_t>(i)], piece(i)) << i;
  EXPECT_EQ(received_.back(), std::string(system::kLargestPiece, 'x'));
}

TEST_F(ChildProcess, WorkThatIsEndedBySignalsIsToldWithTheSignalAndTheStep) {
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGKILL}) {
    const system::ChildEnd end = run([&](const system::ChildOutput& output) {
      send(output, "before");
      output.step = 3;
      ::raise(number);
    });
    EXPECT_THAT(end.failure, HasSubstr("was ended by signal " + std::to_string(number) + " (")) << number;
    EXPECT_EQ(end.step, 3U);
    EXPECT_EQ(received_, std::vector<std::string>{"before"});
  }
}

TEST_F(ChildProcess, WorkThatLeavesTheProcessIsNotTakenForFinishedWhateverItsCode) {
  for (const int code : {0, 1, 7}) {
    EXPECT_EQ(run([&](const system::ChildOutput&) { ::_exit(code); }).failure,
              "ended the process with code " + std::to_string(code));
  }
  EXPECT_NE(run([](const system::ChildOutput&) { throw std::runtime_error("no"); }).failure, "");
}

TEST_F(ChildProcess, ExitOfTheWorkPrintsNothingThatThisProcessHasYetToPrint) {
  ::testing::internal::CaptureStdout();
  std::fputs("once", stdout);  // stays in the buffer
  EXPECT_EQ(run([](const system::ChildOutput&) {
              std::fputs("from the child", stdout);
              std::fflush(stdout);
              static_cast<void>(std::fputs("from the child", stderr));
              std::exit(0);  // NOLINT(concurrency-mt-unsafe): what a library may do
            }).failure,
            "ended the process with code 0");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "once");
}

TEST_F(ChildProcess, AnEndlessLoopEndsWhenItsProcessorTimeIsUsedUp) {
  const system::ChildEnd end = run(
      [](const system::ChildOutput& output) {
        output.step = 9;
        spin();
      },
      {.seconds = 1});
  EXPECT_EQ(end.failure, "did nothing for 1 s of processor time");
  EXPECT_EQ(end.step, 9U);
}

TEST_F(ChildProcess, WorkThatGoesOnSendingMayUseMoreTimeThanThePauseBetweenTwoPieces) {
  const auto used = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const system::ChildEnd end = run(
      [&](const system::ChildOutput& output) {
        for (const double begin = used(); used() - begin < 3.5;) {
          const double sent = used();
          while (used() - sent < 0.2) {
          }
          send(output, "on");
        }
      },
      {.seconds = 1});
  EXPECT_EQ(end.failure, "");
}

TEST_F(ChildProcess, GreedForMemoryEndsTheWorkAndNotThisProcess) {
#if SPARSHA_SANITIZED
  GTEST_SKIP() << "sanitizers bring their own malloc";
#endif
  const system::ChildLimits limits{.memory_bytes = std::uint64_t{64} << 20U};
  const auto take = [](std::size_t bytes) {
    return [bytes](const system::ChildOutput& output) {
      const std::vector<char> memory(bytes);
      send(output, std::to_string(memory.size()));
    };
  };
  EXPECT_EQ(run(take(std::size_t{16} << 20U), limits).failure, "");
  EXPECT_EQ(run(take(std::size_t{256} << 20U), limits).failure, "wants more than 64 MB of memory");
  EXPECT_TRUE(received_.empty());
}

TEST_F(ChildProcess, WhatIsThrownHereEndsAChildThatWouldNeverEnd) {
  struct Stopped : std::exception {};
  const auto nothing = [](std::span<const std::byte>) {};
  EXPECT_THROW((void)system::run_in_child([](const system::ChildOutput&) { spin(); }, nothing, [] { throw Stopped(); }),
               Stopped);
  EXPECT_THROW(
      (void)system::run_in_child([](const system::ChildOutput&) { ::pause(); }, nothing, [] { throw Stopped(); }),
      Stopped);
  const auto endless = [](const system::ChildOutput& output) {
    for (;;) send(output, "more");
  };
  EXPECT_THROW((void)system::run_in_child(
                   endless, [](std::span<const std::byte>) { throw Stopped(); }, [] {}),
               Stopped);
}

TEST_F(ChildProcess, TheSignalsOfATerminalAreLeftToThisProcess) {
  const system::ChildEnd end = run([](const system::ChildOutput& output) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGALRM, SIGUSR1}) ::raise(number);
    send(output, "alive");
  });
  EXPECT_EQ(end.failure, "");
  EXPECT_EQ(received_, std::vector<std::string>{"alive"});
}

#if defined(__linux__)
TEST_F(ChildProcess, DiesWithTheProcessThatStartedIt) {
  int grandchild_lives[2];
  ASSERT_EQ(::pipe(grandchild_lives), 0);
  const pid_t parent = ::fork();
  ASSERT_GE(parent, 0);
  if (parent == 0) {
    // Its child closes the pipe that it inherits; so the number is sent, and looked for afterwards.
    static_cast<void>(system::run_in_child(
        [](const system::ChildOutput& output) {
          const pid_t self = ::getpid();
          output.send(std::as_bytes(std::span(&self, 1)));
          spin();
        },
        [&](std::span<const std::byte> bytes) {
          static_cast<void>(::write(grandchild_lives[1], bytes.data(), bytes.size()) == 0);
          ::raise(SIGKILL);
        },
        [] {}));
    ::_exit(1);
  }
  pid_t grandchild = 0;
  ASSERT_EQ(::read(grandchild_lives[0], &grandchild, sizeof grandchild), static_cast<ssize_t>(sizeof grandchild));
  ::close(grandchild_lives[0]);
  ::close(grandchild_lives[1]);
  int status = 0;
  ASSERT_EQ(::waitpid(parent, &status, 0), parent);
  ASSERT_TRUE(WIFSIGNALED(status));
  const auto lives = [&] {
    std::ifstream stat("/proc/" + std::to_string(grandchild) + "/stat");
    std::string number, name, state;
    return (stat >> number >> name >> state) && state != "Z" && state != "X";
  };
  for (int i = 0; i < 1000 && lives(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(lives());
}
#endif

TEST_F(ChildProcess, SeveralThreadsHaveChildrenAtOnceWhileOthersUseTheHeap) {
#if SPARSHA_SANITIZED
  GTEST_SKIP() << "a sanitizer's malloc keeps the locks of other threads in a copy of the process";
#endif
  std::atomic<bool> stop{false};
  std::vector<std::thread> threads;
  threads.reserve(6);
  for (int i = 0; i < 2; ++i) {
    threads.emplace_back([&] {
      while (!stop) delete[] new char[1 + static_cast<std::size_t>(std::rand()) % 100'000];
    });
  }
  std::atomic<int> right{0};
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      for (int round = 0; round < 20; ++round) {
        std::string all;
        const system::ChildEnd end = system::run_in_child(
            [&](const system::ChildOutput& output) {
              for (int k = 0; k < 50; ++k) send(output, std::string(static_cast<std::size_t>(k * 100 + i), 'a'));
              if (round % 2 == 1) ::raise(SIGSEGV);
            },
            [&](std::span<const std::byte> bytes) { all.append(bytes.size(), 'a'); }, [] {});
        const bool whole = all.size() == static_cast<std::size_t>(122'500 + 50 * i);
        if (whole && end.failure.empty() == (round % 2 == 0)) ++right;
      }
    });
  }
  for (std::size_t i = 2; i < threads.size(); ++i) threads[i].join();
  stop = true;
  for (std::size_t i = 0; i < 2; ++i) threads[i].join();
  EXPECT_EQ(right, 80);
}

}  // namespace
}  // namespace sparsha
