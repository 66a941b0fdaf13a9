#include "haptics/device/pointer/pointer_device.h"
#include "haptics/device/simulated/simulated_device.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <vector>

namespace sparsha::haptics {
namespace {

// A wall of springs at every height: z = f(x, y), force straight up. Enough of a surface to guide a hand.
struct Round {
  double first_touch_s = -1.0;
  double contact_share = 0.0;
  double deepest_m = 0.0;
  std::vector<Eigen::Vector3d> way;
};

Round run(Device& device, const std::function<double(double, double)>& surface_m, double duration_s,
          double stiffness = 800.0) {
  Round result;
  int contacts = 0;
  const int ticks = static_cast<int>(duration_s * 1000.0);
  for (int tick = 0; tick < ticks; ++tick) {
    const DeviceSample sample = device.read(tick * 0.001, 0.001);
    result.way.push_back(sample.position_m);
    const double depth = surface_m(sample.position_m.x(), sample.position_m.y()) - sample.position_m.z();
    if (depth > 0.0) {
      ++contacts;
      if (result.first_touch_s < 0.0) result.first_touch_s = tick * 0.001;
      result.deepest_m = std::max(result.deepest_m, depth);
    }
    device.write({0.0, 0.0, std::min(8.0, stiffness * std::max(0.0, depth))});
  }
  result.contact_share = static_cast<double>(contacts) / ticks;
  return result;
}

TEST(SimulatedDevice, TouchesWithinThreeSecondsAndStaysInContactOnAnySurface) {
  std::mt19937_64 random(20261121);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    // Random hills, up to half the workspace high and as steep as 60 degrees, through the device's origin.
    double a[6];
    for (double& value : a) value = unit(random);
    const auto hills = [&](double x, double y) {
      const double wave = std::sin(60.0 * a[0] * x + 60.0 * a[1] * y + a[2]) - std::sin(a[2]);
      return 0.02 * a[3] * wave + 0.5 * a[4] * x + 0.5 * a[5] * y;
    };
    const auto device = make_simulated_device(seed, 0.0);
    const Round result = run(*device, hills, 10.0);
    EXPECT_GE(result.first_touch_s, 0.05) << "seed " << seed << ": the governor arms in free space first";
    EXPECT_LE(result.first_touch_s, 3.0) << "seed " << seed;
    EXPECT_GE(result.contact_share, 0.2) << "seed " << seed;
  }
}

TEST(SimulatedDevice, KeepsContactOverPitsAndPillars) {
  const auto stairs = [](double x, double y) {
    return 0.015 * (std::floor(x / 0.012) + std::floor(y / 0.017)) * (std::abs(x) < 0.006 ? 0.0 : 1.0);
  };
  const auto device = make_simulated_device(3, 0.0);
  const Round result = run(*device, stairs, 10.0);
  EXPECT_LE(result.first_touch_s, 3.0);
  EXPECT_GE(result.contact_share, 0.2);
}

TEST(SimulatedDevice, SinksInButComesBackOutWhenNoForceIsDelivered) {
  const auto device = make_simulated_device(4, 0.0);
  const Round result = run(
      *device, [](double, double) { return 0.0; }, 12.0, 0.0);
  EXPECT_GE(result.contact_share, 0.2);
  bool came_out = false;
  bool was_in = false;
  for (const Eigen::Vector3d& place : result.way) {
    was_in = was_in || place.z() < 0.0;
    came_out = came_out || (was_in && place.z() > 0.005);
  }
  EXPECT_TRUE(came_out);
}

TEST(SimulatedDevice, GivesTheSameRoundForTheSameSeedAndAnotherForAnother) {
  const auto flat = [](double, double) { return 0.0; };
  const auto first = make_simulated_device(7, 0.0);
  const auto second = make_simulated_device(7, 0.0);
  const auto other = make_simulated_device(8, 0.0);
  const Round a = run(*first, flat, 5.0);
  const Round b = run(*second, flat, 5.0);
  const Round c = run(*other, flat, 5.0);
  EXPECT_EQ(a.way, b.way);
  EXPECT_NE(a.way, c.way);
}

TEST(SimulatedDevice, FeelsAForceOneTickLate) {
  const auto quiet = make_simulated_device(1, 0.0);
  const auto pushed = make_simulated_device(1, 0.0);
  int differs_at = -1;
  for (int tick = 0; tick < 10; ++tick) {
    const DeviceSample a = quiet->read(tick * 0.001, 0.001);
    const DeviceSample b = pushed->read(tick * 0.001, 0.001);
    if (differs_at < 0 && a.position_m != b.position_m) differs_at = tick;
    quiet->write(Eigen::Vector3d::Zero());
    pushed->write({0.0, 0.0, tick == 2 ? 8.0 : 0.0});
  }
  // Decided at tick 2, held from 3 to 4: 8 N on 0.15 kg move it by 27 um, over a step of the encoder, by tick 4.
  EXPECT_EQ(differs_at, 4);
}

TEST(SimulatedDevice, ForgetsItsForceWhenTheWatchdogZeroesIt) {
  const auto device = make_simulated_device(1, 0.0);
  static_cast<void>(device->read(0.0, 0.001));
  device->write({0.0, 0.0, 8.0});
  device->zero();
  const double before = device->read(0.001, 0.001).position_m.z();
  device->write(Eigen::Vector3d::Zero());
  for (int tick = 2; tick < 20; ++tick) {
    EXPECT_LE(device->read(tick * 0.001, 0.001).position_m.z(), before + 1e-12);
    device->write(Eigen::Vector3d::Zero());
  }
}

TEST(SimulatedDevice, FinishesAfterItsDuration) {
  const auto device = make_simulated_device(1, 0.5);
  EXPECT_FALSE(device->read(0.499, 0.001).finished);
  EXPECT_TRUE(device->read(0.5, 0.001).finished);
}

TEST(PointerDevice, HasNoHandUntilThePointerHasBeenSomewhere) {
  const auto pointer = std::make_shared<Seqlock<PointerSample>>();
  const auto device = make_pointer_device(pointer);
  EXPECT_FALSE(device->read(0.0, 0.001).fresh);
  pointer->publish({{0.01, -0.02, 0.03}, 2, 1});
  const DeviceSample sample = device->read(0.001, 0.001);
  EXPECT_TRUE(sample.fresh);
  EXPECT_EQ(sample.position_m, Eigen::Vector3d(0.01, -0.02, 0.03));
  EXPECT_EQ(sample.buttons, 2U);
}

TEST(PointerDevice, GoesSmoothlyToWhereThePointerJumps) {
  const auto pointer = std::make_shared<Seqlock<PointerSample>>();
  const auto device = make_pointer_device(pointer);
  pointer->publish({{0.0, 0.0, 0.01}, 0, 1});
  static_cast<void>(device->read(0.0, 0.001));
  pointer->publish({{0.02, 0.0, 0.01}, 0, 2});
  double last = 0.0;
  double longest = 0.0;
  for (int tick = 1; tick <= 200; ++tick) {
    const double x = device->read(tick * 0.001, 0.001).position_m.x();
    EXPECT_GE(x, last - 1e-15) << "a critically damped filter does not swing back";
    longest = std::max(longest, x - last);
    last = x;
  }
  EXPECT_NEAR(last, 0.02, 0.02 * (1.0 + 200.0 / 12.0) * std::exp(-200.0 / 12.0) * 2.0);
  EXPECT_LT(longest, 0.02 * 0.001 / 0.012 * std::exp(-1.0) * 1.01);  // the filter's greatest speed, at t = T
}

TEST(PointerDevice, ForgetsAPlaceThatIsNoNumber) {
  const auto pointer = std::make_shared<Seqlock<PointerSample>>();
  const auto device = make_pointer_device(pointer);
  pointer->publish({{0.01, 0.0, 0.03}, 0, 1});
  static_cast<void>(device->read(0.0, 0.001));
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    pointer->publish({{0.01, bad, 0.03}, 0, 2});
    EXPECT_FALSE(device->read(0.001, 0.001).position_m.allFinite()) << "the servo must know";
    pointer->publish({{0.01, 0.0, 0.03}, 0, 3});
    EXPECT_EQ(device->read(0.002, 0.001).position_m, Eigen::Vector3d(0.01, 0.0, 0.03));
  }
}

