// Repeats that a device calls new are told from hands that rest, are slow or turn, whatever the encoder's step.
#include "haptics/governor/look_meter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;
using Motion = std::function<Vector3d(double)>;

struct Device {
  double look_hz = 1000.0;
  double jitter = 0.0;  ///< of the time between two looks
  double step_m = 10e-6;
  double loop_jitter_s = 0.0;
};

struct Seen {
  std::uint64_t repeats = 0;
  std::uint64_t ticks = 0;
  double found_s = -1.0;   ///< when the first repeat was told as one
  double pace_s = 0.0;     ///< at the end
  double longest_s = 0.0;  ///< between two samples that were news, from a tenth of a second after the first on
};

/// A loop of a kilohertz for some seconds.
Seen watch(const Device& device, const Motion& motion, double seconds, std::uint32_t seed = 1) {
  LookMeter meter;
  std::mt19937 random(seed);
  const auto chance = [&] { return std::uniform_real_distribution<double>(0.0, 1.0)(random); };
  Seen seen;
  std::uint64_t looks = 0;
  double next_look_s = 0.0;
  double last_s = -0.001;
  double news_s = 0.0;
  Vector3d place = Vector3d::Zero();
  for (double tick = 0.0; tick * 0.001 < seconds; ++tick) {
    const double t = tick * 0.001 + device.loop_jitter_s * chance();
    while (next_look_s <= t) {
      const Vector3d now = motion(device.look_hz >= 1000.0 ? t : next_look_s) / device.step_m;
      place = device.step_m * Vector3d(std::round(now.x()), std::round(now.y()), std::round(now.z()));
      next_look_s = (static_cast<double>(++looks) + device.jitter * (2.0 * chance() - 1.0)) / device.look_hz;
    }
    ++seen.ticks;
    if (meter.repeats(place, t - last_s)) {
      ++seen.repeats;
      if (seen.found_s < 0.0) seen.found_s = t;
    } else {
      if (seen.found_s >= 0.0 && t > seen.found_s + 0.1) seen.longest_s = std::max(seen.longest_s, t - news_s);
      news_s = t;
    }
    last_s = t;
  }
  seen.pace_s = meter.pace_s();
  return seen;
}

Motion circling(double speed_m_per_s, double radius_m) {
  return [=](double t) -> Vector3d {
    const double angle = speed_m_per_s / radius_m * t;
    return {radius_m * std::cos(angle), radius_m * std::sin(angle), 0.3 * radius_m * std::sin(0.7 * angle)};
  };
}

Motion swinging(double size_m, double hz) {
  return [=](double t) -> Vector3d {
    return {0.0, 0.1 * t * size_m, size_m * std::sin(2.0 * std::numbers::pi * hz * t)};
  };
}

/// Goes and rests, a few times a second.
Motion stopping(double speed_m_per_s) {
  return [=](double t) -> Vector3d {
    const double whole = std::floor(3.0 * t);
    return {speed_m_per_s / 3.0 * (whole + std::min(1.0, 4.0 * (3.0 * t - whole))), 0.0, 0.0};
  };
}

constexpr double kSteps_m[] = {1e-6, 5e-6, 10e-6, 20e-6, 40e-6, 60e-6};
constexpr double kSpeeds_m_per_s[] = {0.0003, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3};

}  // namespace

TEST(LookMeter, NoHandOfADeviceThatLooksEachTickIsTakenForARepeat) {
  for (const double step_m : kSteps_m)
    for (const double loop_jitter_s : {0.0, 0.0002, 0.0009}) {
      const Device device{.step_m = step_m, .loop_jitter_s = loop_jitter_s};
      for (const double speed : kSpeeds_m_per_s) {
        EXPECT_EQ(watch(device, circling(speed, 0.02), 3.0).repeats, 0U) << step_m << ", " << speed;
        EXPECT_EQ(watch(device, stopping(speed), 3.0).repeats, 0U) << step_m << ", " << speed << ", stops";
      }
      for (const double hz : {2.0, 9.0, 30.0, 80.0})
        for (const double size_m : {20e-6, 100e-6, 0.0005, 0.002})
          EXPECT_EQ(watch(device, swinging(size_m, hz), 2.0).repeats, 0U) << step_m << ", " << hz << ", " << size_m;
    }
}

TEST(LookMeter, ADeviceThatRepeatsIsFoundWhileTheHandGoesToTheStone) {
  for (const double look_hz : {100.0, 125.0, 200.0, 250.0, 333.0, 400.0, 500.0})
    for (const double jitter : {0.0, 0.2, 0.45})
      for (const double step_m : kSteps_m)
        for (const double speed : {0.1, 0.3}) {
          if (speed / look_hz < 6.0 * step_m) continue;  // too few steps at a look to tell
          const Seen seen = watch({look_hz, jitter, step_m}, circling(speed, 0.02), 2.0);
          EXPECT_GE(seen.found_s, 0.0) << look_hz << " Hz, " << jitter << ", " << step_m << ", " << speed;
          EXPECT_LE(seen.found_s, 24.0 / look_hz) << look_hz << " Hz, " << jitter << ", " << step_m << ", " << speed;
          EXPECT_GE(seen.pace_s, 0.9 / look_hz) << look_hz << " Hz, " << jitter << ", " << step_m;
          EXPECT_LE(seen.pace_s, (1.01 + 2.0 * jitter) / look_hz + 0.001) << look_hz << " Hz, " << jitter;
        }
}

TEST(LookMeter, AHandThatRestsIsSeenAtThePaceOfTheLooks) {
  for (const double look_hz : {100.0, 200.0, 500.0}) {
    const Motion rests = [](double t) -> Vector3d { return circling(0.1, 0.02)(std::min(t, 1.0)); };
    const Seen seen = watch({look_hz, 0.0, 10e-6}, rests, 6.0);
    EXPECT_GT(seen.repeats, 0U);
    EXPECT_LE(seen.longest_s, 1.5 / look_hz + 0.001) << look_hz;
    EXPECT_GT(seen.pace_s, 0.0) << "what was found is kept";
  }
}

TEST(LookMeter, AHandThatSticksAndSlipsIsNoSlowerDevice) {
  // Slips of 0.6 mm, each 60 ms, at the speed of a relaxed grip.
  const Motion slipping = [](double t) -> Vector3d {
    const double whole = std::floor(t / 0.06);
    return {0.0006 * (whole + std::min(1.0, (t / 0.06 - whole) * 60.0 / 12.0)), 0.0, 0.0};
  };
  const Seen seen = watch({.look_hz = 200.0, .step_m = 20e-6}, slipping, 4.0);
  EXPECT_GT(seen.repeats, 0U);
  EXPECT_LE(seen.pace_s, 0.0125);
}

TEST(LookMeter, AHandThatMovesEachTickEndsIt) {
  LookMeter meter;
  Vector3d place = Vector3d::Zero();
  for (int tick = 0; tick < 500; ++tick) {
    if (tick % 5 == 0) place.x() += 0.0005;
    static_cast<void>(meter.repeats(place, 0.001));
  }
  EXPECT_NEAR(meter.pace_s(), 0.005, 1e-9);
  for (int tick = 0; tick < 40; ++tick) {
    place.x() += 0.0003;
    static_cast<void>(meter.repeats(place, 0.001));
  }
  EXPECT_EQ(meter.pace_s(), 0.0);
}

}  // namespace sparsha::haptics
