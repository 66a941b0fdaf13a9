// What is said while there is no Falcon, by what keeps it away.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "haptics/device/falcon/keeper.h"
#include "tests/support/emulated_falcon.h"

namespace {

using namespace sparsha::haptics;
using namespace sparsha::haptics::falcon;
using namespace sparsha::test;

/// The phrases that a keeper gives, each change once, until it has tried to open `tries` times. The first may be that
/// firmware is loaded, which takes no time here: it is left out.
std::vector<std::string> advices(const std::function<std::unique_ptr<Transport>(OpenProblem&)>& open,
                                 std::vector<std::uint8_t> image, int tries) {
  std::atomic<int> opened{0};
  Keeper keeper(
      [&](OpenProblem& problem) {
        ++opened;
        return open(problem);
      },
      std::move(image));
  keeper.give_back(nullptr);
  std::vector<std::string> phrases;
  const DeviceAdvice* told = nullptr;
  while (opened.load() < tries) {
    if (const DeviceAdvice* const now = keeper.advice(); now != told) {
      told = now;
      const bool loads = now != nullptr && phrases.empty() && std::string_view(now->phrase) == "device_gets_firmware";
      if (now != nullptr && !loads) phrases.emplace_back(now->phrase);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return phrases;
}

using Phrases = std::vector<std::string>;

TEST(Keeper, SaysWhatKeepsTheFalconAway) {
  const auto phrases_of = [](OpenProblem why) {
    return advices(
        [why](OpenProblem& problem) {
          problem = why;
          return std::unique_ptr<Transport>();
        },
        {}, 2);
  };
  EXPECT_EQ(phrases_of(OpenProblem::absent), (Phrases{"device_plug_in"}));
  EXPECT_EQ(phrases_of(OpenProblem::not_permitted), (Phrases{"device_not_permitted"}));
  EXPECT_EQ(phrases_of(OpenProblem::busy), (Phrases{"device_busy"}));
}

TEST(Keeper, SaysOnceThatAFalconDoesNotStartHoweverOftenItTries) {
  EmulatorOptions options;
  options.firmware_loaded = options.powered = false;
  const EmulatedFalcon falcon(options);
  const auto open = [&falcon](OpenProblem& problem) {
    problem = OpenProblem::none;
    return make_wire(falcon, Clock::virtual_time);
  };
  EXPECT_EQ(advices(open, std::vector<std::uint8_t>(4096), 4), (Phrases{"device_does_not_start"}));
  EXPECT_EQ(advices(open, {}, 4), (Phrases{"device_does_not_start"})) << "without power no firmware would help";
}

TEST(Keeper, AsksForFirmwareWhereTheBootLoaderAnswers) {
  EmulatorOptions options;
  options.firmware_loaded = false;
  const EmulatedFalcon falcon(options);
  const auto open = [&falcon](OpenProblem& problem) {
    problem = OpenProblem::none;
    return make_wire(falcon, Clock::virtual_time);
  };
  EXPECT_EQ(advices(open, {}, 4), (Phrases{"device_needs_firmware"}));
}

}  // namespace
