// What is plugged in again is handed over, and what has gone is closed when nobody uses it any more.
#include "haptics/device/hot_plug.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>

#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

struct Wire {
  explicit Wire(std::atomic<int>& open) : open_(open) { ++open_; }
  ~Wire() { --open_; }
  Wire(const Wire&) = delete;
  Wire& operator=(const Wire&) = delete;

 private:
  std::atomic<int>& open_;
};

TEST(HotPlug, LooksOnlyForWhatIsWantedUntilThereIsOneWhateverIsThrownMeanwhile) {
  std::atomic<int> open{0}, asked{0};
  {
    HotPlug<Wire> plug([&]() -> std::unique_ptr<Wire> {
      if (++asked == 1) throw std::runtime_error("a cable without an end");
      return std::make_unique<Wire>(open);
    });
    EXPECT_EQ(plug.take(), nullptr);
    EXPECT_EQ(asked.load(), 0) << "none was wanted yet";
    plug.give_back(nullptr);
    std::unique_ptr<Wire> wire;
    ASSERT_TRUE(eventually([&] {
      wire.reset(plug.take());
      return wire != nullptr;
    }));
    EXPECT_EQ(asked.load(), 2);
    plug.give_back(wire.release());
    ASSERT_TRUE(eventually([&] { return asked.load() == 3; }));
    ASSERT_TRUE(eventually([&] { return open.load() == 1; })) << "the old one is closed";
  }
  EXPECT_EQ(open.load(), 0) << "and what nobody took as well";
}

TEST(HotPlug, ClosesNothingThatAnotherThreadUses) {
  std::atomic<int> open{0}, asked{0};
  HotPlug<Wire> plug([&]() -> std::unique_ptr<Wire> {
    ++asked;
    return nullptr;
  });
  plug.enter();
  plug.give_back(std::make_unique<Wire>(open).release());
  std::this_thread::sleep_for(std::chrono::milliseconds(80));
  EXPECT_EQ(open.load(), 1);
  EXPECT_EQ(asked.load(), 0);
  plug.leave();
  EXPECT_TRUE(eventually([&] { return open.load() == 0 && asked.load() > 0; }));
}

}  // namespace
}  // namespace sparsha::haptics
