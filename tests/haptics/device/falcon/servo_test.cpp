// The Falcon under the servo's own tick: a hand with mass presses a wall through kinematics, encoders and motors.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <thread>

#include "emulator/codec.h"
#include "emulator/geometry.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/link.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/servo/servo.h"
#include "tests/support/allocations.h"
#include "tests/support/emulated_falcon.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace {

using namespace sparsha::haptics;
using namespace sparsha::haptics::falcon;
using namespace sparsha::test;
namespace emulator = sparsha::emulator;
using Eigen::Vector3d;

/// A person's hand on the grip: 0.15 kg held by 300 N/m and 2 N s/m at a place that moves. Falcon frame.
class Grasp {
 public:
  explicit Grasp(std::function<Vector3d(double)> wanted) : wanted_(std::move(wanted)), position_(wanted_(0.0)) {}
  Vector3d operator()(double time_s, const Vector3d& force_n) {
    constexpr double kMass = 0.15, kStiffness = 300.0, kDamping = 2.0, kStep = 1e-5;
    for (; time_ < time_s; time_ += kStep) {
      const Vector3d pull = kStiffness * (wanted_(time_) - position_) - kDamping * velocity_ + force_n;
      velocity_ += kStep / kMass * pull;
      position_ += kStep * velocity_;
    }
    return position_;
  }

 private:
  std::function<Vector3d(double)> wanted_;
  Vector3d position_;
  Vector3d velocity_ = Vector3d::Zero();
  double time_ = 0.0;
};

/// Pulls out, pushes in, comes back out in 0.9 s, then presses 10 mm behind the device frame's origin.
Vector3d home_and_press(double t) {
  const auto ease = [t](double from, double to, double begin, double end) {
    const double s = std::clamp((t - begin) / (end - begin), 0.0, 1.0);
    return from + (to - from) * s * s * (3.0 - 2.0 * s);
  };
  const double z = t < 0.3   ? ease(0.135, 0.172, 0.0, 0.25)
                   : t < 0.6 ? ease(0.172, 0.105, 0.3, 0.55)
                   : t < 1.0 ? ease(0.105, 0.160, 0.6, 0.9)
                             : ease(0.160, 0.130, 1.1, 1.4);
  return {0.005, -0.003, z};
}

constexpr double kPressed_s = 2.0;

struct Pressed {
  double least_m = 1e9;  ///< of the hand's z over the last second
  double most_m = -1e9;
  double force_n = 0.0;  ///< mean over it
  double stiffness_n_per_m = 0.0;
  bool contact = true;
  bool interrupted = false;     ///< the motors had no force for a moment after kPressed_s
  double longest_tick_s = 0.0;  ///< by the machine's clock
};

Pressed press_a_wall() {
  using Steady = std::chrono::steady_clock;
  auto emulator = std::make_shared<EmulatedFalcon>();
  auto grasp = std::make_shared<Grasp>(home_and_press);
  auto interrupted = std::make_shared<bool>(false);
  emulator->set_hand([grasp, interrupted](double time_s, const Vector3d& force_n) {
    if (time_s > kPressed_s && force_n.isZero(0.0)) *interrupted = true;
    return (*grasp)(time_s, force_n);
  });
  const auto device = make_falcon_device(make_wire(*emulator, Clock::virtual_time), {});
  RendererOptions options;
  options.stiffness_n_per_m = governed_stiffness(800.0, device->info().limits, 1e-3);
  HapticRenderer tick(device->info(), options, window_on(sparsha::test::flat_scene()));

  Pressed pressed;
  pressed.stiffness_n_per_m = options.stiffness_n_per_m;
  constexpr int kTicks = 3500;
  Steady::time_point before = Steady::now();
  for (int i = 0; i < kTicks; ++i) {
    device->wait(1e-3);
    DeviceSample sample = device->read(i * 1e-3, 1e-3);
    sample.delay_s = 1e-3;  // the virtual wire's; the driver measures the machine's
    tick.update(sample, 1e-3);
    const State& state = tick.state();
    device->write({state.commanded_force_n[0], state.commanded_force_n[1], state.commanded_force_n[2]});
    const Steady::time_point now = Steady::now();
    pressed.longest_tick_s = std::max(pressed.longest_tick_s, std::chrono::duration<double>(now - before).count());
    before = now;
    if (i < kTicks - 1000) continue;
    pressed.contact = pressed.contact && state.contact == 1U;
    pressed.least_m = std::min(pressed.least_m, sample.position_m.z());
    pressed.most_m = std::max(pressed.most_m, sample.position_m.z());
    pressed.force_n += state.commanded_force_n[2] / 1000.0;
  }
  pressed.interrupted = *interrupted;
  EXPECT_EQ(emulator->device->unsafe_commands(), 0U);
  return pressed;
}

