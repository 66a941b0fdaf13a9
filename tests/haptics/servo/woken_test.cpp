// Which time a device that the servo's clock drives is told.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "haptics/servo/servo.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

constexpr std::int64_t kPeriod_ns = 1'000'000;

/// A hand in the air on a machine that wakes the servo late by up to 0.9 ms.
class SleepyDevice final : public Device {
 public:
  explicit SleepyDevice(bool planned_time) {
    info_.planned_time = planned_time;
    told_s.reserve(kTicks);
    woke_ns.reserve(kTicks);
  }
  [[nodiscard]] ServoClock clock() {
    return {[this] { return time_ns_; }, [this](std::int64_t until_ns) { wake_late(until_ns); }};
  }
  [[nodiscard]] DeviceInfo info() const override { return info_; }
  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    told_s.push_back(time_s);
    woke_ns.push_back(time_ns_);
    DeviceSample sample = sample_at({0.0, 0.0, 0.02}, time_s);
    sample.finished = told_s.size() >= kTicks;
    return sample;
  }
  void write(const Eigen::Vector3d&) noexcept override {}
  void zero() noexcept override {}

  static constexpr std::size_t kTicks = 200;
  std::vector<double> told_s;
  std::vector<std::int64_t> woke_ns;

 private:
  void wake_late(std::int64_t until_ns) noexcept {
    // From before the planned time, whatever the servo allows itself, to 0.9 ms after it.
    const auto late = static_cast<std::int64_t>(told_s.size() * 37 % 10);
    if (told_s.size() < kTicks) time_ns_ = std::max(time_ns_, until_ns + kPeriod_ns / 20 + late * kPeriod_ns / 11);
  }
  DeviceInfo info_;
  std::int64_t time_ns_ = 1'000'000'000;
};

std::vector<double> told_in_a_run(SleepyDevice& device) {
  const ClockedRun run(device);
  EXPECT_TRUE(run.finished);
  return device.told_s;
}

TEST(Woken, ADeviceOnTheServosClockIsToldWhenTheServoReallyWoke) {
  SleepyDevice device(false);
  const std::vector<double> told_s = told_in_a_run(device);
  for (std::size_t k = 1; k < SleepyDevice::kTicks; ++k)
    EXPECT_NEAR(told_s[k] - told_s[k - 1], 1e-9 * static_cast<double>(device.woke_ns[k] - device.woke_ns[k - 1]), 1e-9)
        << k;
}

TEST(Woken, AComputedHandIsToldThePlanSoThatEveryRunIsTheSame) {
  SleepyDevice device(true);
  const std::vector<double> told_s = told_in_a_run(device);
  for (std::size_t k = 0; k < SleepyDevice::kTicks; ++k) EXPECT_NEAR(std::remainder(told_s[k], 0.001), 0.0, 1e-12) << k;
}

}  // namespace
}  // namespace sparsha::haptics
