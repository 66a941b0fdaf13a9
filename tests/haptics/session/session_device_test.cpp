// What a session makes of devices that fail, and the stiffness that a device bears.
#include "haptics/session/session.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.h"
#include "haptics/device/pointer/pointer_device.h"
#include "haptics/device/simulated/simulated_device.h"
#include "tests/support/placed_hand.h"
#include "tests/support/recorded_runs.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::haptics {
namespace {

/// Presses into the stone after 100 ms in the air, again and again, and then does what it is told to do wrong.
enum class Trouble { none, not_a_number, unplugged, silent };
std::unique_ptr<Device> troubled_device(const std::shared_ptr<std::atomic<Trouble>>& trouble) {
  return std::make_unique<ScriptedDevice>([trouble](std::uint64_t tick, double time_s) {
    DeviceSample sample = sample_at({0.0, 0.0, tick % 400 < 100 ? 0.02 : -0.002}, time_s);
    const Trouble now = trouble->load();
    if (now == Trouble::not_a_number) sample.position_m.x() = std::nan("");
    if (now == Trouble::unplugged) sample.connected = false;
    if (now == Trouble::silent) std::this_thread::sleep_for(std::chrono::milliseconds(700));
    return sample;
  });
}

TEST(Session, SaysWhatIsWrongWithTheDeviceAndTakesTheForceAway) {
  const std::vector<std::pair<Trouble, std::string>> troubles = {
      {Trouble::not_a_number, "The hand was lost"}, {Trouble::unplugged, "unplugged"}, {Trouble::silent, "went soft"}};
  for (const auto& [wrong, said_of_it] : troubles) {
    const std::string& words_expected = said_of_it;  // Clang 14 captures no structured binding
    const auto trouble = std::make_shared<std::atomic<Trouble>>(Trouble::none);
    SessionOptions options;
    options.longest_gap_s = 0.3;  // the machine's own pauses are not what is tested
    Session session(sparsha::test::flat_scene(), troubled_device(trouble), options);
    session.start();
    ASSERT_TRUE(poll_until(session, [&] { return session.state().read().commanded_force_n[2] > 0.0; }));
    trouble->store(wrong);
    ASSERT_TRUE(poll_until(session, [&] { return said(session, words_expected); })) << words_expected;
    ASSERT_TRUE(poll_until(session, [&] { return session.state().read().commanded_force_n[2] == 0.0; }));
    const auto all = session.announcements().since(0);
    EXPECT_TRUE(std::any_of(all.begin(), all.end(),
                            [](const Announcement& a) { return a.priority == Announcement::Priority::fault; }));
    EXPECT_GT(session.stop().faults, 0U);
  }
}

/// In the air, with an advice that comes and goes.
class Advising final : public Device {
 public:
  [[nodiscard]] DeviceInfo info() const override { return {}; }
  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    static constexpr DeviceAdvice kChanged{"device_changes_force", false, true};
    advice_.store(std::fmod(time_s, 0.1) < 0.05 ? nullptr : &kChanged);
    if (time_s > 0.4) rounds_over_.store(true);
    return sample_at({0.0, 0.0, 0.02}, time_s);
  }
  void write(const Eigen::Vector3d&) noexcept override {}
  void zero() noexcept override {}
  [[nodiscard]] const DeviceAdvice* advice() const noexcept override { return advice_.load(); }
  [[nodiscard]] bool rounds_over() const { return rounds_over_.load(); }

 private:
  std::atomic<const DeviceAdvice*> advice_{nullptr};
  std::atomic<bool> rounds_over_{false};
};

TEST(Session, WarnsOnceOfADeviceThatChangesForcesAtEachTouch) {
  auto device = std::make_unique<Advising>();
  const Advising& advising = *device;
  Session session(sparsha::test::flat_scene(), std::move(device), SessionOptions{});
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return advising.rounds_over(); }));
  const auto all = session.announcements().since(0);
  EXPECT_EQ(std::count_if(all.begin(), all.end(),
                          [](const Announcement& a) {
                            return a.priority == Announcement::Priority::warning &&
                                   a.text.find("more than a tenth") != std::string::npos;
                          }),
            1);
}

TEST(Session, SaysWhenRealTimeWasNotGranted) {
  SessionOptions options;
  Session session(sparsha::test::flat_scene(), make_simulated_device(1, 0.0), options);
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 20; }));
  const bool granted = (session.state().read().flags & kFlagRealTime) != 0;
  EXPECT_EQ(said(session, "Real-time scheduling was not granted"), !granted);
  EXPECT_EQ(session.stop().real_time, granted);
}

TEST(Session, LimitsAStiffnessThatIsAskedForLaterAndSaysSo) {
  Session session(sparsha::test::flat_scene(), make_simulated_device(1, 0.0), SessionOptions{});
  session.start();
  session.requests().post({Request::Kind::set_stiffness, 1e6});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "all the device can bear"); }));
  const double limit = stiffness_limit(make_simulated_device(1, 0.0)->info().limits, 0.001);
  EXPECT_EQ(session.stop().stiffness_n_per_m, limit);
}

TEST(Session, SpeaksOfTheStiffnessThatItRendersStepByStep) {
  SessionOptions options;
  options.haptics.stiffness_n_per_m = 400.0;
  Session session(sparsha::test::flat_scene(), make_simulated_device(1, 0.0), options);
  session.start();
  session.requests().post({Request::Kind::scale_stiffness, 0.8});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "Stiffness 320 newtons a metre"); }));
  for (int k = 0; k < 12; ++k) session.requests().post({Request::Kind::scale_stiffness, 1.25});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "all the device can bear"); }));
  session.requests().post({Request::Kind::scale_stiffness, 0.8});
  const double limit = stiffness_limit(make_simulated_device(1, 0.0)->info().limits, 0.001);
  ASSERT_TRUE(poll_until(session, [&] {
    return said(session, fmt::format("Stiffness {:.0f} newtons a metre", 0.8 * limit));
  })) << "softer than what is rendered, not than what was wished";
  EXPECT_EQ(session.stop().stiffness_n_per_m, 0.8 * limit);
}

TEST(Session, SpeaksOfTheStiffnessThatALateLoopBearsAndNotOfThePlannedOne) {
  constexpr double kDelay_s = 0.004;
  const auto late_hand = [](std::uint64_t, double time_s) {
    DeviceSample sample = sample_at({0.0, 0.0, 0.02}, time_s);
    sample.delay_s = kDelay_s;
    return sample;
  };
  Session session(sparsha::test::flat_scene(), std::make_unique<ScriptedDevice>(late_hand, true), SessionOptions{});
  session.start();
  const double limit = stiffness_limit(DeviceLimits{}, 0.001, kDelay_s);
  // The meter's bins are 4.4 % wide.
  ASSERT_TRUE(poll_until(session, [&] {
    const double known = session.state().read().stiffness_limit_n_per_m;
    return known > 0.95 * limit && known < 1.01 * limit;
  }));
  const double known = session.state().read().stiffness_limit_n_per_m;
  session.requests().post({Request::Kind::set_stiffness, 800.0});
  EXPECT_TRUE(poll_until(session, [&] {
    return said(session, fmt::format("Stiffness {:.0f} newtons a metre, all the device can bear", known));
  }));
  session.stop();
}

}  // namespace
}  // namespace sparsha::haptics
