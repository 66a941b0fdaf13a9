// Devices that do wrong are found, and it is said what that would do to a hand; devices that do right pass.
#include "haptics/conformance/conformance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <future>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "haptics/device/simulated/simulated_device.h"
#include "haptics/servo/real_time.h"

namespace sparsha::haptics {
namespace {
using ::testing::HasSubstr;
using Result = ConformanceStep::Result;

/// Right in all things but those that a test changes.
class Hand : public Device {
 public:
  Hand() {
    info_.name = "hand";
    info_.paced = true;
    info_.fastest_m_per_s = 5.0;
  }
  [[nodiscard]] DeviceInfo info() const override { return info_; }
  void wait(double timeout_s) noexcept override {
    sleep_until_ns(now_ns() + static_cast<std::int64_t>(timeout_s * 1e9));
  }
  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    DeviceSample sample;
    sample.position_m = {0.01 * std::sin(10.0 * time_s), 0.0, 0.02};
    sample.time_s = time_s;
    sample.fresh = true;
    return sample;
  }
  void write(const Eigen::Vector3d& force_n) noexcept override {
    if (force_n != Eigen::Vector3d::Zero()) forces.fetch_add(1);
  }
  void zero() noexcept override {}

  std::atomic<int> forces{0};

 protected:
  DeviceInfo info_;
};

ConformanceOptions quick() {
  ConformanceOptions options;
  options.watch_s = 0.25;
  options.patience_s = 0.3;  // a machine that others use as well
  return options;
}

ConformanceStep step_of(const std::vector<ConformanceStep>& steps, const std::string& name) {
  for (const ConformanceStep& step : steps)
    if (step.name == name) return step;
  ADD_FAILURE() << "no step " << name;
  return {};
}

template <typename Faulty>
ConformanceStep watched(const std::string& name) {
  return step_of(watch_device(std::make_shared<Faulty>(), quick()), name);
}

TEST(Conformance, WatchesADeviceThatDoesRight) {
  const auto hand = std::make_shared<Hand>();
  for (const ConformanceStep& step : watch_device(hand, quick()))
    EXPECT_EQ(step.result, Result::passed) << step.name << ": " << step.found;
  EXPECT_EQ(hand->forces.load(), 0);
  for (const ConformanceStep& step : watch_device(make_simulated_device(1, 0.0), quick()))
    EXPECT_EQ(step.result, Result::passed) << step.name << ": " << step.found;
}

TEST(Conformance, FindsAWaitThatReturnsAtOnce) {
  struct Spins : Hand {
    void wait(double) noexcept override {}
  };
  const ConformanceStep step = watched<Spins>("pace");
  EXPECT_EQ(step.result, Result::failed);
  EXPECT_THAT(step.found, HasSubstr("wait() returned at once"));
  EXPECT_THAT(step.to_a_hand, HasSubstr("no force"));
}

TEST(Conformance, FindsAWaitThatNeverReturns) {
  struct Hangs : Hand {
    void wait(double) noexcept override {
      while (!over.load()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::atomic<bool> over{false};
  };
  const auto device = std::make_shared<Hangs>();
  const auto report = check_conformance(device, quick());
  EXPECT_FALSE(report.passed());
  const ConformanceStep step = step_of(report.steps, "calls");
  EXPECT_EQ(step.result, Result::failed);
  EXPECT_THAT(step.found, HasSubstr("wait() has not returned for 1 s"));
  EXPECT_EQ(report.steps.size(), 2U) << "and nothing more is asked of it";
  device->over.store(true);
}

TEST(Conformance, FindsAWaitThatIsAlwaysLate) {
  struct Slow : Hand {
    void wait(double) noexcept override { sleep_until_ns(now_ns() + 50'000'000); }
  };
  ConformanceOptions options = quick();
  options.patience_s = 0.010;
  const auto steps = watch_device(std::make_shared<Slow>(), options);
  EXPECT_EQ(step_of(steps, "pace").result, Result::failed);
  EXPECT_EQ(step_of(steps, "news").result, Result::failed) << "twenty a second";
}

TEST(Conformance, FindsPositionsThatCannotBe) {
  struct NoNumber : Hand {
    [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
      DeviceSample sample = Hand::read(time_s, period_s);
      sample.position_m.z() = std::numeric_limits<double>::quiet_NaN();
      return sample;
    }
  };
  EXPECT_THAT(watched<NoNumber>("positions").found, HasSubstr("no numbers"));
  struct Jumps : Hand {
    [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
      DeviceSample sample = Hand::read(time_s, period_s);
      if (++tick % 32 == 0) sample.position_m.x() += 0.03;
      return sample;
    }
    int tick = 0;
  };
  const ConformanceStep jumps = watched<Jumps>("positions");
  EXPECT_EQ(jumps.result, Result::failed);
  EXPECT_THAT(jumps.found, HasSubstr("no hand can have come to"));
  EXPECT_THAT(jumps.to_a_hand, HasSubstr("the force ends"));
  struct Unchecked : Jumps {
    Unchecked() { info_.fastest_m_per_s = 0.0; }
  };
  EXPECT_THAT(watched<Unchecked>("positions").to_a_hand, HasSubstr("a blow"));
  struct OtherClock : Hand {
    [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
      return Hand::read(time_s + 1e6, period_s);
    }
  };
  EXPECT_THAT(watched<OtherClock>("positions").found, HasSubstr("another clock"));
}

TEST(Conformance, FindsFactsThatCannotBeAndRatesThatAreNot) {
  struct Giant : Hand {
    Giant() {
      info_.limits.max_force_n = 5000.0;
      info_.workspace_width_m = std::numeric_limits<double>::quiet_NaN();
      info_.rate_hz = 4000.0;
    }
  };
  const auto steps = watch_device(std::make_shared<Giant>(), quick());
  EXPECT_THAT(step_of(steps, "facts").found, HasSubstr("5e+03 N"));
  EXPECT_THAT(step_of(steps, "facts").found, HasSubstr("workspace"));
  EXPECT_THAT(step_of(steps, "news").found, HasSubstr("and it says 4000"));
  EXPECT_EQ(step_of(steps, "news").result, Result::failed);
}

TEST(Conformance, SaysThatADeviceIsNotThere) {
  struct Gone : Hand {
    [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
      DeviceSample sample = Hand::read(time_s, period_s);
      sample.connected = sample.fresh = false;
      return sample;
    }
    [[nodiscard]] const DeviceAdvice* advice() const noexcept override {
      static constexpr DeviceAdvice kAdvice{"device_plug_in", true};
      return &kAdvice;
    }
  };
  const ConformanceStep step = watched<Gone>("news");
  EXPECT_EQ(step.result, Result::failed);
  EXPECT_THAT(step.found, HasSubstr("plug in its USB cable"));
}

TEST(Conformance, SaysThatADeviceIsThereAndGivesNoForceYet) {
  struct Waits : Hand {
    [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
      DeviceSample sample = Hand::read(time_s, period_s);
      sample.homed = false;
      return sample;
    }
    [[nodiscard]] const DeviceAdvice* advice() const noexcept override {
      static constexpr DeviceAdvice kAdvice{"device_not_set_up", true};
      return &kAdvice;
    }
  };
  const ConformanceStep step = watched<Waits>("news");
  EXPECT_EQ(step.result, Result::failed);
  EXPECT_THAT(step.found, HasSubstr("has not taken the settings"));
  EXPECT_THAT(step.to_a_hand, HasSubstr("no force"));
}

TEST(Conformance, ADeviceWhosePositionsMeanNothingFails) {
  struct Waits : Hand {
    [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
      DeviceSample sample = Hand::read(time_s, period_s);
      sample.homed = false;
      return sample;
    }
  };
  const ConformanceStep step = watched<Waits>("news");
  EXPECT_EQ(step.result, Result::failed);
  EXPECT_THAT(step.found, HasSubstr("homed is false"));
}

TEST(Conformance, ASlowDeviceThatSaysItsRateIsNotBlamedForIt) {
  struct Slow : Hand {
    Slow() { info_.rate_hz = 100.0; }
    [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
      DeviceSample sample = Hand::read(time_s, period_s);
      sample.fresh = time_s >= looked_s_ + 0.01;
      if (sample.fresh) looked_s_ = time_s;
      return sample;
    }
    double looked_s_ = -1.0;
  };
  const ConformanceStep step = watched<Slow>("news");
  EXPECT_EQ(step.result, Result::passed) << step.found;
}

/// Looks at the hand `kLooks` times a second, and says of each answer that it is new.
template <int kLooks>
struct Repeats : Hand {
  [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
    DeviceSample sample = Hand::read(std::floor(time_s * kLooks) / kLooks, period_s);
    sample.time_s = time_s;
    return sample;
  }
};

TEST(Conformance, FindsADeviceThatRepeatsItsPositionsWithoutSayingSo) {
  for (const ConformanceStep& step : {watched<Repeats<100>>("news"), watched<Repeats<200>>("news")}) {
    EXPECT_EQ(step.result, Result::failed) << step.found;
    EXPECT_THAT(step.found, HasSubstr("positions are those of before"));
    EXPECT_THAT(step.to_a_hand, HasSubstr("a faster device"));
  }
  struct Rests : Hand {
    [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
      DeviceSample sample = Hand::read(time_s, period_s);
      sample.position_m = {0.01, 0.02, 0.03};
      return sample;
    }
  };
  const ConformanceStep rests = watched<Rests>("news");
  EXPECT_EQ(rests.result, Result::passed);
  EXPECT_THAT(rests.found, HasSubstr("hardly moved"));
  struct Coarse : Hand {  // up to 0.1 m/s, and steps of 60 um: most of the positions of its turns are those of before
    [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
      DeviceSample sample = Hand::read(time_s, period_s);
      for (double& part : sample.position_m) part = 60e-6 * std::round(part / 60e-6);
      return sample;
    }
  };
  const ConformanceStep coarse = watched<Coarse>("news");
  EXPECT_EQ(coarse.result, Result::passed) << coarse.found << coarse.to_a_hand;
  EXPECT_THAT(coarse.found, HasSubstr("of before"));
}

TEST(Conformance, NoFaultOfADriverLeavesAForce) {
  constexpr int kFaults = static_cast<int>(Fault::repeats);
  std::vector<std::future<std::vector<ConformanceStep>>> trials;
  for (int fault = 1; fault <= kFaults; ++fault)
    trials.push_back(std::async(std::launch::async, [fault] {
      Hand hand;
      ConformanceOptions options = quick();
      options.faults = {static_cast<Fault>(fault)};
      auto steps = try_faults(hand, options);
      EXPECT_EQ(hand.forces.load(), 0) << "the device itself is told zero only";
      return steps;
    }));
  for (auto& trial : trials) {
    const auto steps = trial.get();
    ASSERT_EQ(steps.size(), 1U);
    EXPECT_EQ(steps[0].result, Result::passed) << steps[0].name << ": " << steps[0].found << ": " << steps[0].to_a_hand;
    std::printf("%s: %s\n", steps[0].name.c_str(), steps[0].found.c_str());
  }
}

}  // namespace
}  // namespace sparsha::haptics
