// The driver under the servo on an emulated service that shares no code with it. What goes over the wire is judged from
// the service's log, by another reader of JSON.
#include "haptics/device/haply/haply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"
#include "emulator/haply_service.h"
#include "emulator/person.h"
#include "haptics/conformance/conformance.h"
#include "haptics/servo/servo.h"
#include "tests/haptics/device/haply/emulated_service.h"
#include "tests/support/allocations.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics::haply {
namespace {
using ::testing::HasSubstr;
using Json = nlohmann::json;

TEST(Haply, APlaneIsFeltAndTheLastCommandsAreZero) {
  Service emulated;
  {
    const auto device = make_haply_device(emulated.client);
    EXPECT_EQ(device->info().name, "Haply Inverse3");
    const Running run(*device);
    ASSERT_TRUE(eventually([&] { return emulated.service->strongest_n() > 0.5; }));
    EXPECT_EQ(run.state.read().contact, 1U);
  }
  const auto log = emulated.log();
  double last_n = -1.0, most_n = 0.0;
  int configured = 0;
  for (const emulator::HaplyMessage& message : log) {
    if (const double n = asked_n(message); n >= 0.0) {
      last_n = n;
      most_n = std::max(most_n, n);
    }
    if (!message.to_client && message.text.find("\"configure\"") != std::string::npos) ++configured;
  }
  EXPECT_EQ(last_n, 0.0);
  EXPECT_LE(most_n, 4.0);
  EXPECT_EQ(configured, 1) << "the session is configured once, in the first message";
}

TEST(Haply, FrameAndSignsAreThoseOfTheService) {
  // The hand is 20 mm to the right, 10 mm up and 30 mm towards the person from the middle.
  Service emulated({}, [](const emulator::Felt&) { return emulator::Grip{{0.02, 0.01, 0.17}, 5}; });
  const auto device = make_haply_device(emulated.client);
  DeviceSample sample;
  for (int tick = 0; tick < 5; ++tick) {
    device->wait(0.001);
    sample = device->read(0.001 * tick, 0.001);
    device->write({0.1, 0.2, 0.3});
  }
  EXPECT_LT((sample.position_m - Eigen::Vector3d(0.02, 0.01, 0.03)).norm(), 1e-9);
  EXPECT_EQ(sample.buttons, 5U);
  EXPECT_EQ(sample.orientation[0], 1.0) << "of the grip, which is not turned";
  EXPECT_TRUE(sample.homed && sample.connected);
  const auto log = emulated.log();
  const auto last = std::find_if(log.rbegin(), log.rend(), [](const auto& message) { return !message.to_client; });
  const Json force = Json::parse(last->text)["inverse3"][0]["commands"]["set_cursor_force"]["vector"];
  EXPECT_EQ(force["x"], 0.1) << "right";
  EXPECT_EQ(force["y"], -0.3) << "away from the person";
  EXPECT_EQ(force["z"], 0.2) << "up";
}

/// A service in another process, which allocates as it likes.
class OtherProcess {
 public:
  OtherProcess() {
    int ends[2] = {-1, -1};
    if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
    process_ = ::fork();
    if (process_ == 0) {
      emulator::HaplyOptions options;
      options.port = options.events_port = 0;
      emulator::HaplyService service(options, emulator::make_person());
      const std::array<std::uint16_t, 2> ports{service.port(), service.events_port()};
      if (::write(ends[1], ports.data(), sizeof ports) < 0) ::_exit(1);
      for (;;) ::pause();
    }
    std::array<std::uint16_t, 2> ports{};
    if (::read(ends[0], ports.data(), sizeof ports) == sizeof ports) {
      client.port = ports[0];
      client.events_port = ports[1];
    }
    for (const int end : ends) ::close(end);
  }
  ~OtherProcess() {
    ::kill(process_, SIGKILL);
    int status = 0;
    ::waitpid(process_, &status, 0);
  }
  HaplyOptions client;

