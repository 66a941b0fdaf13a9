// The process that ends a force when this one cannot.
#include "haptics/device/guard.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <new>
#include <thread>

namespace sparsha::haptics {
namespace {

struct Seen {
  std::atomic<std::uint64_t> zeros{0}, names{0}, device{0}, fails{0};
};

/// What the guard's process did, in memory that both share.
class Guarded : public ::testing::Test {
 protected:
  void SetUp() override {
    void* const page = ::mmap(nullptr, sizeof(Seen), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(page, MAP_FAILED);
    seen_ = new (page) Seen;
    guard_ = std::make_unique<ForceGuard>([seen = seen_](std::uint64_t device, bool send) {
      seen->device.store(device);
      seen->names.fetch_add(send ? 0 : 1);
      if (!send) return true;
      seen->zeros.fetch_add(1);
      return seen->fails.load() == 0 || seen->fails.fetch_sub(1) == 0;
    });
  }
  void TearDown() override {
    guard_.reset();
    ::munmap(seen_, sizeof(Seen));
  }
  static bool eventually(const std::function<bool()>& so) {
    for (int i = 0; i < 10'000 && !so(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return so();
  }
  static void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(60)); }

  Seen* seen_ = nullptr;
  std::unique_ptr<ForceGuard> guard_;
};

TEST_F(Guarded, SilenceWithAForceIsZeroAgainAndAgainAndWithoutIsNone) {
  guard_->watch(42);
  ASSERT_TRUE(eventually([&] { return seen_->names.load() == 1; })) << "it gets to know the device while all is well";
  EXPECT_EQ(seen_->device.load(), 42U);
  pause();
  EXPECT_EQ(seen_->zeros.load(), 0U) << "no force, nothing to end";
  guard_->set_force(true);
  ASSERT_TRUE(eventually([&] { return seen_->zeros.load() >= 2; })) << "again as long as nothing is heard";
  guard_->set_force(false);
  pause();
  const std::uint64_t zeros = seen_->zeros.load();
  pause();
  EXPECT_EQ(seen_->zeros.load(), zeros);
}

TEST_F(Guarded, NothingIsDoneWhereThereIsNoDevice) {
  guard_->set_force(true);
  pause();
  EXPECT_EQ(seen_->zeros.load(), 0U);
}

TEST_F(Guarded, AProgramThatEndsWithAForceLeavesNone) {
  guard_->watch(7);
  seen_->fails.store(3);
  guard_->set_force(true);
  guard_.reset();
  EXPECT_GE(seen_->zeros.load(), 4U) << "three that did not go through, and one that did";
}

}  // namespace
}  // namespace sparsha::haptics
