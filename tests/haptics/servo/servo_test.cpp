#include "haptics/servo/servo.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "haptics/device/simulated/simulated_device.h"
#include "haptics/servo/real_time.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

DeviceSample in_stone(double time_s) { return sample_at({0.0, 0.0, -0.002}, time_s); }
DeviceSample in_air(double time_s) { return sample_at({0.0, 0.0, 0.02}, time_s); }

/// In the air until the governor has armed, then in the stone; and again.
DeviceSample touch(std::uint64_t tick, double time_s) { return tick % 400 < 100 ? in_air(time_s) : in_stone(time_s); }

TEST(Servo, RunsAtItsRateAndReportsWhatItGot) {
  for (const double rate_hz : {1000.0, 10'000.0}) {
    const auto device = make_simulated_device(2, 0.0);
    Seqlock<State> state;
    ServoOptions options;
    options.renderer.rate_hz = rate_hz;
    Servo servo(*device, options, window_on(sparsha::test::scene_of(sparsha::test::hills_m, 201, 0.1)), state, {},
                nullptr);
    const std::int64_t begun_ns = now_ns();
    servo.start();
    ASSERT_TRUE(eventually([&] { return state.read().time_s > 1.0; }));
    servo.stop();
    const ServoFigures& figures = servo.figures();
    // Every planned tick was run or counted as missed: those up to the last that ran, and what it missed itself.
    const auto counted = static_cast<double>(figures.ticks + figures.missed_ticks);
    EXPECT_GE(counted, std::floor(state.read().time_s * rate_hz) + 1.0);
    EXPECT_LE(counted, static_cast<double>(now_ns() - begun_ns) * 1e-9 * rate_hz + 1.0);
    EXPECT_GT(figures.share_in_time, 0.0);
    EXPECT_LE(figures.share_in_time, 1.0);
    EXPECT_EQ(figures.tick_ns.total(), figures.ticks);
    // Reported, not judged: the machine may be shared.
    std::printf(
        "%.0f Hz: SCHED_FIFO %s, memory %s, %.4f of ticks in time, %llu missed, tick p50 %.0f p99 %.0f max %.0f ns\n",
        rate_hz, figures.real_time ? "granted" : "refused", figures.locked_memory ? "locked" : "not locked",
        figures.share_in_time, static_cast<unsigned long long>(figures.missed_ticks), figures.tick_ns.quantile_ns(0.5),
        figures.tick_ns.quantile_ns(0.99), figures.tick_ns.max_ns());
  }
}

TEST(Servo, TheWatchdogZeroesTheDeviceWhileTheServoIsStalledAndForcesStayOffUntilTheHandIsInTheAir) {
  std::atomic<bool> stall{false};
  std::atomic<bool> stalled{false};
  std::atomic<bool> hold{true};  // stay in the stone after the stall
  ScriptedDevice device([&](std::uint64_t tick, double time_s) {
    if (stall.load()) {
      stalled.store(true);
      while (stall.load()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return stalled.load() && hold.load() ? in_stone(time_s) : touch(tick, time_s);
  });
  Seqlock<State> state;
  Servo servo(device, patient(0.3), window_on(sparsha::test::flat_scene()), state, {}, nullptr);
  servo.start();
  ASSERT_TRUE(eventually([&] { return device.force_n() > 0.0; }));
  stall.store(true);
  ASSERT_TRUE(eventually([&] { return stalled.load(); }));
  // The servo hangs in read() and cannot help; somebody else must.
  const std::uint64_t before = device.zeros();
  ASSERT_TRUE(eventually([&] { return device.zeros() >= before + 2; })) << "and again while the silence lasts";
  EXPECT_EQ(device.force_n(), 0.0);
  EXPECT_GE(servo.watchdog_trips(), 1U);
  device.forget_strongest();
  stall.store(false);
  ASSERT_TRUE(eventually([&] { return servo.faults() > 0; }));
  const std::uint64_t back = device.ticks();
  ASSERT_TRUE(eventually([&] { return device.ticks() > back + 200; }));
  EXPECT_EQ(device.strongest_n(), 0.0) << "still in the stone: no force";
  EXPECT_EQ(state.read().contact, 1U);
  hold.store(false);
  ASSERT_TRUE(eventually([&] { return (state.read().flags & kFlagArmed) != 0; }));
  EXPECT_TRUE(eventually([&] { return device.force_n() > 0.0; }));
  servo.stop();
  EXPECT_EQ(device.force_n(), 0.0);
}

TEST(Servo, TheWatchdogActsWithinAFewMillisecondsOfItsPatience) {
  ScriptedDevice device([](std::uint64_t, double time_s) { return in_air(time_s); });
  Watchdog watchdog(device, 0.010);
  const std::int64_t begun_ns = now_ns();
  watchdog.start(85);
  watchdog.feed(begun_ns);
  ASSERT_TRUE(eventually([&] { return watchdog.tripped(); }));
  EXPECT_GE(now_ns() - begun_ns, 10'000'000) << "not before";
  std::printf("tripped after %.2f ms\n", static_cast<double>(now_ns() - begun_ns) * 1e-6);
  watchdog.stop();
  EXPECT_GE(device.zeros(), 1U);
}

TEST(Servo, TheWatchdogWaitsForAServoThatHasNotSpokenYet) {
  ScriptedDevice device([](std::uint64_t, double time_s) { return in_air(time_s); });
  Watchdog watchdog(device, 0.001);
  watchdog.start(0);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // a servo that locks its memory
  EXPECT_FALSE(watchdog.tripped());
  EXPECT_EQ(watchdog.trips(), 0U);
  watchdog.feed(now_ns());
  EXPECT_TRUE(eventually([&] { return watchdog.tripped(); })) << "from then on";
  watchdog.stop();
}

TEST(Servo, AnswersADeviceThatGivesNotANumberWithZeroForce) {
  std::atomic<bool> bad{false};
  ScriptedDevice device([&](std::uint64_t tick, double time_s) {
    DeviceSample sample = touch(tick, time_s);
    if (bad.load()) sample.position_m.y() = std::numeric_limits<double>::quiet_NaN();
    return sample;
  });
  Seqlock<State> state;
  Servo servo(device, patient(), window_on(sparsha::test::flat_scene()), state, {}, nullptr);
  servo.start();
  ASSERT_TRUE(eventually([&] { return device.force_n() > 0.0; }));
  bad.store(true);
  ASSERT_TRUE(eventually([&] { return device.force_n() == 0.0; }));
  ASSERT_TRUE(eventually([&] { return (state.read().flags & kFlagFault) != 0; }));
  EXPECT_TRUE(std::isfinite(state.read().hip_m[1]));
  servo.stop();
  EXPECT_GT(servo.figures().faults, 0U);
}

TEST(Servo, AnswersUnpluggingWithZeroForceAndSaysSo) {
  std::atomic<bool> plugged{true};
  ScriptedDevice device([&](std::uint64_t tick, double time_s) {
    DeviceSample sample = touch(tick, time_s);
    sample.connected = plugged.load();
    return sample;
  });
  Seqlock<State> state;
  Servo servo(device, patient(), window_on(sparsha::test::flat_scene()), state, {}, nullptr);
  servo.start();
  ASSERT_TRUE(eventually([&] { return device.force_n() > 0.0; }));
  EXPECT_FALSE(servo.unplugged());
  plugged.store(false);
  ASSERT_TRUE(eventually([&] { return servo.unplugged(); }));
  EXPECT_EQ(device.force_n(), 0.0);
  servo.stop();
}

TEST(Servo, EndsInZeroForce) {
  ScriptedDevice device([](std::uint64_t tick, double time_s) { return touch(tick, time_s); });
  Seqlock<State> state;
  Servo servo(device, patient(), window_on(sparsha::test::flat_scene()), state, {}, nullptr);
  servo.start();
  ASSERT_TRUE(eventually([&] { return device.force_n() > 0.0; }));
  servo.stop();
  EXPECT_EQ(device.force_n(), 0.0);
  EXPECT_EQ(state.read().commanded_force_n, (std::array<double, 3>{}));
}

TEST(Servo, SkipsTheTicksItMissedInsteadOfCatchingUp) {
  std::vector<double> times;
  times.reserve(10'000);
  const auto script = [&](std::uint64_t tick, double time_s) {
    if (tick == 20) std::this_thread::sleep_for(std::chrono::milliseconds(30));
    times.push_back(time_s);
    return in_air(time_s);
  };
  ScriptedDevice device(script, true);
  Seqlock<State> state;
  Servo servo(device, patient(), window_on(sparsha::test::flat_scene()), state, {}, nullptr);
  servo.start();
  ASSERT_TRUE(eventually([&] { return device.ticks() > 60; }));
  servo.stop();
  EXPECT_GE(servo.figures().missed_ticks, 29U);
  EXPECT_GE(times[21] - times[20], 0.029) << "the clock went on; the servo went with it";
  for (std::size_t i = 1; i < times.size(); ++i) ASSERT_GT(times[i], times[i - 1] + 0.0009);
}

TEST(Servo, RetiredSurfacesAreFreedByTheThreadThatCollects) {
  const auto scene = sparsha::test::flat_scene();
  const auto device = make_simulated_device(2, 0.0);
  Seqlock<State> state;
  std::atomic<int> freed{0};
  std::atomic<int> freed_elsewhere{0};
  const std::thread::id here = std::this_thread::get_id();
  const auto watched_window = [&](std::uint64_t id) {
    HapticWindow window = window_on(scene, 0, id);
    window.surface = SurfacePointer(new MongeSurface(*window.surface), [&, here](const MongeSurface* surface) {
      freed.fetch_add(1);
      if (std::this_thread::get_id() != here) freed_elsewhere.fetch_add(1);
      delete surface;
    });
    return window;
  };
  {
    Servo servo(*device, patient(), watched_window(1), state, {}, nullptr);
    servo.start();
    for (std::uint64_t id = 2; id < 40; ++id) {
      Command command;
      command.kind = Command::Kind::swap;
      command.window = watched_window(id);
      command.sequence = id;
      ASSERT_TRUE(servo.post(std::move(command)));
      ASSERT_TRUE(eventually([&] { return state.read().surface_id == id; }));
      servo.collect();
    }
    servo.stop();
    std::printf("a swap cost the servo at most %.2f us\n", servo.figures().swap_ns_max * 1e-3);
    EXPECT_EQ(freed.load(), 38);
  }
  EXPECT_EQ(freed.load(), 39);
  EXPECT_EQ(freed_elsewhere.load(), 0);
}

TEST(Servo, KeepsItsSurfaceWhenNobodyCollectsTheRetiredOnes) {
  const auto scene = sparsha::test::flat_scene();
  const auto device = make_simulated_device(2, 0.0);
  Seqlock<State> state;
  Servo servo(*device, patient(), window_on(scene), state, {}, nullptr);
  servo.start();
  const HapticWindow window = window_on(scene, 0, 7);
  std::uint64_t posted = 0;
  ASSERT_TRUE(eventually([&] {
    Command command;
    command.kind = Command::Kind::swap;
    command.window = window;
    command.sequence = posted + 1;
    if (servo.post(std::move(command))) ++posted;
    return posted > 190;  // 128 retired, one in hand, the rest of 64 waiting in the queue
  }));
  servo.collect();
  EXPECT_TRUE(eventually([&] { return state.read().command == posted; }));
  servo.stop();
}

TEST(Servo, GivesEveryConsumerEveryContactEvent) {
  ScriptedDevice device(
      [](std::uint64_t tick, double time_s) { return (tick / 100) % 2 == 0 ? in_air(time_s) : in_stone(time_s); });
  Seqlock<State> state;
  const auto first = std::make_shared<ContactQueue>(1024);
  const auto second = std::make_shared<ContactQueue>(1024);
  Servo servo(device, patient(), window_on(sparsha::test::flat_scene()), state, {first, second}, nullptr);
  servo.start();
  ASSERT_TRUE(eventually([&] { return device.ticks() > 1050; }));
  servo.stop();
  const auto count = [](ContactQueue& queue, ContactEvent::Kind kind) {
    int result = 0;
    ContactEvent event;
    std::vector<ContactEvent> all;
    while (queue.pop(event)) all.push_back(event);
    for (const ContactEvent& e : all) result += e.kind == kind ? 1 : 0;
    for (ContactEvent& e : all) EXPECT_TRUE(queue.push(std::move(e)));
    return result;
  };
  EXPECT_EQ(count(*first, ContactEvent::Kind::touch), 5);
  EXPECT_EQ(count(*second, ContactEvent::Kind::touch), 5);
  EXPECT_EQ(count(*first, ContactEvent::Kind::lift), 5);
}

}  // namespace
}  // namespace sparsha::haptics
