// A device that does not keep the pace that it promises, and hands that cannot have moved so.
#include "haptics/servo/pace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <thread>

#include "haptics/servo/servo.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

constexpr std::int64_t kPeriod_ns = 1'000'000;
constexpr std::int64_t kStart_ns = 1'000'000'000'000;

TEST(Pace, BelievesADeviceWhoseAnswersComeUnevenly) {
  std::mt19937_64 random(39);
  std::uniform_int_distribution<std::int64_t> gap_ns(50'000, 1'900'000);
  Pace pace(kPeriod_ns);
  std::int64_t time_ns = kStart_ns;
  for (int tick = 0; tick < 100'000; ++tick) {
    // Now and then the program pauses, and three answers are there at once.
    time_ns += tick % 1000 < 3 ? 10'000 : gap_ns(random);
    if (tick % 1000 == 0) time_ns += 8'000'000;
    ASSERT_EQ(pace.admit(time_ns), time_ns) << "tick " << tick;
    ASSERT_FALSE(pace.runs_away()) << "tick " << tick;
  }
}

TEST(Pace, HoldsADeviceThatReturnsAtOnceToFourTicksAPeriodAndBelievesItAgainWhenItWaits) {
  Pace pace(kPeriod_ns);
  std::int64_t time_ns = kStart_ns;
  int ticks = 0;
  int before = 0;  // it has run away
  for (; time_ns < kStart_ns + 1000 * kPeriod_ns; ++ticks) {
    time_ns = pace.admit(time_ns + 17'000);
    if (!pace.runs_away()) ++before;
  }
  EXPECT_LE(ticks, 4 * 1000 + 12);
  EXPECT_GE(ticks, 4 * 1000 - 12);
  EXPECT_LE(before, 12) << "twelve ticks of 17 us: the force ends within a period";
  for (int tick = 0; tick < 20; ++tick) time_ns = pace.admit(time_ns + kPeriod_ns);
  EXPECT_FALSE(pace.runs_away());
}

TEST(Pace, AClockThatGoesBackwardsMakesNobodyWait) {
  Pace pace(kPeriod_ns);
  std::int64_t time_ns = kStart_ns;
  for (int tick = 0; tick < 10; ++tick) time_ns = pace.admit(time_ns + kPeriod_ns);
  time_ns -= 3'600'000'000'000;
  EXPECT_EQ(pace.admit(time_ns), time_ns);
  EXPECT_FALSE(pace.runs_away());
}

/// Of `samples` samples of a place over time, those that are said to be none of a hand.
template <typename Place>
int jumps_of(int samples, double period_s, const Place& place_m) {
  HandSpeed hand(5.0);
  int jumps = 0;
  for (int tick = 0; tick < samples; ++tick) {
    DeviceSample sample = sample_at({0.0, 0.0, place_m(period_s * tick, tick)}, period_s * tick);
    if (hand.jumps(sample, period_s)) ++jumps;
  }
  return jumps;
}

TEST(HandSpeed, FindsATrembleThatNoHandCanMakeAndNoStrikeNoiseOrTremor) {
  const auto tremble = [](double size_m) {
    return [size_m](double, int tick) { return tick % 2 == 0 ? size_m : 0.0; };
  };
  EXPECT_EQ(jumps_of(1000, 0.001, tremble(0.001)), 995) << "from the sixth sample on";
  EXPECT_EQ(jumps_of(1000, 0.00025, tremble(0.0005)), 995);
  EXPECT_EQ(jumps_of(1000, 0.001, tremble(0.0001)), 0) << "an encoder of coarse steps between two of them";
  EXPECT_EQ(jumps_of(1000, 0.02, tremble(0.02)), 0) << "fifty times a second, and slow enough";
  const auto strikes = [](double time_s, int) { return std::abs(std::fmod(time_s, 0.02) - 0.01) * 2.0; };
  EXPECT_EQ(jumps_of(1000, 0.001, strikes), 0) << "at 2 m/s against a hard stop, each 20 ms";
  const auto tremor = [](double time_s, int) { return 0.01 * std::sin(2.0 * std::numbers::pi * 12.0 * time_s); };
  EXPECT_EQ(jumps_of(1000, 0.001, tremor), 0);
  std::mt19937 random(5);
  std::normal_distribution<double> noise_m(0.0, 80e-6);
  HandSpeed noisy(5.0);
  for (int tick = 0; tick < 50'000; ++tick) {
    const double time_s = 0.001 * tick;
    const double z_m = tremor(time_s, tick) + noise_m(random);
    ASSERT_FALSE(noisy.jumps(sample_at({noise_m(random), noise_m(random), z_m}, time_s), 0.001)) << tick;
  }
}

TEST(HandSpeed, FindsATrembleWhosePositionsComeTwice) {
  for (const double look_s : {0.0, 0.002, 0.01}) {
    HandSpeed hand(5.0);
    int jumps = 0;
    for (int tick = 0; tick < 1000; ++tick) {
      const double z_m = tick / 2 % 2 == 0 ? 0.0 : 0.002;
      if (hand.jumps(sample_at({0.0, 0.0, z_m}, 0.001 * tick), 0.001, look_s)) ++jumps;
    }
    EXPECT_GT(jumps, 980) << look_s;
  }
}

TEST(HandSpeed, BelievesADeviceAgainThatHasTrembledAndIsStillOrWasPluggedInAnew) {
  for (const double look_s : {0.0, 0.01}) {
    HandSpeed hand(5.0);
    const auto jumps = [&](int tick, double z_m, bool connected = true) {
      DeviceSample sample = sample_at({0.0, 0.0, z_m}, 0.001 * tick);
      sample.connected = connected;
      return hand.jumps(sample, 0.001, look_s);
    };
    int tick = 0;
    const auto tremble = [&] {
      for (const int end = tick + 20; tick < end; ++tick) static_cast<void>(jumps(tick, tick % 2 == 0 ? 0.001 : 0.0));
      ASSERT_TRUE(jumps(tick++, 0.001)) << look_s;
    };
    tremble();
    int late = 0;
    for (int still = 0; still < 200; ++still)
      if (jumps(tick++, 0.001) && still > 50) ++late;
    EXPECT_EQ(late, 0) << look_s;
    tremble();
    EXPECT_FALSE(jumps(tick++, 0.0, false));
    EXPECT_FALSE(jumps(tick++, 0.001)) << look_s;
  }
}

TEST(HandSpeed, OfADeviceThatRepeatsAllowsWhatPassedSinceThePositionChanged) {
  HandSpeed hand(5.0);
  const auto at = [](double x_m, double time_s) { return sample_at({x_m, 0.0, 0.0}, time_s); };
  for (int tick = 0; tick < 10; ++tick) EXPECT_FALSE(hand.jumps(at(0.0, 0.001 * tick), 0.001, 0.01));
  EXPECT_FALSE(hand.jumps(at(0.04, 0.010), 0.001, 0.01)) << "4 m/s for a look of 10 ms";
  EXPECT_TRUE(hand.jumps(at(0.08, 0.011), 0.001, 0.01)) << "40 m/s for a tick";
}

TEST(HandSpeed, FindsJumpsAndNothingElse) {
  HandSpeed hand(5.0);
  double time_s = 1.0;
  const auto at = [&](double x_m, double after_s) { return sample_at({x_m, 0.0, 0.0}, time_s += after_s); };
  EXPECT_FALSE(hand.jumps(at(0.04, 0.001), 0.001)) << "the first position may be anywhere";
  EXPECT_FALSE(hand.jumps(at(0.0405, 0.001), 0.001)) << "half a metre a second";
  EXPECT_FALSE(hand.jumps(at(0.0455, 0.001), 0.001)) << "five";
  EXPECT_TRUE(hand.jumps(at(0.0255, 0.001), 0.001)) << "twenty";
  EXPECT_FALSE(hand.jumps(at(0.0255, 0.001), 0.001)) << "and there it stays";
  DeviceSample stale = at(-0.05, 0.001);
  stale.fresh = false;
  EXPECT_FALSE(hand.jumps(stale, 0.001)) << "a stale position is none";
  EXPECT_FALSE(hand.jumps(at(0.0275, 0.001), 0.001));
  DeviceSample lost = at(0.0, 0.001);
  lost.position_m.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(hand.jumps(lost, 0.001)) << "others see that";
  EXPECT_FALSE(hand.jumps(at(-0.04, 0.001), 0.001));
  EXPECT_FALSE(hand.jumps(at(0.04, 0.2), 0.001)) << "long ago";
  HandSpeed any(0.0);
  EXPECT_FALSE(any.jumps(at(0.0, 0.001), 0.001));
  EXPECT_FALSE(any.jumps(at(1.0, 0.001), 0.001));
}

/// Paces the servo by a thread's sleep until its service dies: then wait() returns at once, and the last position is
/// given again and again as if it were new.
class DyingDevice final : public Device {
 public:
  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info;
    info.name = "dying";
    info.paced = true;
    return info;
  }
  void wait(double timeout_s) noexcept override {
    if (!dead.load()) std::this_thread::sleep_for(std::chrono::duration<double>(timeout_s));
  }
  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    const std::uint64_t tick = ticks.fetch_add(1);
    return sample_at({0.0, 0.0, tick < 200 ? 0.02 : -0.002}, time_s);
  }
  void write(const Eigen::Vector3d& force) noexcept override { force_n.store(force.norm()); }
  void zero() noexcept override { force_n.store(0.0); }

  std::atomic<bool> dead{false};
  std::atomic<std::uint64_t> ticks{0};
  std::atomic<double> force_n{0.0};
};