TEST(FalconUnderTheServo, AHandPressesAWallQuietlyAndFeelsTheStiffnessItShould) {
  // The driver looks at the machine's clock: a program that others stop for 3.5 ms gives no force for a tick, rightly.
  constexpr double kStopped_s = 0.003;
  Pressed pressed = press_a_wall();
  for (int more = 0; more < 50 && pressed.interrupted && pressed.longest_tick_s > kStopped_s; ++more)
    pressed = press_a_wall();
  EXPECT_FALSE(pressed.interrupted);
  EXPECT_TRUE(pressed.contact);
  // Two springs in a row: the hand's 300 N/m pulls to 10 mm depth, the wall's holds.
  const double k = pressed.stiffness_n_per_m;
  const double expected_n = 0.010 * 300.0 * k / (300.0 + k);
  EXPECT_NEAR(pressed.force_n, expected_n, 0.02 * expected_n);
  // At rest within three encoder steps (0.028 mm along the axis at z = 0.14).
  EXPECT_LT(pressed.most_m - pressed.least_m, 3.0 * 28e-6);
}

/// Reads the wire with the emulator's codec and geometry, which share nothing with the driver.
struct WireJudge {
  void see(const emulator::WireEvent& event) {
    const bool command = event.kind == emulator::WireEvent::Kind::to_device;
    if (!command && event.kind != emulator::WireEvent::Kind::to_host) return;
    emulator::CommandParser& parser = command ? commands : answers;
    for (const std::uint8_t byte : std::span(event.bytes).subspan(command ? 0 : 2)) {
      const auto values = parser.feed(byte);
      if (!values) continue;
      if (command)
        judge(values->motors);
      else
        place = emulator::grip_place({emulator::angle_of(values->motors[0]), emulator::angle_of(values->motors[1]),
                                      emulator::angle_of(values->motors[2])},
                                     {0, 0, 0.13});
    }
  }
  void judge(const std::array<int, 3>& motors) {
    if (!judging || !place) return;
    constexpr double kCountsPerNewtonMetre = 10000.0;
    emulator::PerArm torque{};
    for (std::size_t i = 0; i < 3; ++i) torque[i] = -motors[i] / kCountsPerNewtonMetre;
    const auto rates = emulator::angle_rates(*place);
    ASSERT_TRUE(rates);
    double rounding_n = 0.0;  // half a count of each motor
    for (const auto& row : *rates) rounding_n += 0.5 / kCountsPerNewtonMetre * std::hypot(row[0], row[1], row[2]);
    const double depth_m = kPlane_m - (*place)[2];
    const double force_n = emulator::force_of(torque, *place)[2];
    EXPECT_NEAR(force_n, stiffness_n_per_m * depth_m, rounding_n);
    deepest_m = std::max(deepest_m, depth_m);
    ++judged;
  }

  emulator::CommandParser commands, answers;  ///< an answer has a command's layout
  static constexpr double kPlane_m = 0.140;   ///< the middle of the workspace, Falcon frame
  double stiffness_n_per_m = 0.0;
  bool judging = false;
  std::optional<emulator::Vec3> place;
  double deepest_m = 0.0;
  int judged = 0;
};

TEST(FalconUnderTheServo, APlanesForceOnTheWireIsStiffnessTimesDepthWithinTheMotorsRounding) {
  EmulatedFalcon falcon;
  auto grasp = std::make_shared<Grasp>(home_and_press);
  falcon.set_hand([grasp](double time_s, const Vector3d& force_n) { return (*grasp)(time_s, force_n); });
  WireJudge judge;
  falcon.device->set_log([&judge](const emulator::WireEvent& event) { judge.see(event); });
  const auto device = make_falcon_device(make_wire(falcon, Clock::virtual_time), {});
  RendererOptions options;
  judge.stiffness_n_per_m = options.stiffness_n_per_m = governed_stiffness(800.0, device->info().limits, 1e-3);
  HapticRenderer tick(device->info(), options, window_on(sparsha::test::flat_scene()));
  for (int i = 0; i < 3500; ++i) {
    judge.judging = i > 2500;  // at rest: neither slew nor damping alters the force
    device->wait(1e-3);
    tick.update(device->read(i * 1e-3, 1e-3), 1e-3);
    const State& state = tick.state();
    device->write({state.commanded_force_n[0], state.commanded_force_n[1], state.commanded_force_n[2]});
  }
  judge.judging = false;
  EXPECT_GT(judge.judged, 900);
  EXPECT_GT(judge.deepest_m, 0.002);
}

