// A servo that comes too late holds no force: pauses, jumps of the clock, stopped programs and loaded machines.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <memory>
#include <new>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "haptics/servo/real_time.h"
#include "haptics/servo/servo.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kPeriod_ns = 1 * kMs;

/// What the device was told, and when.
struct Write {
  std::int64_t time_ns = 0;
  double force_n = 0.0;
  bool in_air = false;  ///< where the hand was
};

/// The hand is in the air for the first 100 of every 400 ticks and 2 mm in the stone for the others. Time passes as the
/// test wishes.
class WatchedDevice final : public Device {
 public:
  enum class Place { sleep, read, decision, write };
  explicit WatchedDevice(bool paced) { info_.paced = paced; }

  // One clock for the whole loop: it goes on a little at every look, and jumps where the test wants it to.
  [[nodiscard]] ServoClock clock() {
    return {[this] { return look(); }, [this](std::int64_t until_ns) { sleep(until_ns); }};
  }
  [[nodiscard]] DeviceInfo info() const override { return info_; }
  void wait(double timeout_s) noexcept override { sleep(time_ns_ + static_cast<std::int64_t>(timeout_s * 1e9)); }
  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    ++tick;
    in_air_ = tick % 400 < 100;
    jump(Place::read);
    looks_ = 0;
    DeviceSample sample = sample_at({0.0, 0.0, in_air_ ? 0.02 : -0.002}, time_s);
    sample.finished = tick >= last_tick;
    return sample;
  }
  void write(const Eigen::Vector3d& force_n) noexcept override {
    jump(Place::write);
    writes.push_back({time_ns_, force_n.norm(), in_air_});
  }
  void zero() noexcept override {}  // write() says it too

  Place place = Place::sleep;
  std::uint64_t at_tick = 0;
  std::int64_t jump_ns = 0;
  std::uint64_t tick = 0;
  std::uint64_t last_tick = 1200;
  std::vector<Write> writes;

 private:
  void jump(Place here) {
    if (here == place && tick == at_tick) time_ns_ += std::exchange(jump_ns, 0);
  }
  std::int64_t look() {
    // After read(): once with the hand in hand, once when the force is decided.
    if (++looks_ == 2) jump(Place::decision);
    return time_ns_ += 100;
  }
  void sleep(std::int64_t until_ns) {
    time_ns_ = std::max(time_ns_, until_ns) + 20'000;
    jump(Place::sleep);
  }

  DeviceInfo info_;
  std::int64_t time_ns_ = 1'000'000'000'000;
  int looks_ = 0;
  bool in_air_ = false;
};

/// Judges what a device was told by times and forces alone. `slack_ns`: how far the judge's clock may be off.
void judge(const std::vector<Write>& writes, std::int64_t slack_ns, double slew_n_per_s, std::size_t& pauses,
           std::int64_t patience_ns = 10 * kMs) {
  bool held_back = false;
  std::int64_t free_ns = 0;
  for (std::size_t i = 1; i < writes.size(); ++i) {
    const std::int64_t gap_ns = writes[i].time_ns - writes[i - 1].time_ns;
    // Writes at one moment: only the last of them is held.
    const bool held = i + 1 == writes.size() || writes[i + 1].time_ns - writes[i].time_ns > kMs / 5;
    if (gap_ns > patience_ns + kPeriod_ns + slack_ns || gap_ns < 0) {
      held_back = true;
      free_ns = 0;
      ++pauses;
    } else if (writes[i].in_air) {
      free_ns += gap_ns;
    } else {
      free_ns = 0;
    }
    if (held && held_back) {
      ASSERT_EQ(writes[i].force_n, 0.0) << "write " << i << ", " << free_ns << " ns in free space";
    }
    if (free_ns >= 50 * kMs) held_back = false;
    if (held) {
      ASSERT_LE(writes[i].force_n - writes[i - 1].force_n,
                slew_n_per_s * 1e-9 * static_cast<double>(kPeriod_ns) * (1.0 + 1e-9))
          << "write " << i << ", gap " << gap_ns << " ns";
    }
  }
}

