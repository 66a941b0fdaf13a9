// What is there and what is not: one of several devices, a service that ends while it is set up, a grip without a turn.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <thread>

#include "base/error.h"
#include "emulator/web_socket_server.h"
#include "haptics/device/haply/messages.h"
#include "tests/haptics/device/haply/emulated_service.h"

namespace sparsha::haptics::haply {
namespace {
using ::testing::HasSubstr;

TEST(HaplyPresence, TheInverse3ThatWasTakenIsWaitedForAndNoOtherIsMovedMeanwhile) {
  emulator::HaplyOptions options = soon();
  options.devices = 2;
  options.disconnect = true;
  options.fault_after_s = 0.6;
  options.fault_s = 1.2;
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  {
    const Running run(*device);
    ASSERT_TRUE(says(*device, "device_away")) << "the service is there, and it tells so";
    EXPECT_TRUE(run.servo.unplugged());
    ASSERT_TRUE(eventually([&] { return !run.servo.unplugged() && (run.state.read().flags & kFlagArmed) != 0; }));
  }
  const auto log = emulated.log();
  EXPECT_TRUE(std::none_of(log.begin(), log.end(), [](const emulator::HaplyMessage& message) {
    return !message.to_client && message.text.find("EMU1") != std::string::npos;
  }));
}

TEST(HaplyPresence, WhereAnotherIdIsWantedThoseThatAreThereAreNamed) {
  emulator::HaplyOptions options;
  options.devices = 2;
  Service emulated(options);
  emulated.client.device_id = "EMU9";
  try {
    static_cast<void>(make_haply_device(emulated.client));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.wrong(), HasSubstr("EMU9"));
    EXPECT_EQ(error.expected(), "EMU0, EMU1");
  }
}

TEST(HaplyPresence, AServiceThatEndsWhileItIsSetUpIsToldFromOneThatIsNotUnderstood) {
  for (const bool inventory : {false, true}) {
    system::StreamListener listener(0);
    std::thread service([&] {
      const auto peer = emulator::WebSocketPeer::greet(listener.accept(10.0));
      if (peer && inventory)
        peer->send(
            R"({"session_id":1,"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":0,"y":0,"z":0}}}]})");
      if (peer) peer->close();
    });
    HaplyOptions client;
    client.port = listener.port();
    client.events_port = 1;  // nobody listens there
    try {
      static_cast<void>(make_haply_device(client));
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_THAT(error.wrong(), HasSubstr("ended the connection")) << inventory;
    }
    service.join();
  }
}

TEST(HaplyPresence, AGripWithoutAWholeTurnHasNone) {
  const auto turn_of = [](const std::string& state_of_grip) {
    ServiceState state;
    EXPECT_TRUE(
        read_state(R"({"inverse3":[],"verse_grip":[{"device_id":"G","state":{)" + state_of_grip + "}}]}", "A", state));
    return state.orientation;
  };
  constexpr std::array<double, 4> kNone{};
  EXPECT_EQ(turn_of(R"("buttons":{"a":true})"), kNone);
  EXPECT_EQ(turn_of(R"("orientation":null)"), kNone);
  EXPECT_EQ(turn_of(R"("orientation":{"x":0.6,"y":0.8,"z":0.0})"), kNone) << "it would be half a turn";
  EXPECT_EQ(turn_of(R"("orientation":{"x":0.6,"y":0.8,"z":0.0,"w":0.0})"), (std::array<double, 4>{0.0, 0.6, 0.8, 0.0}));
}

TEST(HaplyPresence, AServiceThatTakesForcesUnderAnotherKeyIsSaid) {
  emulator::HaplyOptions options;
  options.version_3_6 = true;
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  const Running run(*device);
  EXPECT_TRUE(eventually([&] {
    const DeviceAdvice* const advice = device->advice();
    return advice != nullptr && std::string(advice->phrase) == "device_changes_force" && advice->needed;
  })) << "and more than as a remark";
  ASSERT_TRUE(eventually([&] { return run.state.read().contact == 0; }));
  EXPECT_TRUE(eventually([&] { return device->advice() != nullptr; })) << "said once, and not anew at each touch";
  EXPECT_EQ(emulated.service->strongest_n(), 0.0);
  EXPECT_TRUE(eventually([&] { return run.state.read().given_share < 0.1; }));
}

}  // namespace
}  // namespace sparsha::haptics::haply
