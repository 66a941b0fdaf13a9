// The real libusb against an emulated bus: finding, opening, firmware, forces, unplugging.
#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <string_view>

#include "base/error.h"
#include "emulator/usb_bus.h"
#include "haptics/device/falcon/check.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/link.h"
#include "haptics/device/falcon/packet.h"
#include "haptics/device/falcon/usb_transport.h"

namespace {

using namespace sparsha;
using namespace sparsha::haptics;
using namespace sparsha::haptics::falcon;
using Eigen::Vector3d;

class UsbFalcon : public testing::Test {
 protected:
  void plug(const emulator::FalconOptions& options = {}) {
    falcon = std::make_shared<emulator::Falcon>(options);
    bus = std::make_unique<emulator::UsbBus>(std::vector{falcon});
  }
  void hold(const Vector3d& place_m) { falcon->set_place({place_m.x(), place_m.y(), place_m.z()}); }
  void SetUp() override {
    if (!emulator::UsbBus::preloaded()) GTEST_SKIP() << "umockdev's library is not preloaded";
  }
  static void run(Device& device, int ticks, const Vector3d& force_n = Vector3d::Zero()) {
    for (int i = 0; i < ticks; ++i) {
      device.wait(0.001);
      last = device.read(0.0, 0.001);
      fresh += last.fresh ? 1 : 0;
      device.write(force_n);
    }
  }
  static inline DeviceSample last;
  static inline int fresh = 0;
  std::shared_ptr<emulator::Falcon> falcon;
  std::unique_ptr<emulator::UsbBus> bus;
};

TEST_F(UsbFalcon, IsFoundWhenPluggedIn) {
  plug();
  const auto found = find_falcons();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].bus, 1);
  EXPECT_EQ(found[0].address, 5);
  EXPECT_TRUE(found[0].accessible) << found[0].problem;
  const auto holder = open_usb_transport();
  EXPECT_FALSE(find_falcons().at(0).accessible);
  EXPECT_EQ(find_falcons().at(0).problem, "another program holds it");
}

TEST_F(UsbFalcon, LoadsFirmwareOverRealTransfers) {
  emulator::FalconOptions options;
  options.firmware_loaded = false;
  plug(options);
  std::vector<std::uint8_t> image(5000);
  std::mt19937 random(1);
  for (auto& byte : image) byte = static_cast<std::uint8_t>(random());
  const auto wire = open_usb_transport();
  bring_up(*wire, image, 1);
  EXPECT_EQ(falcon->uploaded(), image);
  EXPECT_TRUE(falcon->firmware_loaded());
}

TEST_F(UsbFalcon, FeelsTheHandAndPushesBack) {
  plug();
  const auto device = make_falcon_device();
  for (const double z : {0.170, 0.105, 0.160, 0.14}) {
    hold({0, 0.01, z});
    run(*device, 60);
  }
  EXPECT_TRUE(last.homed);
  EXPECT_LT((last.position_m - Vector3d(0, 0.01, 0)).norm(), 5e-5);
  fresh = 0;
  const Vector3d force(1, -1, 2);
  run(*device, 200, force);
  EXPECT_GT(fresh, 50);  // a loaded machine delays the emulated bus
  const auto error_n = [&] {
    const auto felt = falcon->force_n();
    return (Vector3d(felt[0], felt[1], felt[2]) - force).norm();
  };
  // After an answer that is late the force is zero until the next.
  for (int tick = 0; tick < 200 && error_n() > 0.01; ++tick) run(*device, 1, force);
  EXPECT_LT(error_n(), 0.01);
  device->zero();
  run(*device, 3);
  EXPECT_EQ(falcon->motors(), MotorCommand{});
  EXPECT_EQ(falcon->unsafe_commands(), 0U);
}

TEST_F(UsbFalcon, QuestionsThatTheBusDoesNotTakeAreCalledBackSoThatAZeroCanFollow) {
  emulator::FalconOptions options;
  options.homed = true;
  plug(options);
  const auto wire = open_usb_transport();
  enter_run_mode(*wire);
  const Packet force = encode({100, 100, 100}, kHomingRequest);
  bus->hold_writes(0, true);
  int posted = 0;
  while (posted < 100 && wire->post(force) == TransportStatus::ok) ++posted;
  ASSERT_LT(posted, 100);
  const std::uint64_t before = falcon->commands();
  UsbPacket bytes{};
  std::size_t size = 0;
  const auto began = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - began < std::chrono::milliseconds(200))  // all are late then
    static_cast<void>(wire->receive(bytes, size, 0.005));
  TransportStatus status = TransportStatus::nothing;
  for (int look = 0; look < 1000 && status == TransportStatus::nothing; ++look) {
    status = wire->post(encode({}, kHomingRequest));
    static_cast<void>(wire->receive(bytes, size, 0.005));
  }
  EXPECT_EQ(status, TransportStatus::ok);
  bus->hold_writes(0, false);
  EXPECT_EQ(falcon->commands(), before + 1) << "an old force waited for the bus";
  EXPECT_EQ(falcon->motors(), MotorCommand{});
  // One that is never taken keeps nobody from closing.
  bus->hold_writes(0, true);
  EXPECT_EQ(wire->post(force), TransportStatus::ok);
}