TEST(Lateness, APauseAtAnyPlaceOfATickEndsTheForceUntilTheHandHasBeenInTheAir) {
  using Place = WatchedDevice::Place;
  for (const bool paced : {false, true})
    for (const Place place : {Place::sleep, Place::read, Place::decision, Place::write})
      for (const std::int64_t jump_ns : {12 * kMs, 20 * kMs, 300 * kMs, 1000 * kMs, 3'600'000 * kMs, -1000 * kMs}) {
        SCOPED_TRACE(::testing::Message() << "paced " << paced << ", place " << static_cast<int>(place) << ", jump "
                                          << jump_ns / kMs << " ms");
        WatchedDevice device(paced);
        device.place = place;
        device.at_tick = 250;  // in the stone, at full force
        device.jump_ns = jump_ns;
        const ClockedRun run(device);
        ASSERT_TRUE(run.finished) << "no clock makes it sleep for ever";
        std::size_t pauses = 0;
        judge(device.writes, 0, DeviceInfo{}.limits.slew_n_per_s, pauses);
        EXPECT_GE(pauses, 1U);
        EXPECT_GE(run.servo.figures().late_faults, 1U);
        EXPECT_GE(run.servo.silences(), 1U);
        double strongest_n = 0.0;
        for (const Write& write : device.writes)
          if (&write > &device.writes[device.writes.size() - 600]) strongest_n = std::max(strongest_n, write.force_n);
        EXPECT_NEAR(strongest_n, 1.6, 1e-6) << "after the air there is force again";
      }
}

TEST(Lateness, BelowTenMillisecondsIsNoFaultAndGrowsTheForceByOneNominalStepOnly) {
  for (const std::int64_t jump_ns : {2 * kMs, 5 * kMs, 9 * kMs}) {
    WatchedDevice device(false);
    device.place = WatchedDevice::Place::sleep;
    device.at_tick = 99;  // it sleeps over the beginning of contact
    device.jump_ns = jump_ns;
    const ClockedRun run(device);
    ASSERT_TRUE(run.finished);
    std::size_t pauses = 0;
    judge(device.writes, 0, DeviceInfo{}.limits.slew_n_per_s, pauses);
    EXPECT_EQ(pauses, 0U);
    EXPECT_EQ(run.servo.figures().late_faults, 0U);
    EXPECT_LE(run.servo.figures().faults, run.servo.figures().watchdog_trips * 2) << "the watchdog has the real clock";
  }
}

TEST(Lateness, AHundredHertzAreSlowAndNotLate) {
  WatchedDevice device(false);
  const ClockedRun run(device, 100.0);
  ASSERT_TRUE(run.finished);
  EXPECT_EQ(run.servo.figures().late_faults, 0U);
  double strongest_n = 0.0;
  for (const Write& write : device.writes) strongest_n = std::max(strongest_n, write.force_n);
  EXPECT_GT(strongest_n, 0.05);
}

/// Memory that a child process shares with this one.
struct Shared {
  static constexpr std::size_t kMost = 1U << 16U;
  std::atomic<std::uint64_t> count{0};
  std::atomic<bool> stop{false};
  Write writes[kMost];
};

class LoggingDevice final : public Device {
 public:
  explicit LoggingDevice(Shared& shared) : shared_(shared) {}
  [[nodiscard]] DeviceInfo info() const override { return {}; }
  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    in_air_ = ++tick_ % 160 < 60;
    return sample_at({0.0, 0.0, in_air_ ? 0.02 : -0.002}, time_s);
  }
  void write(const Eigen::Vector3d& force_n) noexcept override { log(force_n.norm()); }
  void zero() noexcept override {}  // write() says it too

 private:
  void log(double force_n) noexcept {
    const std::uint64_t at = shared_.count.load();
    if (at >= Shared::kMost) return;
    shared_.writes[at] = {now_ns(), force_n, in_air_};
    shared_.count.store(at + 1);
  }
  Shared& shared_;
  std::uint64_t tick_ = 0;
  bool in_air_ = false;
};

