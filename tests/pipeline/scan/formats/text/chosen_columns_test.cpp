// Columns of a text table that the configuration names.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "pipeline/scan/set.h"
#include "scene/config/config.h"
#include "tests/pipeline/scan/formats/text/relief_table.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::expect_refused;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ScanFolder;

TEST(TextTable, TakesTheColumnsOfTheConfiguration) {
  const ReadOptions options{{"skip", "x", "y", "z", "skip", "red", "green", "blue"}};
  const RawScan scan = read("7 1 2 3 9 10 20 30\n8 4 5 6 9 1 2 3\n", "a.txt", options);
  EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
  EXPECT_THAT(scan.rgba, ElementsAre(0xFF1E140AU, 0xFF030201U));
  EXPECT_THAT(scan.fields, ElementsAre("column 1", "x", "y", "z", "column 5", "red", "green", "blue"));
  EXPECT_THAT(scan.warnings, IsEmpty());
  ASSERT_TRUE(scan.table);
  EXPECT_EQ(scan.table->by, TextTable::By::configuration);
  EXPECT_EQ(scan.table->columns, options.columns);
}

TEST(TextTable, ColumnsOfTheConfigurationMayStandBehindNamesAndTitles) {
  const Relief relief;
  const ReadOptions options{{"skip", "z", "x", "y"}};
  const auto row = [&](std::size_t k) { return fmt::format("P {},{},STN 4", k, relief.at(k, ",", "zxy")); };
  expect_relief(relief, relief.table("", row), "a.csv", options);
  expect_relief(relief, relief.table("Name,A,B,C\nfrom 12 3 2019\n", row), "a.csv", options);
  // Without them such a file is refused, and the remedy is named.
  expect_refused("a.csv", relief.table("", row), "'columns' of the scan", 1);
}

TEST(TextTable, OfWhichColumnsAreNamedMustBeOneWithThatManyColumns) {
  const auto error_of = [](const std::string& text, const std::string& name, const ReadOptions& options) {
    try {
      (void)read_scan_bytes(text, name, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(error_of("v 1 2 3\nv 4 5 6\n", "a.obj", {{"skip", "x", "y", "z"}}), HasSubstr("no text table: OBJ"));
  EXPECT_THAT(error_of("1 2 3 4\n1 2 3\n", "a.txt", {{"x", "y", "z", "intensity"}}),
              HasSubstr("a.txt:2: error: a row of 3 values; 4 values, as 'columns'"));
  EXPECT_THAT(error_of("1 2 3\n4 5 6\n", "a.txt", {{"skip", "x", "y", "z"}}), HasSubstr("a.txt:1: error: a row of 3"));
  EXPECT_THAT(error_of("1 a 3 4\n", "a.txt", {{"skip", "x", "y", "z"}}), HasSubstr("'a' is not a number"));
}

TEST(TextTable, WhoseHeaderContradictsTheConfigurationIsReadAsThatSaysWithAWarning) {
  const ReadOptions options{{"skip", "x", "y", "z"}};
  const RawScan other = read("x,y,z,w\n7,1,2,3\n", "a.csv", options);
  EXPECT_THAT(other.points, ElementsAre(Eigen::Vector3d(1, 2, 3)));
  EXPECT_THAT(other.warnings, ElementsAre(AllOf(HasSubstr("'y' as x"), HasSubstr("'z' as y"), HasSubstr("'w' as z"))));
  EXPECT_THAT(read("id,x,y,z\n7,1,2,3\n", "a.csv", options).warnings, IsEmpty());
  EXPECT_EQ(read("id,x [mm],y [mm],z [mm]\n7,1,2,3\n", "a.csv", options).unit, scene::LengthUnit::mm);
}

TEST(TextTable, ColumnsOfTheConfigurationHoldInMemoryStreamedAndInSets) {
  const Relief relief;
  const ScanFolder folder;
  scene::ScanConfig config;
  config.file = folder.write("a.txt", relief.table("", [&](std::size_t k) {
    return fmt::format("0.{:03} {} 1 2 3", k, relief.at(k, " ", "zxy"));
  }));
  config.columns = {"skip", "z", "x", "y", "red", "green", "blue"};
  std::vector<Eigen::Vector3d> streamed;
  const RawScan rest = stream_scan(
      config.file,
      [&](const PointBlock& block) { streamed.insert(streamed.end(), block.points.begin(), block.points.end()); },
      nullptr, {config.columns});
  EXPECT_EQ(streamed, relief.points);
  EXPECT_EQ(rest.table->by, TextTable::By::configuration);
  Progress progress;
  for (const auto keep : {ScanSet::Keep::quickest, ScanSet::Keep::disk}) {
    ScanSet set({config}, keep, false, progress);
    EXPECT_TRUE(set.has_colour());
    std::size_t count = 0;
    set.stream(
        [&](const CloudBlock& block) {
          for (const Eigen::Vector3f& p : block.points) {
            const Eigen::Vector3d place = p.cast<double>() + set.origin_m();
            EXPECT_LT((place - relief.points[count++]).cwiseAbs().maxCoeff(), 1e-7);  // float32 near zero
          }
        },
        progress);
    EXPECT_EQ(count, relief.points.size());
    EXPECT_EQ(set.load(set.origin_m(), progress).size(), relief.points.size());
  }
}

}  // namespace
}  // namespace sparsha::pipeline
