// Hands without force: what pads' events mean, and what their motors tell of the stone.
#include "haptics/device/gamepad/gamepad.h"

#include <gtest/gtest.h>

#include <algorithm>
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
    std::atomic<double> trigger{0.0}, stick{0.0};
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
