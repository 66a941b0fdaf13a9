// The race's part of the page says what was measured.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "bench/race/report.h"
#include "tests/support/test_folder.h"

namespace sparsha::bench {
namespace {

TEST(RaceReport, ItsConfidenceIsThatOfItsRepeats) {
  const test::TestFolder folder;
  const auto page = [&](int repeats) {
    Report report;
    report.repeats = repeats;
    EXPECT_TRUE(write_report(folder, report));
    std::ifstream file(folder / "race.part.html");
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  // Five fair coins fall alike with probability 2/32, seven with 2/128.
  EXPECT_NE(page(5).find("with a probability of 94 %."), std::string::npos);
  EXPECT_NE(page(5).find("5 times each"), std::string::npos);
  EXPECT_NE(page(7).find("with a probability of 98 %."), std::string::npos);
}

TEST(RaceReport, AnglesAreWrittenInDegreesWithoutPowersOfTen) {
  const test::TestFolder folder;
  Report report;
  Row row;
  row.group = "front";
  row.angle_median_deg = 0.123;
  row.angle_p99_deg = 180.0;
  report.rows = {row};
  EXPECT_TRUE(write_report(folder, report));
  std::ifstream file(folder / "race.part.html");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(page.find("0.12° / 180°"), std::string::npos);
}

}  // namespace
}  // namespace sparsha::bench
