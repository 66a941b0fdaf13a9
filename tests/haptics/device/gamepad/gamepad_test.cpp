// Hands without force: what pads' events mean, and what their motors tell of the stone.
#include "haptics/device/gamepad/gamepad.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "haptics/device/gamepad/vibration.h"
#include "haptics/servo/servo.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

using system::PadKind;
using system::PadReader;
using system::PadState;

// Of linux/input-event-codes.h.
constexpr int kKey = 1, kAbsolute = 3, kX = 0, kY = 1, kRz = 5, kPressure = 24, kSouth = 0x130, kNorth = 0x133,
              kPen = 0x140;

TEST(PadReader, AGamepadsEventsAreSticksTriggersAndButtons) {
  PadReader reader(PadKind::gamepad);
  reader.set_range(kX, {-32768, 32767});
  reader.set_range(kY, {-32768, 32767});
  reader.set_range(kRz, {0, 255});
  reader.take(kAbsolute, kX, 32767);
  reader.take(kAbsolute, kY, -32768);  // up, as Linux has it
  reader.take(kAbsolute, kRz, 51);
  reader.take(kKey, kSouth, 1);
  reader.take(kKey, kNorth, 1);
  reader.take(kKey, kSouth, 0);
  EXPECT_EQ(reader.state().left_x, 1.0);
  EXPECT_EQ(reader.state().left_y, 1.0);
  EXPECT_NEAR(reader.state().right_trigger, 0.2, 1e-12);
  EXPECT_EQ(reader.state().buttons, 8U);
  reader.take(kAbsolute, kX, 1'000'000);
  EXPECT_EQ(reader.state().left_x, 1.0) << "never beyond its range";
  for (const int code : {-1, 63, 64, 1 << 20}) reader.take(kAbsolute, code, 5);
  reader.take(77, kX, 0);
  EXPECT_EQ(reader.state().left_x, 1.0);
}

TEST(PadReader, AStickAboutItsMiddleIsInItAndTheDirectionalPadHasThreePlaces) {
  PadReader reader(PadKind::gamepad);
  reader.set_range(kX, {0, 255, 15, 0});
  reader.set_range(kY, {0, 255, 15, 0});
  for (const int value : {113, 127, 128, 142}) {
    reader.take(kAbsolute, kX, value);
    EXPECT_EQ(reader.state().left_x, 0.0) << value << " is within the 15 that the kernel tells";
  }
  reader.take(kAbsolute, kX, 143);
  EXPECT_NEAR(reader.state().left_x, 31.0 / 255.0, 1e-12);
  reader.take(kAbsolute, kY, 0);
  EXPECT_EQ(reader.state().left_y, 1.0);
  constexpr int kHatX = 16, kHatY = 17;
  reader.take(kAbsolute, kHatX, 1);
  reader.take(kAbsolute, kHatY, -1);
  EXPECT_EQ(reader.state().hat_x, 1.0);
  EXPECT_EQ(reader.state().hat_y, 1.0) << "up is up";
  reader.take(kAbsolute, kHatX, 0);
  EXPECT_EQ(reader.state().hat_x, 0.0);
}

TEST(PadReader, WhereThereIsAPedalTheRightStickIsNoTrigger) {
  constexpr int kGas = 9;
  PadReader reader(PadKind::gamepad);
  reader.set_range(kRz, {0, 65535});
  reader.set_range(kGas, {0, 1023});
  reader.take(kAbsolute, kRz, 32768);
  EXPECT_EQ(reader.state().right_trigger, 0.0);
  reader.take(kAbsolute, kGas, 1023);
  EXPECT_EQ(reader.state().right_trigger, 1.0);
}

TEST(PadReader, APensTiltIsAnAngleInUnitsOfTheKernelOrInDegrees) {
  constexpr int kTiltX = 26, kTiltY = 27;
  PadReader reader(PadKind::tablet);
  reader.take(kAbsolute, kTiltX, 30);
  EXPECT_FALSE(reader.state().has_tilt) << "a tablet that has no such axis";
  reader.set_range(kTiltX, {-64, 63, 0, 57});
  reader.set_range(kTiltY, {-60, 60, 0, 0});
  reader.take(kAbsolute, kTiltX, 57);
  EXPECT_TRUE(reader.state().has_tilt);
  EXPECT_DOUBLE_EQ(reader.state().tilt_x_rad, 1.0);
  reader.take(kAbsolute, kTiltY, 30);
  EXPECT_NEAR(reader.state().tilt_y_rad, -std::acos(-1.0) / 6.0, 1e-12) << "the kernel's y is down";
  reader.take(kAbsolute, kTiltY, 1'000'000);
  EXPECT_NEAR(reader.state().tilt_y_rad, -std::acos(-1.0) / 3.0, 1e-12);
}

