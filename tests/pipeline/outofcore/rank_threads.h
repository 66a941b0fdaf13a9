// Work on several ranks at once, which are threads.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/threads/progress.h"
#include "pipeline/cluster/ranks.h"
#include "pipeline/scan/shared_reading.h"
#include "tests/pipeline/outofcore/thread_transport.h"

namespace sparsha::test {

using pipeline::Ranks;

/// Does `work` on so many ranks at once. The first that fails cancels the others, and its error is thrown.
inline void on_ranks(std::size_t size, std::size_t round_bytes,
                     const std::function<void(const Ranks&, Progress&)>& work) {
  MeetingPlace place(static_cast<int>(size));
  std::vector<std::unique_ptr<Progress>> progress;
  for (std::size_t r = 0; r < size; ++r) progress.push_back(std::make_unique<Progress>());
  std::vector<std::exception_ptr> errors(size);
  std::vector<std::thread> threads;
  for (std::size_t r = 0; r < size; ++r) {
    threads.emplace_back([&, r] {
      ThreadTransport transport(place, r);
      try {
        work(Ranks(transport, *progress[r], round_bytes), *progress[r]);
      } catch (const Cancelled&) {
      } catch (...) {
        errors[r] = std::current_exception();
        for (const auto& other : progress) other->cancel();
      }
      EXPECT_LE(static_cast<std::size_t>(transport.largest()), std::max<std::size_t>(round_bytes / size, 16));
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

/// The ranks as those who read scans together.
inline pipeline::ReadingRanks readers(const Ranks& ranks) {
  return {ranks.number(), ranks.size(), [&ranks](Ranks::Bytes& bytes) { ranks.join(bytes); },
          [&ranks](Ranks::Bytes mine, const pipeline::ReadingRanks::Merge& merge) {
            return ranks.merged(std::move(mine), merge);
          }};
}

}  // namespace sparsha::test
