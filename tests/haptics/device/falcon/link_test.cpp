// Bringing an emulated Falcon to life, and what is said when it does not come.
#include "haptics/device/falcon/link.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "base/error.h"
#include "haptics/device/falcon/check.h"
#include "tests/support/emulated_falcon.h"
#include "tests/support/test_folder.h"

namespace {

using namespace sparsha;
using namespace sparsha::haptics::falcon;
using namespace sparsha::test;

/// Not a firmware: random bytes, which is all that the wire cares about.
std::vector<std::uint8_t> image() {
  std::mt19937 random(9);
  std::vector<std::uint8_t> bytes(7777);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

struct Bench {
  std::shared_ptr<EmulatedFalcon> emulator;
  std::unique_ptr<Transport> wire;
  explicit Bench(const EmulatorOptions& options)
      : emulator(std::make_shared<EmulatedFalcon>(options)), wire(make_wire(*emulator, Clock::virtual_time)) {}
};

EmulatorOptions bare() {
  EmulatorOptions options;
  options.firmware_loaded = false;
  return options;
}

std::string reason(const std::function<void()>& action, ErrorKind kind = ErrorKind::device) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    EXPECT_FALSE(error.expected().empty());
    return error.what();
  }
  return "";
}

TEST(FalconLink, RunningFirmwareIsRecognisedAndLeftAlone) {
  Bench bench{EmulatorOptions{}};
  bring_up(*bench.wire, image());
  EXPECT_TRUE(bench.emulator->device->uploaded().empty());
}

TEST(FalconLink, TheTimerIsLongWhereNoAnswerWaitsForItAndAMillisecondWhereAnswersDo) {
  for (const bool heeds : {true, false}) {
    EmulatorOptions options;
    options.heeds_event_character = heeds;
    Bench bench{options};
    bring_up(*bench.wire, image());
    EXPECT_EQ(bench.emulator->device->latency_ms(), heeds ? 4 : 1);
    // Nothing of before is taken for the answer to what is asked next.
    AnswerStream stream;
    Answer answer;
    EXPECT_TRUE(exchange(*bench.wire, stream, encode({}, 0), answer, 1));
    const CheckReport report = check_wire(*bench.wire, {}, 0.05);
    EXPECT_EQ(report.link.answered, report.link.asked);
    EXPECT_EQ(bench.emulator->device->latency_ms(), heeds ? 4 : 1);
  }
}

TEST(FalconLink, ABridgeThatLosesAnswersKeepsTheShortTimer) {
  EmulatorOptions options;
  options.lose_every = 3;
  Bench bench{options};
  bring_up(*bench.wire, image());
  EXPECT_EQ(bench.emulator->device->latency_ms(), 1);
}

TEST(FalconLink, FirmwareIsLoadedToTheByteWhenNoneRuns) {
  Bench bench(bare());
  double last = 0.0;
  bring_up(*bench.wire, image(), 1, [&last](double share) {
    EXPECT_GE(share, last);
    last = share;
  });
  EXPECT_EQ(bench.emulator->device->uploaded(), image());
  EXPECT_TRUE(bench.emulator->device->firmware_loaded());
  EXPECT_DOUBLE_EQ(last, 1.0);
}

TEST(FalconLink, ACorruptedEchoIsAFailedAttemptAndTheNextSucceeds) {
  EmulatorOptions options = bare();
  options.corrupt_echo_byte = 2600;
  Bench once(options);
  EXPECT_NE(reason([&] { bring_up(*once.wire, image(), 1); }).find("echo differs"), std::string::npos);
  Bench twice(options);
  bring_up(*twice.wire, image(), 2);
  EXPECT_TRUE(twice.emulator->device->firmware_loaded());
}

TEST(FalconLink, ADeafBootLoaderIsGreetedAgain) {
  EmulatorOptions options = bare();
  options.deaf_handshakes = 20;
  Bench bench(options);
  bring_up(*bench.wire, image(), 1);
  EXPECT_TRUE(bench.emulator->device->firmware_loaded());
}

TEST(FalconLink, WithoutPowerTheRemedyNamesThePowerSupply) {
  EmulatorOptions options = bare();
  options.powered = false;
  Bench bench(options);
  EXPECT_NE(reason([&] { bring_up(*bench.wire, image(), 2); }).find("power supply"), std::string::npos);
}

TEST(FalconLink, WithoutAnImageTheRemedyNamesTheVariable) {
  Bench bench(bare());
  EXPECT_NE(reason([&] { bring_up(*bench.wire, {}); }).find("SPARSHA_FALCON_FIRMWARE"), std::string::npos);
}

