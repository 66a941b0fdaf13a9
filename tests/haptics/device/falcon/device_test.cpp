// The Falcon as the servo sees it: positions, forces, gates, faults.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include <Eigen/Geometry>

#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/packet.h"
#include "haptics/device/falcon/transport.h"
#include "haptics/emulator/person.h"
#include "tests/support/emulated_falcon.h"

namespace {

using namespace sparsha::haptics;
using namespace sparsha::haptics::falcon;
using namespace sparsha::test;
using Eigen::Vector3d;

class FalconOnTheBench : public testing::Test {
 protected:
  void start(EmulatorOptions options = {}, Clock clock = Clock::virtual_time) {
    emulator = std::make_shared<EmulatedFalcon>(options);
    device = make_falcon_device(make_wire(*emulator, clock), {});
  }
  /// One servo tick that asks for a force.
  DeviceSample tick(const Vector3d& force_n = Vector3d::Zero()) {
    device->wait(0.001);
    const DeviceSample sample = device->read(0.001 * ++ticks, 0.001);
    device->write(force_n);
    return sample;
  }
  void hold(const Vector3d& position_m, int count, const Vector3d& force_n = Vector3d::Zero()) {
    emulator->set_position(position_m);
    for (int i = 0; i < count; ++i) tick(force_n);
  }
  void home() {
    hold({0, 0, 0.170}, 20);
    hold({0, 0, 0.105}, 40);
    hold({0, 0, 0.160}, 20);
  }

  std::shared_ptr<EmulatedFalcon> emulator;
  std::unique_ptr<Device> device;
  double ticks = 0;
};

TEST_F(FalconOnTheBench, GivesThePositionInTheDeviceFrameWithinHalfACount) {
  start();
  home();
  for (const Vector3d& offset :
       {Vector3d(0, 0, 0), Vector3d(0.02, 0, 0), Vector3d(0, 0.02, -0.01), Vector3d(-0.02, -0.01, 0.01)}) {
    hold(Vector3d(0, 0, 0.14) + offset, 6);
    const DeviceSample sample = tick();
    EXPECT_TRUE(sample.fresh);
    EXPECT_TRUE(sample.homed);
    EXPECT_LT((sample.position_m - offset).norm(), 5e-5);
  }
}

TEST_F(FalconOnTheBench, PutsTheAskedForceIntoTheHandInEveryDirection) {
  start();
  home();
  for (const Vector3d& place : {Vector3d(0, 0, 0.13), Vector3d(0.02, 0.01, 0.14), Vector3d(-0.02, 0.02, 0.15)})
    for (const Vector3d& force : {Vector3d(2, 0, 0), Vector3d(0, 2, 0), Vector3d(0, 0, 2), Vector3d(-1, 1, -1)}) {
      hold(place, 6);
      hold(place, 3, force);
      // Three commands rounded to a count of 1e-4 N m are at most 0.01 N at the grip.
      EXPECT_LT((emulator->force_n() - force).norm(), 0.01) << place.transpose();
    }
}

TEST_F(FalconOnTheBench, TooGreatAForceIsCutToTheDevicesOwnLimitAndKeepsItsDirection) {
  start();
  home();
  for (const double times : {10.0, 100.0, 1e30}) {
    const Vector3d force = times * Vector3d(1, -0.5, 0.7);
    hold({0.01, 0, 0.14}, 6, force);
    EXPECT_NEAR(emulator->force_n().norm(), falcon_info().limits.max_force_n, 0.01) << "a motor count is 1 mN or less";
    EXPECT_LT(emulator->force_n().normalized().cross(force.normalized()).norm(), 2e-3);
  }
}

TEST_F(FalconOnTheBench, NeverSendsForceBeforeHomingAndTheSecondGate) {
  start();
  const Vector3d force(1, 2, 3);
  hold({0, 0, 0.135}, 50, force);
  EXPECT_FALSE(tick(force).homed);
  hold({0, 0, 0.170}, 50, force);
  hold({0, 0, 0.105}, 50, force);  // the encoders are homed now, the grip is deep inside
  EXPECT_FALSE(tick(force).homed);
  hold({0, 0, 0.150}, 50, force);
  EXPECT_FALSE(tick(force).homed) << "not pulled out yet";
  EXPECT_EQ(emulator->command(), MotorCommand{});
  EXPECT_EQ(emulator->device->unsafe_commands(), 0U);
  hold({0, 0, 0.160}, 3, force);
  EXPECT_TRUE(tick(force).homed);
  tick(force);
  EXPECT_NE(emulator->command(), MotorCommand{});
}

TEST_F(FalconOnTheBench, LosingItsHomeEndsForceAtOnce) {
  start();
  home();
  hold({0, 0, 0.14}, 6, {0, 0, 3});
  ASSERT_NE(emulator->command(), MotorCommand{});
  emulator->device->power_cycle();
  for (int i = 0; i < 20; ++i) {
    const DeviceSample sample = tick({0, 0, 3});
    EXPECT_TRUE(!sample.fresh || !sample.homed || i == 0);
  }
  EXPECT_EQ(emulator->device->unsafe_commands(), 0U);
}

TEST_F(FalconOnTheBench, ZeroFromAnotherThreadTakesTheForceAway) {
  start();
  home();
  hold({0, 0, 0.14}, 6, {0, 0, 3});
  ASSERT_NE(emulator->command(), MotorCommand{});
  std::thread([this] { device->zero(); }).join();
  EXPECT_EQ(emulator->command(), MotorCommand{});
}

TEST_F(FalconOnTheBench, ZeroNeverRacesWithTheServo) {
  start();
  home();
  std::atomic<bool> stop{false};
  std::thread watchdog([&] {
    while (!stop.load()) {
      device->zero();
      // The emulator's lock is not fair: without a pause the servo's turn might never come.
      std::this_thread::sleep_for(std::chrono::microseconds(1));
    }
  });
  for (int i = 0; i < 2000; ++i) tick({0, 0, 2});
  stop.store(true);
  watchdog.join();
  hold({0, 0, 0.14}, 3);
  EXPECT_TRUE(tick().fresh);
}

/// A wire to an emulator that gives packets without end once it is told to.
class Chatter final : public Transport {
 public:
  explicit Chatter(std::unique_ptr<Transport> wire) : wire_(std::move(wire)) {}

