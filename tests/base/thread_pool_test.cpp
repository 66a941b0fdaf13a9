// The pool covers every index once, cuts at multiples of the grain, and passes exceptions on.
#include "base/threads/thread_pool.h"

#include <gtest/gtest.h>

#if __has_include(<sys/resource.h>)
#include <sys/resource.h>
#include <unistd.h>
#endif

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <future>
#include <stdexcept>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/threads/background.h"
#include "base/threads/progress.h"
#include "tests/support/sanitized.h"

namespace sparsha {
namespace {

TEST(ThreadPool, CoversEveryIndexOnceInPiecesThatStartAtMultiplesOfTheGrain) {
  for (const unsigned threads : {1U, 2U, 5U}) {
    ThreadPool pool(threads);
    EXPECT_EQ(pool.threads(), threads);
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{99}, std::size_t{10007}}) {
      std::vector<std::atomic<int>> seen(count);
      pool.for_ranges(count, 64, [&](std::size_t begin, std::size_t end) {
        EXPECT_EQ(begin % 64, 0U);
        EXPECT_LE(end - begin, 64U);
        for (std::size_t i = begin; i < end; ++i) ++seen[i];
      });
      for (const auto& times : seen) EXPECT_EQ(times.load(), 1);
    }
  }
}

TEST(ThreadPool, RethrowsAnExceptionAndWorksOn) {
  ThreadPool pool(3);
  const auto failing = [](std::size_t begin, std::size_t) {
    if (begin == 50) throw std::runtime_error("at 50");
  };
  EXPECT_THROW(pool.for_ranges(100, 10, failing), std::runtime_error);
  std::atomic<std::size_t> sum{0};
  pool.for_ranges(100, 1, [&](std::size_t begin, std::size_t) { sum += begin; });
  EXPECT_EQ(sum.load(), 4950U);
}

#if defined(__linux__) && !SPARSHA_SANITIZED
/// Takes nearly all of the memory that this process may address, so that there is no room for the stacks of many
/// threads.
void take_room_for_threads() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t pages = 0;
  statm >> pages;
  const rlim_t now = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  const rlimit limit{now + (40U << 20U), now + (40U << 20U)};
  if (pages == 0 || setrlimit(RLIMIT_AS, &limit) != 0) std::_Exit(77);
}

TEST(ThreadPool, WorksWithTheThreadsThatTheSystemGives) {
  EXPECT_EXIT(
      {
        take_room_for_threads();
        ThreadPool pool(1024);
        std::vector<std::atomic<int>> seen(1000);
        pool.for_ranges(seen.size(), 10, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) ++seen[i];
        });
        bool once = true;
        for (const auto& times : seen) once = once && times.load() == 1;
        std::_Exit(pool.threads() < 1024 && once ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST(InBackground, WorkIsDoneWhereNoThreadCanBeStarted) {
  EXPECT_EXIT(
      {
        take_room_for_threads();
        std::vector<std::future<int>> results;
        for (int k = 0; k < 64; ++k) results.push_back(in_background([k] { return std::this_thread::yield(), k; }));
        int sum = 0;
        for (std::future<int>& result : results) sum += result.get();
        std::_Exit(sum == 63 * 64 / 2 ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}
#endif

TEST(Progress, TimesStagesKeepsWarningsOnceAndStopsWhenCancelled) {
  std::vector<std::string> heard;
  Progress progress([&](const ProgressUpdate& update) { heard.emplace_back(update.text); });
  progress.begin("read");
  progress.warn("small");
  progress.warn("small");
  progress.begin("project");
  progress.finish();
  ASSERT_EQ(progress.stages().size(), 2U);
  EXPECT_EQ(progress.stages()[0].name, "read");
  EXPECT_EQ(progress.warnings().size(), 1U);
  EXPECT_EQ(heard.size(), 3U);
  progress.cancel();
  EXPECT_THROW(progress.at(0.5), Cancelled);
  EXPECT_THROW(progress.begin("more"), Cancelled);
}

}  // namespace
}  // namespace sparsha
