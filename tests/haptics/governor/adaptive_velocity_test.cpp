// How noisy and how late is the velocity of a hand behind an encoder? Truth is the motion's own derivative.
#include "haptics/governor/adaptive_velocity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

namespace sparsha::haptics {
namespace {

constexpr double kPi = std::numbers::pi;

struct Motion {
  std::function<double(double)> place_m;
  std::function<double(double)> speed_m_per_s;
};
Motion steady(double speed) {
  return {[=](double t) { return speed * t; }, [=](double) { return speed; }};
}
Motion swing(double amplitude_m, double hertz) {
  return {[=](double t) { return amplitude_m * std::sin(2.0 * kPi * hertz * t); },
          [=](double t) { return amplitude_m * 2.0 * kPi * hertz * std::cos(2.0 * kPi * hertz * t); }};
}

struct Course {
  std::vector<double> found, low_passed, differences, truth;  // m/s, at 1 kHz
};
/// Two seconds of a motion read with steps of `step_m`; beside it a low-pass of 6 ms and plain differences.
Course follow(const Motion& motion, double step_m, double period_s = 0.001, double jitter_s = 0.0) {
  AdaptiveVelocity velocity;
  Course course;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> late(0.0, jitter_s);
  double last_s = 0.0;
  double last_m = 0.0;
  double low_passed = 0.0;
  for (int k = 0; k < static_cast<int>(2.0 / period_s); ++k) {
    const double t = k * period_s + (jitter_s > 0.0 ? late(random) : 0.0);
    const double read_m = step_m * std::round((motion.place_m(t) + 0.3 * step_m) / step_m);
    velocity.add({0.0, read_m, -read_m}, k == 0 ? 0.0 : t - last_s);
    const double difference = k == 0 ? 0.0 : (read_m - last_m) / (t - last_s);
    low_passed += (difference - low_passed) * std::min(1.0, (t - last_s) / 0.006);
    last_s = t;
    last_m = read_m;
    const Eigen::Vector3d found = velocity.velocity(step_m);
    EXPECT_EQ(found.x(), 0.0);
    EXPECT_NEAR(found.z(), -found.y(), 1e-12);
    if (t < 0.1) continue;
    course.found.push_back(found.y());
    course.low_passed.push_back(low_passed);
    course.differences.push_back(difference);
    course.truth.push_back(motion.speed_m_per_s(t));
  }
  return course;
}

double rms_error(const std::vector<double>& found, const std::vector<double>& truth, std::size_t late = 0) {
  double sum = 0.0;
  for (std::size_t k = late; k < found.size(); ++k) sum += std::pow(found[k] - truth[k - late], 2);
  return std::sqrt(sum / static_cast<double>(found.size() - late));
}
std::size_t lag(const std::vector<double>& found, const std::vector<double>& truth) {
  std::size_t best = 0;
  for (std::size_t late = 1; late < 30; ++late)
    if (rms_error(found, truth, late) < rms_error(found, truth, best)) best = late;
  return best;
}

TEST(AdaptiveVelocity, ASlowHandIsSeenWithAQuarterOfTheNoiseOfALowPass) {
  for (const double step_m : {5e-6, 20e-6, 50e-6})
    for (const double steps_per_s : {103.0, 211.0}) {
      const Course course = follow(steady(steps_per_s * step_m), step_m);
      const double noise = rms_error(course.found, course.truth);
      EXPECT_LT(noise, 0.25 * rms_error(course.low_passed, course.truth)) << step_m << ' ' << steps_per_s;
    }
}

TEST(AdaptiveVelocity, AHandOfLessThanAStepPerWindowIsNeverSeenFasterThanOneStepMakesItSeem) {
  // One step within the window, at the worst place: a slope of 1.5 steps per window.
  constexpr double kStep_m = 20e-6;
  for (const double steps_per_s : {0.0, 5.0, 17.0, 37.0}) {
    const Course course = follow(steady(steps_per_s * kStep_m), kStep_m);
    for (const double found : course.found) EXPECT_LE(std::abs(found), 1.6 * kStep_m / AdaptiveVelocity::kLongest_s);
    EXPECT_LT(rms_error(course.found, course.truth), 0.8 * rms_error(course.low_passed, course.truth) + 1e-12);
  }
}

TEST(AdaptiveVelocity, AFastHandIsSeenWithTwoFifthsOfTheLagOfALowPass) {
  for (const double hertz : {3.0, 5.0, 8.0, 15.0}) {
    const double amplitude_m = 0.15 / (2.0 * kPi * hertz);  // 0.15 m/s at most
    const Course course = follow(swing(amplitude_m, hertz), 20e-6);
    EXPECT_LE(lag(course.found, course.truth), 3U) << hertz;
    EXPECT_GE(lag(course.low_passed, course.truth), 5U) << hertz;
    EXPECT_LT(rms_error(course.found, course.truth), 0.6 * rms_error(course.low_passed, course.truth)) << hertz;
  }
}

TEST(AdaptiveVelocity, LateTicksAndEveryRateGiveTheSameSpeed) {
  for (const double period_s : {0.003, 0.001, 0.00025, 0.0001}) {
    const Course course = follow(steady(0.05), 20e-6, period_s, 0.9 * period_s);
    EXPECT_LT(rms_error(course.found, course.truth), 0.001) << period_s;
  }
}

TEST(AdaptiveVelocity, AStepJustAfterALateTickIsNoFastHand) {
  constexpr double kStep_m = 60e-6;  // of which 50 micrometres are known
  for (const double soon_s : {0.00002, 0.0001, 0.00023}) {
    AdaptiveVelocity velocity;
    for (int k = 0; k < 50; ++k) velocity.add(Eigen::Vector3d::Zero(), k == 0 ? 0.0 : 0.001);
    velocity.add(Eigen::Vector3d::Zero(), 0.003);
    velocity.add({0.0, kStep_m, 0.0}, soon_s);
    EXPECT_LT(velocity.velocity(50e-6).norm(), kStep_m / 0.003) << soon_s;
  }
}

TEST(AdaptiveVelocity, AHandThatStopsIsSeenToHaveStoppedWithinTwoTicks) {
  AdaptiveVelocity velocity;
  for (int k = 0; k < 100; ++k) velocity.add({0.0, 0.0, 0.2e-3 * std::min(k, 50)}, k == 0 ? 0.0 : 0.001);
  EXPECT_LT(velocity.velocity(20e-6).norm(), 1e-12);
  velocity.add({0.0, 0.0, 0.2e-3 * 50}, 0.001);
  AdaptiveVelocity stopping;
  for (int k = 0; k <= 52; ++k) stopping.add({0.0, 0.0, 0.2e-3 * std::min(k, 50)}, k == 0 ? 0.0 : 0.001);
  EXPECT_LT(stopping.velocity(20e-6).norm(), 0.01) << "of 0.2 m/s";
}

TEST(AdaptiveVelocity, ABreakInTheSamplesForgetsTheWayBefore) {
  AdaptiveVelocity velocity;
  for (int k = 0; k < 50; ++k) velocity.add({1e-3 * k, 0.0, 0.0}, k == 0 ? 0.0 : 0.001);
  EXPECT_NEAR(velocity.velocity(1e-6).x(), 1.0, 1e-9);
  velocity.add({7.0, 0.0, 0.0}, 0.0);
  EXPECT_EQ(velocity.velocity(1e-6), Eigen::Vector3d::Zero());
  velocity.reset();
  velocity.add({8.0, 0.0, 0.0}, 0.001);
  EXPECT_EQ(velocity.velocity(1e-6), Eigen::Vector3d::Zero());
  velocity.add({8.001, 0.0, 0.0}, 0.001);
  EXPECT_NEAR(velocity.velocity(1e-6).x(), 1.0, 1e-9);
}

}  // namespace
}  // namespace sparsha::haptics