  TransportStatus control(Request request, std::uint16_t value) noexcept override {
    return wire_->control(request, value);
  }
  TransportStatus write(std::span<const std::uint8_t> bytes, int timeout_ms) noexcept override {
    return wire_->write(bytes, timeout_ms);
  }
  TransportStatus read(UsbPacket& packet, std::size_t& size, int timeout_ms) noexcept override {
    return wire_->read(packet, size, timeout_ms);
  }
  TransportStatus post(std::span<const std::uint8_t> bytes) noexcept override { return wire_->post(bytes); }
  TransportStatus receive(UsbPacket& packet, std::size_t& size, double timeout_s) noexcept override {
    if (!talks) return wire_->receive(packet, size, timeout_s);
    packet.fill('A');
    size = packet.size();
    ++given;
    return TransportStatus::ok;
  }
  void urgent(std::span<const std::uint8_t> bytes) noexcept override { wire_->urgent(bytes); }

  bool talks = false;
  std::size_t given = 0;

 private:
  std::unique_ptr<Transport> wire_;
};

TEST_F(FalconOnTheBench, ADeviceThatNeverStopsTalkingDoesNotHoldTheServo) {
  emulator = std::make_shared<EmulatedFalcon>(EmulatorOptions{});
  auto wire = std::make_unique<Chatter>(make_wire(*emulator, Clock::virtual_time));
  Chatter& chatter = *wire;
  device = make_falcon_device(std::move(wire), {});
  home();
  chatter.talks = true;
  EXPECT_FALSE(tick({0, 0, 3}).fresh) << "noise is no answer";
  EXPECT_LE(chatter.given, 64U);
  chatter.talks = false;
  hold({0, 0, 0.14}, 6);
  EXPECT_TRUE(tick().fresh);
}

TEST_F(FalconOnTheBench, EndsInZeroForce) {
  start();
  home();
  hold({0, 0, 0.14}, 6, {0, 0, 3});
  ASSERT_NE(emulator->command(), MotorCommand{});
  device.reset();
  EXPECT_EQ(emulator->command(), MotorCommand{});
}

TEST_F(FalconOnTheBench, AForceThatIsNotANumberIsZero) {
  start();
  home();
  hold({0, 0, 0.14}, 6, {0, 0, 3});
  hold({0, 0, 0.14}, 3, {std::nan(""), 0, 0});
  EXPECT_EQ(emulator->command(), MotorCommand{});
}

TEST_F(FalconOnTheBench, UnpluggingIsSaidAndNothingHangs) {
  start();
  home();
  emulator->device->unplug(true, 0.0);
  DeviceSample sample;
  for (int i = 0; i < 5; ++i) sample = tick({0, 0, 3});
  EXPECT_FALSE(sample.connected);
  EXPECT_FALSE(sample.fresh);
}

TEST_F(FalconOnTheBench, LostGarbledAndSplitAnswersAreSurvived) {
  EmulatorOptions options;
  options.lose_every = 17;
  options.garble_every = 13;
  options.split_answers = true;
  start(options, Clock::real_time);
  for (const double z : {0.170, 0.105, 0.160}) hold({0, 0, z}, 60);
  int fresh = 0;
  emulator->set_position({0.01, 0, 0.14});
  for (int i = 0; i < 10; ++i) tick();
  for (int i = 0; i < 300; ++i) {
    const DeviceSample sample = tick({0, 0, 1});
    if (sample.fresh) {
      ++fresh;
      EXPECT_LT((sample.position_m - Vector3d(0.01, 0, 0)).norm(), 5e-5);
    }
  }
  EXPECT_GT(fresh, 200);
  EXPECT_EQ(emulator->device->unsafe_commands(), 0U);
}

TEST_F(FalconOnTheBench, PassesTheButtonsOn) {
  start();
  emulator->device->set_buttons(9);
  tick();
  EXPECT_EQ(tick().buttons, 9U);
}

TEST(FalconInRealTime, APersonHomesItAndItRunsNearAKilohertz) {
  EmulatedFalcon falcon;
  falcon.device->set_hand(sparsha::haptics::emulator::make_person());
  const auto device = make_falcon_device(make_wire(falcon, Clock::real_time), {});
  EXPECT_TRUE(device->info().paced);
  int fresh = 0, homed = 0;
  for (int i = 0; i < 2000; ++i) {
    device->wait(0.001);
    const DeviceSample sample = device->read(0.0, 0.001);
    fresh += sample.fresh ? 1 : 0;
    homed += sample.homed ? 1 : 0;
    device->write(Vector3d::Zero());
  }
  EXPECT_GT(fresh, 1500);
  EXPECT_GT(homed, 300);
}

}  // namespace