TEST(PadReader, AxesWithoutARangeAreNothing) {
  PadReader reader(PadKind::tablet);
  reader.take(kAbsolute, kPressure, 500);
  EXPECT_EQ(reader.state().pressure, 0.0);
}

TEST(PadReader, APenThatLeavesPressesNoMore) {
  PadReader reader(PadKind::tablet);
  reader.set_range(kX, {0, 100});
  reader.set_range(kY, {0, 100});
  reader.set_range(kPressure, {0, 1000});
  reader.take(kKey, kPen, 1);
  reader.take(kAbsolute, kX, 25);
  reader.take(kAbsolute, kY, 25);
  reader.take(kAbsolute, kPressure, 500);
  EXPECT_TRUE(reader.state().pen_near);
  EXPECT_EQ(reader.state().pen_x, 0.25);
  EXPECT_EQ(reader.state().pen_y, 0.75) << "up is up";
  EXPECT_EQ(reader.state().pressure, 0.5);
  reader.take(kKey, kPen, 0);
  EXPECT_EQ(reader.state().pressure, 0.0);
}

TEST(Vibration, MeetingTheStoneShakesTheStrongMotorAndRoughnessTheWeak) {
  Vibration vibration;
  const auto run = [&](int ms, const auto& force) {
    double strong = 0.0, weak = 0.0;
    for (int tick = 0; tick < ms; ++tick) {
      vibration.feel({0.0, 0.0, force(1e-3 * tick)}, 1e-3);
      strong = std::max(strong, vibration.strong());
      weak = std::max(weak, vibration.weak());
    }
    return std::pair(strong, weak);
  };
  EXPECT_EQ(run(100, [](double) { return 0.0; }), std::pair(0.0, 0.0));
  EXPECT_GT(run(50, [](double) { return 1.5; }).first, 0.9) << "it is met";
  static_cast<void>(run(300, [](double) { return 1.5; }));
  const auto [rest_strong, rest_weak] = run(100, [](double) { return 1.5; });
  EXPECT_LT(std::max(rest_strong, rest_weak), 0.02) << "a steady force shakes nothing";
  const auto [smooth, smooth_weak] = run(500, [](double t) { return 1.5 + 0.3 * std::sin(2 * t); });
  const auto [rough, rough_weak] = run(500, [](double t) { return 1.5 + 0.05 * std::sin(500 * t); });
  EXPECT_GT(rough_weak, 5.0 * smooth_weak);
  EXPECT_LT(std::max(smooth, rough), 0.2) << "neither is a blow";
  vibration.stop();
  EXPECT_EQ(vibration.weak(), 0.0);
}

/// A pad that a test holds.
class HeldPad final : public system::Pad {
 public:
  struct Held {
    std::atomic<double> trigger{0.0}, stick{0.0}, tilt_x_rad{0.0}, tilt_y_rad{0.0};
    std::atomic<bool> connected{true};
    std::atomic<double> strongest{0.0}, last{0.0};
  };
  explicit HeldPad(std::shared_ptr<Held> held) : held_(std::move(held)) {}
  [[nodiscard]] std::string name() const override { return "held"; }
  void read(PadState& state) noexcept override {
    state.right_trigger = held_->trigger.load();
    state.left_x = held_->stick.load();
    state.pen_near = true;
    state.pen_x = 0.75;
    state.pen_y = 0.5;
    state.pressure = held_->trigger.load();
    state.has_tilt = true;
    state.tilt_x_rad = held_->tilt_x_rad.load();
    state.tilt_y_rad = held_->tilt_y_rad.load();
    state.connected = held_->connected.load();
  }
  bool rumble(double strong, double weak, double) noexcept override {
    held_->strongest.store(std::max(held_->strongest.load(), std::max(strong, weak)));
    held_->last.store(std::max(strong, weak));
    return true;
  }

 private:
  std::shared_ptr<Held> held_;
};

TEST(Gamepad, TheTriggerPressesTheStickMovesAndTheMotorsTell) {
  const auto held = std::make_shared<HeldPad::Held>();
  const auto device = make_pad_device(std::make_unique<HeldPad>(held), PadKind::gamepad);
  Seqlock<State> state;
  Servo servo(*device, patient(), window_on(sparsha::test::flat_scene()), state, {}, nullptr);
  servo.start();
  ASSERT_TRUE(eventually([&] { return (state.read().flags & kFlagArmed) != 0; }));
  EXPECT_EQ(held->strongest.load(), 0.0) << "in the air nothing shakes";
  held->trigger.store(0.8);
  ASSERT_TRUE(eventually([&] { return state.read().commanded_force_n[2] > 0.5; }));
  ASSERT_TRUE(eventually([&] { return held->strongest.load() > 0.2; }));
  ASSERT_TRUE(eventually([&] { return held->last.load() < 0.05; })) << "a hand that rests is still";
  const double x_m = state.read().device_m[0];
  held->stick.store(1.0);
  ASSERT_TRUE(eventually([&] { return state.read().device_m[0] > x_m + 0.01; }));
  held->connected.store(false);
  ASSERT_TRUE(eventually([&] { return servo.unplugged(); }));
  EXPECT_EQ(state.read().commanded_force_n[2], 0.0);
  servo.stop();
}