class CountingSink final : public RecordSink {
 public:
  bool push(const Record&) noexcept override {
    rows.fetch_add(1);
    return true;
  }
  [[nodiscard]] std::uint64_t dropped() const noexcept override { return 0; }
  std::atomic<std::uint64_t> rows{0};
};

TEST(Servo, ADeviceWhoseWaitReturnsAtOnceGetsNoForceAndNeitherSpinsNorFillsTheRecording) {
  DyingDevice device;
  Seqlock<State> state;
  CountingSink sink;
  Servo servo(device, patient(), window_on(sparsha::test::flat_scene()), state, {}, &sink);
  servo.start();
  ASSERT_TRUE(eventually([&] { return device.force_n.load() > 0.0; }));
  EXPECT_EQ(servo.runaways(), 0U);
  device.dead.store(true);
  ASSERT_TRUE(eventually([&] { return servo.runaways() > 0; }));
  const std::int64_t begun_ns = now_ns();
  const std::uint64_t before = sink.rows.load();
  ASSERT_TRUE(eventually([&] { return now_ns() - begun_ns > 300'000'000; }));
  const double rows = static_cast<double>(sink.rows.load() - before);
  EXPECT_LE(rows, 4e3 * 1e-9 * static_cast<double>(now_ns() - begun_ns) + 12.0);
  EXPECT_EQ(device.force_n.load(), 0.0);
  EXPECT_EQ((state.read().flags & kFlagArmed), 0U);
  servo.stop();
  const ServoFigures& figures = servo.figures();
  EXPECT_GT(figures.runaways, 100U);
  EXPECT_GE(figures.faults, figures.runaways);
  EXPECT_LE(figures.ticks_in_time + figures.runaways, figures.ticks) << "no tick without a plan is in time";
}

