// The pool covers every index once, cuts at multiples of the grain, and passes exceptions on.
#include "base/threads/thread_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "base/error.h"
#include "base/threads/progress.h"

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