TEST_F(UsbFalcon, EndsInZeroForceWhenClosed) {
  plug();
  {
    const auto device = make_falcon_device();
    for (const double z : {0.170, 0.105, 0.160, 0.14}) {
      hold({0, 0, z});
      run(*device, 40, {0, 0, 3});
    }
    EXPECT_NE(falcon->motors(), MotorCommand{});
  }
  EXPECT_EQ(falcon->motors(), MotorCommand{});
}

TEST_F(UsbFalcon, AKioskBeginsBesideOneThatHasNoPowerOrIsHeldAndTakesItOnceItCan) {
  FalconOptions kiosk;
  kiosk.wait_for_device = true;
  emulator::FalconOptions options;
  options.powered = false;
  plug(options);
  const auto device = make_falcon_device(kiosk);
  run(*device, 3);
  EXPECT_FALSE(last.connected);
  const auto advises = [&](const char* phrase) {
    for (int look = 0; look < 10000; ++look) {
      run(*device, 1);
      const DeviceAdvice* const advice = device->advice();  // once: the servo changes it
      if (advice != nullptr && std::string_view(advice->phrase) == phrase) return true;
    }
    return false;
  };
  EXPECT_TRUE(advises("device_does_not_start"));
  const auto other = open_usb_transport();
  EXPECT_TRUE(advises("device_busy"));
}

TEST_F(UsbFalcon, UnpluggingIsNoticedWithinTicksAndClosingDoesNotHang) {
  plug();
  const auto device = make_falcon_device();
  run(*device, 20);
  EXPECT_TRUE(last.connected);
  bus->unplug(0);
  run(*device, 20);
  EXPECT_FALSE(last.connected);
  EXPECT_FALSE(last.fresh);
}

TEST_F(UsbFalcon, UnpluggedByTheFaultItHasNoPowerAndNoForceMeanwhile) {
  emulator::BusFaults faults;
  faults.unplug_after_s = 0.1;
  faults.replug_after_s = 60.0;
  falcon = std::make_shared<emulator::Falcon>();
  bus = std::make_unique<emulator::UsbBus>(std::vector{falcon}, faults);
  const auto device = make_falcon_device();
  for (const double z : {0.170, 0.105, 0.160, 0.14}) {
    hold({0, 0, z});
    run(*device, 60, {0, 0, 3});
  }
  for (int tick = 0; tick < 10000 && falcon->plugged(); ++tick) run(*device, 1, {0, 0, 3});
  EXPECT_FALSE(falcon->plugged());
  EXPECT_EQ(falcon->motors(), MotorCommand{});
}

TEST_F(UsbFalcon, TheCheckWalksFromUsbToTheLink) {
  emulator::FalconOptions options;
  options.homed = true;
  plug(options);
  const CheckReport report = check_falcon();
  ASSERT_EQ(report.steps.size(), 6U);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(report.steps[i].result, CheckStep::Result::passed) << report.steps[i].name;
  // The emulated bus is as fast as this machine lets it be: the rate is shown, not judged.
  std::printf("link: %s\n", report.steps[5].detail.c_str());
  EXPECT_GT(report.link.answered, 50U);
}

TEST_F(UsbFalcon, TheCheckNamesTheOneItWalksThroughWhereAnotherProgramHoldsTheFirst) {
  std::vector<std::shared_ptr<emulator::Falcon>> two{std::make_shared<emulator::Falcon>(),
                                                     std::make_shared<emulator::Falcon>()};
  bus = std::make_unique<emulator::UsbBus>(two);
  const auto holder = open_usb_transport();
  EXPECT_EQ(holder->address().address, 5U);
  EXPECT_EQ(check_falcon({}, 0.1).steps.front().detail, "bus 1 device 6, one of 2");
}

TEST_F(UsbFalcon, WithoutOneOpeningSaysWhatToPlugIn) {
  EXPECT_TRUE(find_falcons().empty());
  try {
    static_cast<void>(open_usb_transport());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::device);
    EXPECT_FALSE(error.expected().empty());
  }
  const CheckReport report = check_falcon();
  EXPECT_EQ(report.steps.front().result, CheckStep::Result::failed);
  EXPECT_FALSE(report.steps.front().remedy.empty());
}

}  // namespace
