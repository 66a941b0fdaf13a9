#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "haptics/state/requests.h"
#include "haptics/state/spsc_queue.h"

namespace sparsha::haptics {
namespace {

TEST(SpscQueue, GivesBackEveryValueOnceAndInOrderAcrossThreads) {
  constexpr std::uint64_t kCount = 400'000;
  SpscQueue<std::uint64_t> queue(64);
  std::vector<std::uint64_t> seen;
  seen.reserve(kCount);
  std::thread consumer([&] {
    std::uint64_t value = 0;
    while (seen.size() < kCount)
      if (queue.pop(value))
        seen.push_back(value);
      else
        std::this_thread::yield();
  });
  for (std::uint64_t n = 0; n < kCount;)
    if (queue.push(n))
      ++n;
    else
      std::this_thread::yield();
  consumer.join();
  for (std::uint64_t n = 0; n < kCount; ++n) ASSERT_EQ(seen[n], n);
}

TEST(SpscQueue, RefusesAValueWhenFullAndLeavesItUnchanged) {
  SpscQueue<std::shared_ptr<int>> queue(3);  // rounded up
  ASSERT_EQ(queue.capacity(), 4U);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(queue.push(std::make_shared<int>(i)));
  auto fifth = std::make_shared<int>(4);
  EXPECT_FALSE(queue.push(std::move(fifth)));
  ASSERT_NE(fifth, nullptr);
  EXPECT_EQ(*fifth, 4);
  std::shared_ptr<int> first;
  ASSERT_TRUE(queue.pop(first));
  EXPECT_EQ(*first, 0);
  EXPECT_TRUE(queue.push(std::move(fifth)));
}

TEST(SpscQueue, KeepsNothingOfAPoppedValue) {
  SpscQueue<std::shared_ptr<int>> queue(4);
  auto value = std::make_shared<int>(1);
  const std::weak_ptr<int> watch = value;
  ASSERT_TRUE(queue.push(std::move(value)));
  std::shared_ptr<int> taken;
  ASSERT_TRUE(queue.pop(taken));
  taken.reset();
  EXPECT_TRUE(watch.expired());
}

TEST(RequestQueue, TakesRequestsInTheOrderTheyWerePosted) {
  RequestQueue queue;
  EXPECT_FALSE(queue.take().has_value());
  queue.post({Request::Kind::pan, 0.5, -0.25, false});
  queue.post({Request::Kind::quit});
  const auto pan = queue.take();
  ASSERT_TRUE(pan.has_value());
  EXPECT_EQ(pan->kind, Request::Kind::pan);
  EXPECT_EQ(pan->y, -0.25);
  EXPECT_EQ(queue.take()->kind, Request::Kind::quit);
}

TEST(AnnouncementBoard, GivesEveryReaderWhatIsNewToIt) {
  AnnouncementBoard board;
  board.say("one");
  board.say("two", Announcement::Priority::fault);
  const auto all = board.since(0);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[1].text, "two");
  EXPECT_EQ(all[1].priority, Announcement::Priority::fault);
  EXPECT_TRUE(board.since(all.back().sequence).empty());
  board.say("three");
  EXPECT_EQ(board.since(all.back().sequence).size(), 1U);
}

}  // namespace
}  // namespace sparsha::haptics