 private:
  pid_t process_ = 0;
};

TEST(Haply, TicksAtOneAndFourKilohertzAllocateNothing) {
  for (const double rate_hz : {1000.0, 4000.0}) {
    const OtherProcess service;
    const auto device = make_haply_device(service.client);
    const double period_s = 1.0 / rate_hz;
    std::vector<double> delays_s;
    delays_s.reserve(2000);
    const auto began = std::chrono::steady_clock::now();
    const std::size_t before = allocations::count();
    for (int tick = 0; tick < 1000; ++tick) {
      device->wait(period_s);
      const DeviceSample sample = device->read(period_s * tick, period_s);
      device->write({0.0, 0.0, 0.1});
      if (sample.fresh) delays_s.push_back(sample.delay_s);
    }
    EXPECT_EQ(allocations::count(), before);
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    EXPECT_GT(delays_s.size(), 900U) << "answers";
    std::sort(delays_s.begin(), delays_s.end());
    std::printf("%.0f Hz asked, %.0f ticks/s, %zu answers, delay %.3f ms median, %.3f ms 99 %%\n", rate_hz,
                1000.0 / took_s, delays_s.size(), 1e3 * delays_s[delays_s.size() / 2],
                1e3 * delays_s[delays_s.size() * 99 / 100]);
  }
}

using Log = std::vector<emulator::HaplyMessage>;

/// Every command from `from` on is zero until `to_s`, but for two that may have crossed the event on the wire: the
/// judge counts, because a service on a loaded machine reads late.
void expect_zero_between(Log::const_iterator from, const Log& log, double to_s) {
  int commands = 0;
  for (auto message = from; message != log.end() && message->time_s < to_s; ++message) {
    const double n = asked_n(*message);
    if (n < 0.0 || ++commands <= 2) continue;
    EXPECT_EQ(n, 0.0) << commands << " commands after the event";
  }
  EXPECT_GT(commands, 5);
}

TEST(Haply, AnEmergencyBrakeIsZeroForceWithinATickAndOnlyAFreshApproachGoesOn) {
  emulator::HaplyOptions options = soon();
  options.brake = true;
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  {
    const Running run(*device);
    ASSERT_TRUE(says(*device, "device_ebrake"));
    ASSERT_TRUE(says(*device, "device_lift")) << "after the release";
    ASSERT_TRUE(eventually([&] { return (run.state.read().flags & kFlagArmed) != 0; }));
  }
  const auto log = emulated.log();
  const auto at = [&](const char* what) {
    return std::find_if(log.begin(), log.end(),
                        [&](const auto& one) { return one.text.find(what) != std::string::npos; });
  };
  ASSERT_NE(at("ebrake_triggered"), log.end());
  ASSERT_NE(at("ebrake_released"), log.end());
  // And for 50 ms in the air after the release.
  expect_zero_between(at("ebrake_triggered"), log, at("ebrake_released")->time_s + 0.04);
  EXPECT_EQ(emulated.service->unsafe_commands(), 0U);
}

TEST(Haply, WithoutWordOfItsBrakeAServiceThatToldOfItGetsNoForce) {
  emulator::HaplyOptions options = soon();
  options.loses_events = true;
  options.fault_after_s = 0.6;
  options.fault_s = 2.5;
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  const Running run(*device);
  ASSERT_TRUE(says(*device, "device_no_events"));
  EXPECT_TRUE(run.servo.unplugged());
  const std::size_t told = emulated.log().size();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto log = emulated.log();
  EXPECT_TRUE(std::none_of(log.begin() + static_cast<std::ptrdiff_t>(told), log.end(),
                           [](const emulator::HaplyMessage& message) { return asked_n(message) > 0.0; }));
  ASSERT_TRUE(eventually([&] { return !run.servo.unplugged() && (run.state.read().flags & kFlagArmed) != 0; }));
}

TEST(Haply, OnlyWatchingCommandsAndSetsNothing) {
  Service emulated;
  emulated.client.watch_only = true;
  {
    const auto device = make_haply_device(emulated.client);
    EXPECT_EQ(device->info().limits.max_force_n, 0.0);
    int places = 0;
    for (int tick = 0; tick < 5000 && places < 20; ++tick) {
      device->wait(0.001);
      const DeviceSample sample = device->read(0.001 * tick, 0.001);
      if (sample.connected && sample.fresh) ++places;
      device->write({0.0, 0.0, 1.0});
    }
    EXPECT_EQ(places, 20);
  }
  ::setenv("SPARSHA_HAPLY_PORT", std::to_string(emulated.client.port).c_str(), 1);
  ::setenv("SPARSHA_HAPLY_EVENTS_PORT", std::to_string(emulated.client.events_port).c_str(), 1);
  const auto found = haply_kind().find(DeviceRequest{});
  ::unsetenv("SPARSHA_HAPLY_PORT");
  ::unsetenv("SPARSHA_HAPLY_EVENTS_PORT");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].available);
  for (const emulator::HaplyMessage& message : emulated.log()) {
    if (message.to_client) continue;
    EXPECT_THAT(message.text, HasSubstr("probe_position"));
    EXPECT_EQ(message.text.find("force"), std::string::npos) << message.text;
    EXPECT_EQ(message.text.find("configure"), std::string::npos) << message.text;
  }
}