TEST(FalconLink, TheImageIsTheOptionsElseTheVariablesElseTheOneInTheUsersConfiguration) {
  const auto folder = std::filesystem::temp_directory_path() / ("falcon-config-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder / "sparsha");
  const auto make = [](const std::filesystem::path& file, char letter) {
    std::ofstream(file) << std::string(2000, letter);
  };
  make(folder / "sparsha" / "falcon.bin", 'c');
  make(folder / "variable.bin", 'v');
  make(folder / "option.bin", 'o');
  setenv("XDG_CONFIG_HOME", folder.c_str(), 1);
  unsetenv("SPARSHA_FALCON_FIRMWARE");
  FalconOptions options;
  EXPECT_EQ(firmware_image(options).front(), 'c');
  setenv("SPARSHA_FALCON_FIRMWARE", (folder / "variable.bin").c_str(), 1);
  EXPECT_EQ(firmware_image(options).front(), 'v');
  options.firmware = folder / "option.bin";
  EXPECT_EQ(firmware_image(options).front(), 'o');
  unsetenv("SPARSHA_FALCON_FIRMWARE");
  setenv("XDG_CONFIG_HOME", (folder / "none").c_str(), 1);
  EXPECT_TRUE(firmware_image({}).empty());
  unsetenv("XDG_CONFIG_HOME");
  std::filesystem::remove_all(folder);
}

TEST(FalconLink, UnpluggingIsAnErrorNotAHang) {
  Bench bench(bare());
  bench.emulator->device->unplug(true, 0.0);
  EXPECT_NE(reason([&] { bring_up(*bench.wire, image()); }), "");
}

TEST(FalconLink, AnImageOfImpossibleSizeIsRefused) {
  const auto file = std::filesystem::temp_directory_path() / ("falcon-image-" + std::to_string(getpid()));
  std::ofstream(file) << "short";
  EXPECT_NE(reason([&] { static_cast<void>(read_firmware(file)); }).find("not a Falcon firmware"), std::string::npos);
  std::filesystem::remove(file);
  EXPECT_NE(reason([&] { static_cast<void>(read_firmware(file)); }).find("cannot read"), std::string::npos);
}

CheckStep::Result result(const CheckReport& report, const std::string& name) {
  for (const CheckStep& step : report.steps)
    if (step.name == name) return step.result;
  ADD_FAILURE() << "no step " << name;
  return CheckStep::Result::skipped;
}

using Result = CheckStep::Result;

TEST(FalconCheck, AHealthyHomedDevicePassesEveryStep) {
  EmulatorOptions options;
  options.homed = true;
  Bench bench(options);
  const CheckReport report = check_wire(*bench.wire, {}, 0.05);
  for (const CheckStep& step : report.steps) EXPECT_EQ(step.result, Result::passed) << step.name << ": " << step.detail;
  EXPECT_TRUE(report.passed());
  EXPECT_EQ(bench.emulator->command(), MotorCommand{});
}

TEST(FalconCheck, EveryFailedStepHasARemedyAndWhatNeedsItIsSkipped) {
  EmulatorOptions dead = bare();
  dead.powered = false;
  Bench unpowered(dead);
  const CheckReport power = check_wire(*unpowered.wire, {}, 0.05);
  EXPECT_EQ(result(power, "power"), Result::failed);
  EXPECT_EQ(result(power, "firmware"), Result::skipped);
  EXPECT_EQ(result(power, "link"), Result::skipped);

  Bench empty(bare());
  const CheckReport firmware = check_wire(*empty.wire, {}, 0.05);
  EXPECT_EQ(result(firmware, "power"), Result::passed);
  EXPECT_EQ(result(firmware, "firmware"), Result::failed);

  Bench lost{EmulatorOptions{}};
  const CheckReport homing = check_wire(*lost.wire, {}, 0.05);
  EXPECT_EQ(result(homing, "homing"), Result::failed);
  EXPECT_EQ(result(homing, "link"), Result::passed);

  EmulatorOptions leaky;
  leaky.homed = true;
  leaky.lose_every = 10;
  Bench bad(leaky);
  EXPECT_EQ(result(check_wire(*bad.wire, {}, 0.05), "link"), Result::failed);

  for (const CheckReport& report : {power, firmware, homing})
    for (const CheckStep& step : report.steps)
      if (step.result == Result::failed) {
        EXPECT_FALSE(step.remedy.empty()) << step.name;
      }
}

TEST(FalconCheck, WhatIsWrongWithAnImageIsNoFaultOfThePower) {
  const sparsha::test::TestFolder folder;
  FalconOptions options;
  options.firmware = folder.path() / "short.bin";
  std::ofstream(options.firmware) << "short";
  Bench truncated(bare());
  const CheckReport report = check_wire(*truncated.wire, options, 0.05);
  EXPECT_EQ(result(report, "power"), Result::passed);
  EXPECT_EQ(result(report, "firmware"), Result::failed);
  EXPECT_NE(report.steps[1].detail.find("short.bin"), std::string::npos) << report.steps[1].detail;

  EmulatorOptions never_runs = bare();
  never_runs.failed_loads = 1000;
  Bench wrong(never_runs);
  const std::vector<std::uint8_t> bytes = image();
  std::ofstream(options.firmware, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const CheckReport unused = check_wire(*wrong.wire, options, 0.05);
  EXPECT_EQ(result(unused, "power"), Result::passed);
  EXPECT_EQ(result(unused, "firmware"), Result::failed);
  EXPECT_EQ(result(unused, "homing"), Result::skipped);
  EXPECT_EQ(result(unused, "link"), Result::skipped);
}

TEST(FalconCheck, UnpluggedWhileTheLinkIsMeasuredIsNamedSo) {
  Bench bench{EmulatorOptions{}};
  FalconOptions options;
  int asked = 0;
  options.stop = [&] {
    if (++asked == 10) bench.emulator->device->unplug(true, 0.0);
    return false;
  };
  const CheckReport report = check_wire(*bench.wire, options, 3600.0);
  EXPECT_EQ(result(report, "homing"), Result::skipped) << "nobody knows";
  EXPECT_EQ(result(report, "link"), Result::failed);
  EXPECT_EQ(report.verdict.grade, LinkVerdict::Grade::insufficient);
  EXPECT_NE(report.verdict.reason.find("unplugged"), std::string::npos) << report.verdict.reason;
}

TEST(FalconFirmware, AnEmptyHomeIsNoFolder) {
  const char* const home = std::getenv("HOME");
  const std::string kept = home == nullptr ? "" : home;
  ::unsetenv("XDG_CONFIG_HOME");
  ::setenv("HOME", "", 1);
  EXPECT_TRUE(own_firmware().empty()) << own_firmware() << " in whatever folder this runs";
  ::setenv("HOME", kept.c_str(), 1);
}

TEST(FalconFirmware, UnpluggedWhileLoadingIsNamedSoAndNotTriedAgain) {
  Bench bench(bare());
  int looks = 0;
  const auto unplug = [&](double) {
    if (++looks == 20) bench.emulator->device->unplug(true, 0.0);
  };
  const std::string why = reason([&] { bring_up(*bench.wire, image(), 10, unplug); });
  EXPECT_NE(why.find("unplugged"), std::string::npos) << why;
  EXPECT_EQ(why.find("attempts"), std::string::npos) << why;
  EXPECT_EQ(looks, 20);
}

TEST(FalconCheck, JudgesALinkByItsRateItsLossesAndItsLateAnswersAndNamesTheRemedyOfEach) {
  using Grade = LinkVerdict::Grade;
  struct Case {
    LinkQuality link;
    Grade grade;
    const char* remedy;
  };
  // Ten seconds: asked, answered, answers a second, p50, p99, most.
  const std::vector<Case> cases = {
      {{9900, 9900, 990.0, 1.0, 1.2, 3.0}, Grade::good, ""},
      {{9900, 9895, 989.0, 1.0, 1.3, 3.9}, Grade::good, ""},
      {{9600, 9560, 956.0, 1.0, 1.4, 3.9}, Grade::marginal, "cable"},
      {{9000, 8500, 850.0, 1.0, 2.0, 3.9}, Grade::insufficient, "cable"},
      {{9500, 9495, 949.0, 1.0, 3.1, 3.9}, Grade::marginal, "real-time"},
      {{5000, 5000, 500.0, 2.0, 2.0, 2.5}, Grade::marginal, "direct USB port"},
      {{4000, 4000, 400.0, 2.0, 2.0, 2.5}, Grade::insufficient, "direct USB port"},
      {{620, 620, 62.0, 16.0, 16.1, 17.0}, Grade::insufficient, "latency timer"},
      {{2500, 0, 0.0, 0.0, 0.0, 0.0}, Grade::insufficient, "power"},
      {{0, 0, 0.0, 0.0, 0.0, 0.0}, Grade::insufficient, "power"},
  };
  for (const Case& expected : cases) {
    const LinkVerdict verdict = judge(expected.link);
    EXPECT_EQ(name_of(verdict.grade), std::string(name_of(expected.grade))) << expected.link.rate_hz;
    EXPECT_NE(verdict.remedy.find(expected.remedy), std::string::npos) << verdict.remedy;
    EXPECT_EQ(verdict.remedy.empty(), expected.grade == Grade::good);
    EXPECT_EQ(verdict.reason.empty(), expected.grade == Grade::good);
  }
}

TEST(FalconCheck, TheMeasurementOfTheLinkEndsWhenAsked) {
  Bench bench{EmulatorOptions{}};
  bring_up(*bench.wire, {});
  FalconOptions options;
  int asked = 0;
  options.stop = [&asked] { return ++asked > 20; };
  const CheckReport report = check_wire(*bench.wire, options, 3600.0);
  EXPECT_EQ(report.link.asked, 20U) << "and what was measured is judged";
  EXPECT_EQ(report.steps.size(), 4U);
}

TEST(FalconFirmware, LoadingIsToldOnceAndEndsWhenAskedInsteadOfTryingAgain) {
  EmulatorOptions emulated;
  emulated.firmware_loaded = false;
  emulated.failed_loads = 100;
  Bench bench(emulated);
  FalconOptions options;
  int told = 0, looks = 0;
  options.say = [&told](const std::string&) { ++told; };
  options.stop = [&looks] { return ++looks > 200; };
  EXPECT_THROW(bring_up(*bench.wire, image(), 1000, loading(options)), sparsha::Cancelled);
  EXPECT_EQ(told, 1);
  EXPECT_EQ(looks, 201);
}

}  // namespace