/// A servo in a process of its own, until it is told to stop.
class Child {
 public:
  explicit Child(bool real_time, std::int64_t patience_ns = 10 * kMs) {
    void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    shared = new (memory) Shared;
    std::fflush(nullptr);
    id = fork();
    if (id != 0) return;
    {
      LoggingDevice device(*shared);
      Seqlock<State> state;
      ServoOptions options;
      options.real_time = real_time;
      options.renderer.longest_gap_s = 1e-9 * static_cast<double>(patience_ns);
      Servo servo(device, options, window_on(sparsha::test::flat_scene()), state, {}, nullptr);
      servo.start();
      while (!shared->stop.load()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      servo.stop();
    }
    _exit(0);
  }
  ~Child() {
    kill(id, SIGCONT);
    shared->stop.store(true);
    int status = 0;
    waitpid(id, &status, 0);
    munmap(shared, sizeof(Shared));
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  [[nodiscard]] std::vector<Write> writes() const { return {shared->writes, shared->writes + shared->count.load()}; }
  [[nodiscard]] bool pushes() const {
    const std::uint64_t count = shared->count.load();
    return count > 0 && shared->writes[count - 1].force_n > 0.0;
  }

  Shared* shared = nullptr;
  pid_t id = 0;
};

TEST(Lateness, AProgramThatWasStoppedAndContinuedHoldsNoForceBeforeTheHandHasBeenInTheAir) {
  // So patient that the machine's own pauses, which may be many, are none.
  constexpr std::int64_t kPatience_ns = 100 * kMs;
  for (const bool real_time : {true, false}) {
    std::vector<Write> writes;
    {
      Child child(real_time, kPatience_ns);
      std::mt19937_64 random(9);
      for (const int pause_ms : {105, 110, 120, 150, 200, 300, 500, 110, 120, 120}) {
        ASSERT_TRUE(eventually([&] { return child.pushes(); }));
        std::this_thread::sleep_for(std::chrono::microseconds(random() % 3000));
        kill(child.id, SIGSTOP);
        std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
        kill(child.id, SIGCONT);
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
      }
      ASSERT_TRUE(eventually([&] { return child.pushes(); }));
      writes = child.writes();
    }
    std::size_t pauses = 0;
    judge(writes, kMs / 2, DeviceInfo{}.limits.slew_n_per_s, pauses, kPatience_ns);
    EXPECT_GE(pauses, 6U) << "of ten, some may have met a hand that was just lifted";
  }
}

TEST(Lateness, OnALoadedMachineWithoutRealTimeRightsNoLateTickHoldsForce) {
  std::vector<Write> writes;
  {
    Child child(false);
    std::atomic<bool> stop{false};
    std::vector<std::thread> hogs;
    for (unsigned i = 0; i < 6 * std::max(2U, std::thread::hardware_concurrency()); ++i)
      hogs.emplace_back([&] {
        double sum = 0.0;
        while (!stop.load(std::memory_order_relaxed)) sum += std::sqrt(sum + 1.0);
        EXPECT_GT(sum, 0.0);
      });
    EXPECT_TRUE(eventually([&] { return child.shared->count.load() > 3000; }));
    stop.store(true);
    for (std::thread& hog : hogs) hog.join();
    writes = child.writes();
  }
  std::size_t pauses = 0;
  judge(writes, kMs / 2, DeviceInfo{}.limits.slew_n_per_s, pauses);
  std::printf("%zu writes, %zu pauses of more than 10 ms\n", writes.size(), pauses);
}

}  // namespace
}  // namespace sparsha::haptics