TEST(SimulatedDevice, SurvivesForcesThatAreNone) {
  const auto device = make_simulated_device(1, 0.0);
  double time_s = 0.0;
  for (const double bad : {std::nan(""), HUGE_VAL, 1e300, -1e9}) {
    device->write({0.0, 0.0, bad});
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(device->read(time_s += 0.001, 0.001).position_m.allFinite());
  }
}

TEST(SimulatedDevice, VisitsTheStopsOfItsTourInTheirOrderAndGoesOnExploring) {
  const auto stone = [](double x, double y) { return 0.001 * std::sin(200.0 * x) * std::cos(150.0 * y); };
  const Eigen::Vector2d bell(0.01, 0.02);
  const Eigen::Vector2d letter(-0.03, -0.02);
  const Eigen::Vector2d left(-0.03, 0.01);
  const Eigen::Vector2d right(0.03, 0.01);
  const auto device = make_simulated_device(5, 0.0,
                                            {{TourStop::Kind::strike, bell, bell, 0},
                                             {TourStop::Kind::strike, letter, letter, 0},
                                             {TourStop::Kind::stroke, left, right, 2}});
  struct Touch {
    Eigen::Vector2d first, last;
    int ticks = 0;
    int button_ticks = 0;
  };
  std::vector<Touch> touches;
  bool was_in = false;
  for (int tick = 0; tick < 12000; ++tick) {
    const DeviceSample sample = device->read(tick * 0.001, 0.001);
    const Eigen::Vector2d place = sample.position_m.head<2>();
    const double depth = stone(place.x(), place.y()) - sample.position_m.z();
    if (depth > 0.0) {
      if (!was_in) touches.push_back({place, place});
      touches.back().last = place;
      ++touches.back().ticks;
      touches.back().button_ticks += sample.buttons == 2 ? 1 : 0;
    } else {
      EXPECT_EQ(sample.buttons, 0U);
    }
    was_in = depth > 0.0;
    device->write({0.0, 0.0, std::min(8.0, 800.0 * std::max(0.0, depth))});
  }
  ASSERT_GE(touches.size(), 4U) << "three stops, and rounds by chance after them";
  constexpr double kNear_m = 0.003;  // a hand that moves is not exact
  EXPECT_LT((touches[0].first - bell).norm(), kNear_m);
  EXPECT_LT((touches[1].first - letter).norm(), kNear_m);
  EXPECT_LT(touches[0].ticks, 150) << "a strike is short";
  EXPECT_LT(touches[1].ticks, 150);
  EXPECT_LT((touches[2].first - left).norm(), kNear_m);
  EXPECT_LT((touches[2].last - right).norm(), 2.0 * kNear_m);
  EXPECT_GT(touches[2].ticks, 1500);
  EXPECT_NEAR(touches[2].button_ticks, 100, 2) << "a click in the middle of the stroke";
}

}  // namespace
}  // namespace sparsha::haptics