TEST(Gamepad, OneThatIsPulledOutInContactIsZeroForceAndAnotherGoesOnFromTheAir) {
  const auto first = std::make_shared<HeldPad::Held>(), second = std::make_shared<HeldPad::Held>();
  std::atomic<bool> there{false};
  const auto device = make_pad_device(std::make_unique<HeldPad>(first), PadKind::gamepad,
                                      [&] { return there.load() ? std::make_unique<HeldPad>(second) : nullptr; });
  Seqlock<State> state;
  Servo servo(*device, patient(), window_on(sparsha::test::flat_scene()), state, {}, nullptr);
  servo.start();
  ASSERT_TRUE(eventually([&] { return (state.read().flags & kFlagArmed) != 0; }));
  EXPECT_EQ(device->advice(), nullptr);
  first->trigger.store(0.8);
  ASSERT_TRUE(eventually([&] { return state.read().commanded_force_n[2] > 0.5; }));
  second->trigger.store(0.8);  // held down already when it is plugged in
  first->connected.store(false);
  ASSERT_TRUE(eventually([&] { return servo.unplugged(); }));
  EXPECT_EQ(state.read().commanded_force_n[2], 0.0);
  ASSERT_TRUE(eventually([&] { return device->advice() != nullptr; }));
  EXPECT_STREQ(device->advice()->phrase, "device_pad");
  there.store(true);
  ASSERT_TRUE(eventually([&] { return !servo.unplugged(); }));
  second->trigger.store(0.0);
  ASSERT_TRUE(eventually([&] { return (state.read().flags & kFlagArmed) != 0; }));
  second->trigger.store(0.8);
  ASSERT_TRUE(eventually([&] { return state.read().commanded_force_n[2] > 0.5; }));
  EXPECT_EQ(device->advice(), nullptr);
  EXPECT_TRUE(eventually([&] { return second->strongest.load() > 0.2; })) << "the motors of the new one";
  servo.stop();
}

TEST(Gamepad, BeginsWithoutOneWhereOneMayCome) {
  const auto held = std::make_shared<HeldPad::Held>();
  const auto device = make_pad_device(nullptr, PadKind::gamepad, [&] { return std::make_unique<HeldPad>(held); });
  int tick = 0;
  EXPECT_TRUE(eventually([&] { return device->read(1e-3 * ++tick, 1e-3).connected; }));
}

TEST(Tablet, ThePensTiltIsTheOrientationOfTheStylus) {
  const auto held = std::make_shared<HeldPad::Held>();
  const auto device = make_pad_device(std::make_unique<HeldPad>(held), PadKind::tablet);
  for (const auto& [x_rad, y_rad] : {std::pair(0.0, 0.0), std::pair(0.5, 0.0), std::pair(-0.3, 0.7)}) {
    held->tilt_x_rad.store(x_rad);
    held->tilt_y_rad.store(y_rad);
    const auto q = device->read(0.0, 1e-3).orientation;
    // Where the quaternion takes the stylus's axis, written out.
    const double x = 2 * (q[1] * q[3] + q[0] * q[2]), y = 2 * (q[2] * q[3] - q[0] * q[1]);
    const double z = 1 - 2 * (q[1] * q[1] + q[2] * q[2]);
    EXPECT_NEAR(x / z, std::tan(x_rad), 1e-9);
    EXPECT_NEAR(y / z, std::tan(y_rad), 1e-9);
    EXPECT_GT(z, 0.0);
  }
  const auto pad = std::make_shared<HeldPad::Held>();
  EXPECT_EQ(make_pad_device(std::make_unique<HeldPad>(pad), PadKind::gamepad)->read(0.0, 1e-3).orientation,
            (std::array<double, 4>{}))
      << "a gamepad has none";
}

TEST(Tablet, ThePenIsTheHandAndItsPressureTheDepth) {
  const auto held = std::make_shared<HeldPad::Held>();
  const auto device = make_pad_device(std::make_unique<HeldPad>(held), PadKind::tablet);
  DeviceSample sample;
  for (int tick = 0; tick < 1000; ++tick) sample = device->read(1e-3 * tick, 1e-3);
  EXPECT_NEAR(sample.position_m.x(), 0.024, 1e-3);
  EXPECT_GT(sample.position_m.z(), 0.01);
  held->trigger.store(1.0);
  for (int tick = 1000; tick < 2000; ++tick) sample = device->read(1e-3 * tick, 1e-3);
  EXPECT_LT(sample.position_m.z(), -0.015);
}

}  // namespace
}  // namespace sparsha::haptics