TEST(Haply, WithoutTheDampingThatItIsAskedForItsLimitsAreThoseOfLess) {
  emulator::HaplyOptions options;
  options.damps = false;
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  EXPECT_LT(device->info().limits.least_damping_n_s_per_m, 0.5 * haply_info().limits.least_damping_n_s_per_m);
  EXPECT_THAT(device->info().warning, HasSubstr("damping"));
  const Running run(*device);
  EXPECT_TRUE(eventually([&] { return emulated.service->strongest_n() > 0.1; }));
}

TEST(Haply, ADeviceThatLeavesAndComesBackIsFeltAgain) {
  emulator::HaplyOptions options = soon();
  options.disconnect = true;
  options.fault_after_s = 0.6;
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  const Running run(*device);
  ASSERT_TRUE(eventually([&] { return run.servo.unplugged(); }));
  EXPECT_EQ(emulated.service->force_n(), 0.0);
  ASSERT_TRUE(eventually([&] { return !run.servo.unplugged(); }));
  EXPECT_EQ(emulated.service->unsafe_commands(), 0U);
}

TEST(Haply, AServiceThatEndsIsLookedForAgain) {
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) GTEST_SKIP() << "five seconds, with SPARSHA_NIGHTLY=1";
  emulator::HaplyOptions options = soon();
  options.dies = true;
  options.fault_after_s = 0.8;
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  const Running run(*device);
  ASSERT_TRUE(eventually([&] { return run.servo.unplugged(); }));
  ASSERT_TRUE(eventually([&] { return !run.servo.unplugged() && (run.state.read().flags & kFlagArmed) != 0; }));
}

TEST(Haply, WhatIsNoMessageIsNoForce) {
  for (const bool framed : {true, false}) {
    emulator::HaplyOptions options = soon();
    options.malformed = framed;
    options.not_framed = !framed;
    Service emulated(options);
    const auto device = make_haply_device(emulated.client);
    const Running run(*device);
    ASSERT_TRUE(eventually([&] { return run.servo.unplugged(); })) << "it is not believed any more";
    EXPECT_TRUE(eventually([&] { return emulated.service->force_n() == 0.0; }));
    ASSERT_TRUE(eventually([&] { return !run.servo.unplugged(); })) << "connected anew";
  }
}

TEST(Haply, SilenceIsZeroForceAfterSevenMilliseconds) {
  emulator::HaplyOptions options = soon();
  options.silent = true;
  options.fault_s = 0.08;  // not yet a service that has ended
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  {
    const Running run(*device);
    ASSERT_TRUE(eventually([&] { return emulated.service->faulty(); }));
    ASSERT_TRUE(says(*device, "device_lift"));
  }
  // A command that got no answer is followed by others 7 ms later, and those are zero.
  const auto log = emulated.log();
  int unanswered = 0, judged = 0;
  for (const emulator::HaplyMessage& message : log) {
    const double n = asked_n(message);
    if (n < 0.0) {
      unanswered = 0;
      continue;
    }
    if (++unanswered < 2) continue;
    ++judged;
    EXPECT_EQ(n, 0.0) << unanswered << " commands after the last answer";
  }
  EXPECT_GT(judged, 2);
}