TEST(Servo, APositionThatNoHandCanHaveComeToEndsTheForceUntilTheHandHasBeenInTheAir) {
  std::atomic<bool> jump{false};
  class Fast final : public Device {
   public:
    explicit Fast(std::atomic<bool>& jump) : jump_(jump) {}
    [[nodiscard]] DeviceInfo info() const override {
      DeviceInfo info;
      info.name = "fast";
      info.fastest_m_per_s = 5.0;
      return info;
    }
    // In the air, then slowly down into the stone; after the jump it is a centimetre aside.
    [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
      depth_m_ = std::min(depth_m_ + 2e-5, 0.002);
      return sample_at({jump_.load() ? 0.02 : 0.0, 0.0, -depth_m_}, time_s);
    }
    void write(const Eigen::Vector3d& force) noexcept override { force_n.store(force.norm()); }
    void zero() noexcept override {}
    std::atomic<double> force_n{0.0};

   private:
    std::atomic<bool>& jump_;
    double depth_m_ = -0.01;
  } device(jump);
  Seqlock<State> state;
  Servo servo(device, patient(), window_on(sparsha::test::flat_scene()), state, {}, nullptr);
  servo.start();
  ASSERT_TRUE(eventually([&] { return device.force_n.load() > 0.5; }));
  EXPECT_EQ(servo.jumps(), 0U);
  jump.store(true);
  ASSERT_TRUE(eventually([&] { return servo.jumps() == 1; }));
  const std::uint64_t tick = state.read().tick;
  ASSERT_TRUE(eventually([&] { return state.read().tick > tick + 100; }));
  EXPECT_EQ(device.force_n.load(), 0.0) << "still in the stone";
  EXPECT_EQ(state.read().contact, 1U);
  servo.stop();
  EXPECT_EQ(servo.figures().jumps, 1U);
}

TEST(Servo, AFastHandThatIsSeenEveryTenthTickDoesNotJump) {
  class Seldom final : public Device {
   public:
    [[nodiscard]] DeviceInfo info() const override {
      DeviceInfo info;
      info.name = "seldom";
      info.fastest_m_per_s = 2.0;
      return info;
    }
    // To and fro at half a metre a second; what was seen is repeated.
    [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
      const auto look = static_cast<int>(ticks_++ / 10);
      const int place = look % 20 < 10 ? look % 10 : 10 - look % 10;
      return sample_at({0.005 * place, 1e-5 * (look % 7), 0.02}, time_s);
    }
    void write(const Eigen::Vector3d&) noexcept override {}
    void zero() noexcept override {}

   private:
    std::uint64_t ticks_ = 0;
  } device;
  Seqlock<State> state;
  Servo servo(device, patient(), window_on(sparsha::test::flat_scene()), state, {}, nullptr);
  servo.start();
  ASSERT_TRUE(eventually([&] { return state.read().tick > 1000; }));
  servo.stop();
  EXPECT_LE(servo.figures().jumps, 4U) << "until the looks are known";
}

}  // namespace
}  // namespace sparsha::haptics
