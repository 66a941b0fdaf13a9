// What a run's summary says of trouble.
#include "app/exploration/run_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace sparsha::app {
namespace {
using ::testing::HasSubstr;
using ::testing::Not;

TEST(RunSummary, SaysWhoTookTheForceAwayWhenTheServoPaused) {
  haptics::SessionSummary summary;
  EXPECT_THAT(summary_text(summary, 0), Not(HasSubstr("pauses")));
  summary.late_faults = 3;
  EXPECT_THAT(summary_text(summary, 0),
              HasSubstr("pauses    3 over 10 ms took the force away: 0 seen by the watchdog, 3 by the servo itself\n"));
  summary.watchdog_trips = 4;
  EXPECT_THAT(summary_text(summary, 0),
              HasSubstr("pauses    7 over 10 ms took the force away: 4 seen by the watchdog"));
  const auto json = nlohmann::json::parse(summary_json(summary, 0));
  EXPECT_EQ(json["late_faults"], 3);
  EXPECT_EQ(json["watchdog_trips"], 4);
}

TEST(RunSummary, NamesADeviceThatRunsAwayAndAHandThatJumps) {
  haptics::SessionSummary summary;
  EXPECT_THAT(summary_text(summary, 0), Not(HasSubstr("too soon")));
  EXPECT_THAT(summary_text(summary, 0), Not(HasSubstr("jumps")));
  summary.runaways = 8000;
  summary.jumps = 2;
  EXPECT_THAT(summary_text(summary, 0), HasSubstr("too soon  8000 ticks without force"));
  EXPECT_THAT(summary_text(summary, 0), HasSubstr("jumps     2 positions"));
  const auto json = nlohmann::json::parse(summary_json(summary, 0));
  EXPECT_EQ(json["runaways"], 8000);
  EXPECT_EQ(json["jumps"], 2);
}

}  // namespace
}  // namespace sparsha::app