TEST(Haply, ForcesOfASecondClientEndOurs) {
  emulator::HaplyOptions options = soon();
  options.second_client = true;
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  const Running run(*device);
  ASSERT_TRUE(says(*device, "device_shared"));
  EXPECT_TRUE(eventually([&] { return (run.state.read().flags & kFlagHomed) == 0; }));
}

TEST(Haply, AGateThatTakesForceAwayIsSaidAndRecorded) {
  emulator::HaplyOptions options;
  options.gate = 0.6;
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  const Running run(*device);
  ASSERT_TRUE(says(*device, "device_changes_force"));
  EXPECT_TRUE(eventually([&] {
    const State state = run.state.read();
    return state.given_share > 0.5 && state.given_share < 0.7;
  }));
}

TEST(Haply, SettingsThatCannotBeReadBackAreNoForce) {
  emulator::HaplyOptions options;
  options.keeps_settings = true;
  expect_no_force_from(options);
}

TEST(Haply, AnOlderServiceIsTouchedWithTheWordsItKnowsAndTheMissingEventsAreSaid) {
  emulator::HaplyOptions options;
  options.version_3_1 = true;
  Service emulated(options);
  emulated.client.events_port = 1;  // nobody listens there
  const auto device = make_haply_device(emulated.client);
  EXPECT_THAT(device->info().warning, HasSubstr("no emergency brake"));
  const Running run(*device);
  EXPECT_TRUE(eventually([&] { return emulated.service->strongest_n() > 0.3; }));
}

TEST(Haply, SplitMessagesAreFeltLikeOthersAndAnswersThatWaitForTheNextAreReadWithoutForce) {
  for (const bool split : {true, false}) {
    emulator::HaplyOptions options;
    options.split = split;
    options.merged = !split;
    options.tick_s = 0.05;  // of the merged ones every second asks
    Service emulated(options);
    const auto device = make_haply_device(emulated.client);
    if (split) {
      const Running run(*device);
      EXPECT_TRUE(eventually([&] { return emulated.service->strongest_n() > 0.3; }));
    } else {
      const Running run(*device);
      EXPECT_TRUE(eventually([&] { return emulated.service->commands() > 300; })) << "asked again where none came";
      EXPECT_FALSE(run.servo.unplugged());
      EXPECT_EQ(device->advice() == nullptr ? "" : std::string(device->advice()->phrase), "device_lift")
          << "it is set up";
      EXPECT_EQ(emulated.service->strongest_n(), 0.0) << "a place comes with the next question, and is late";
    }
  }
}

TEST(Haply, OneOfSeveralIsTakenAndOneThatIsNotThereIsAnError) {
  emulator::HaplyOptions options;
  options.devices = 2;
  Service emulated(options);
  EXPECT_THAT(make_haply_device(emulated.client)->info().warning, HasSubstr("there are 2 Inverse3"));
  emulated.client.device_id = "EMU9";
  EXPECT_THROW(static_cast<void>(make_haply_device(emulated.client)), Error);
  HaplyOptions nobody;
  nobody.port = 1;
  try {
    static_cast<void>(make_haply_device(nobody));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::device);
    EXPECT_THAT(error.expected(), HasSubstr("Inverse Service"));
  }
}

TEST(Haply, ItConforms) {
  Service emulated;
  const std::shared_ptr<Device> device = make_haply_device(emulated.client);
  ConformanceOptions options;
  options.watch_s = 0.5;
  options.patience_s = 0.3;
  const auto watched = watch_device(device, options);
  for (const ConformanceStep& step : watched)
    EXPECT_EQ(step.result, ConformanceStep::Result::passed) << step.name << ": " << step.found;
  EXPECT_THAT(watched.front().found, HasSubstr("100 mm, 4.0 N"));
  options.faults = {Fault::stopped};
  for (const ConformanceStep& step : try_faults(*device, options))
    EXPECT_EQ(step.result, ConformanceStep::Result::passed) << step.name << ": " << step.found << step.to_a_hand;
}

}  // namespace
}  // namespace sparsha::haptics::haply