TEST(FalconUnderTheServo, TheWatchdogZeroesTheMotorsWhenTheServoStalls) {
  auto emulator = std::make_shared<EmulatedFalcon>();
  auto grasp = std::make_shared<Grasp>(home_and_press);
  emulator->set_hand([grasp](double time_s, const Vector3d& force_n) { return (*grasp)(time_s, force_n); });

  /// The Falcon, whose read() hangs on command.
  struct Stalling final : Device {
    std::unique_ptr<Device> falcon;
    std::atomic<bool> stall{false};
    DeviceInfo info() const override { return falcon->info(); }
    void wait(double timeout_s) noexcept override { falcon->wait(timeout_s); }
    DeviceSample read(double time_s, double period_s) noexcept override {
      while (stall.load()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return falcon->read(time_s, period_s);
    }
    void write(const Vector3d& force_n) noexcept override { falcon->write(force_n); }
    void zero() noexcept override { falcon->zero(); }
  } device;
  device.falcon = make_falcon_device(make_wire(*emulator, Clock::real_time), {});

  sparsha::haptics::Seqlock<State> state;
  ServoOptions options;
  options.real_time = false;
  options.renderer.longest_gap_s = 0.3;  // the machine's own pauses are not what is tested
  Servo servo(device, options, window_on(sparsha::test::flat_scene()), state, {}, nullptr);
  servo.start();
  EXPECT_TRUE(eventually([&] { return emulator->command() != MotorCommand{}; })) << "the hand presses after 1.4 s";
  device.stall.store(true);
  // It switches the motors off first and counts afterwards.
  EXPECT_TRUE(eventually([&] { return servo.watchdog_trips() >= 1 && emulator->command() == MotorCommand{}; }));
  device.stall.store(false);
  servo.stop();
  EXPECT_EQ(emulator->command(), MotorCommand{});
}

/// A wire that answers at once from a fixed place and allocates nothing.
class PlainWire final : public Transport {
 public:
  TransportStatus control(Request, std::uint16_t) noexcept override { return TransportStatus::ok; }
  TransportStatus write(std::span<const std::uint8_t> bytes, int) noexcept override { return post(bytes); }
  TransportStatus read(UsbPacket& packet, std::size_t& size, int) noexcept override {
    return receive(packet, size, 0.0);
  }
  TransportStatus post(std::span<const std::uint8_t>) noexcept override {
    ++asked_;
    return TransportStatus::ok;
  }
  TransportStatus receive(UsbPacket& packet, std::size_t& size, double) noexcept override {
    if (asked_ == 0) ++in_vain;
    if (asked_ == 0) return TransportStatus::nothing;
    --asked_;
    if (answers_after_s > 0.0) std::this_thread::sleep_for(std::chrono::duration<double>(answers_after_s));
    const Packet answer = sparsha::emulator::answer_bytes({600 + (++count_ % 50), 610, 620}, 0, 7);
    std::copy(answer.begin(), answer.end(), packet.begin() + kModemBytes);
    size = kModemBytes + answer.size();
    return TransportStatus::ok;
  }
  void urgent(std::span<const std::uint8_t> bytes) noexcept override { static_cast<void>(post(bytes)); }
  [[nodiscard]] bool present() const noexcept override { return true; }

  double answers_after_s = 0.0;
  int in_vain = 0;  ///< looks when nothing could be there

 private:
  int asked_ = 0;
  int count_ = 0;
};

TEST(FalconUnderTheServo, NothingIsAskedOfTheSystemBetweenAnAnswerAndTheNextQuestion) {
  auto owned = std::make_unique<PlainWire>();
  PlainWire& wire = *owned;
  const auto device = make_falcon_device(std::move(owned), {});
  const auto looks = [&](double answers_after_s) {
    wire.answers_after_s = answers_after_s;
    wire.in_vain = 0;
    for (int tick = 0; tick < 128; ++tick) {
      device->wait(1e-3);
      static_cast<void>(device->read(0.0, 1e-3));
      device->write({1, 2, 3});
    }
    return wire.in_vain;
  };
  EXPECT_LE(looks(0.0005), 4) << "each such look costs the next question its frame";
  EXPECT_GE(looks(0.0), 100) << "an answer that comes at once was nobody's: there may be more";
}

TEST(FalconUnderTheServo, ItsTicksAllocateNothing) {
  const auto device = make_falcon_device(std::make_unique<PlainWire>(), {});
  DeviceSample sample;
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      device->wait(1e-3);
      sample = device->read(0.0, 1e-3);
      device->write({1, 2, 3});
      device->zero();
    }
  };
  run(50);
  const std::size_t before = allocations::count();
  run(1000);
  EXPECT_EQ(allocations::count(), before);
  EXPECT_TRUE(sample.fresh);
  EXPECT_TRUE(sample.homed);
}

}  // namespace
