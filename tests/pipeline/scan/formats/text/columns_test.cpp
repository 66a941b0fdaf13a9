// Which column of a text table is what: told by the configuration, by names, or by their places.
#include <gmock/gmock.h>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::ScanFolder;

TEST(TextTable, SaysWhatToldItsColumns) {
  const RawScan by_position = read_scan_bytes("1 2 3 10 20 30\n1 2 4 1 2 3\n", "a.xyz");
  ASSERT_TRUE(by_position.table);
  EXPECT_EQ(by_position.table->by, TextTable::By::position);
  EXPECT_THAT(by_position.table->columns, ElementsAre("x", "y", "z", "red", "green", "blue"));
  const RawScan by_names = read_scan_bytes("id,z,y,x\n1,2,3,4\n", "a.csv");
  ASSERT_TRUE(by_names.table);
  EXPECT_EQ(by_names.table->by, TextTable::By::names);
  EXPECT_THAT(by_names.table->columns, ElementsAre("skip", "z", "y", "x"));
  EXPECT_FALSE(read_scan_bytes("v 1 2 3\nv 4 5 6\n", "a.obj").table);
}

TEST(TextTable, TakesTheColumnsOfTheConfiguration) {
  const ReadOptions options{{"skip", "x", "y", "z", "skip", "red", "green", "blue"}};
  const RawScan scan = read_scan_bytes("7 1 2 3 9 10 20 30\n8 4 5 6 9 1 2 3\n", "a.txt", options);
  EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
  EXPECT_THAT(scan.rgba, ElementsAre(0xFF1E140AU, 0xFF030201U));
  ASSERT_TRUE(scan.table);
  EXPECT_EQ(scan.table->by, TextTable::By::configuration);
  EXPECT_EQ(scan.table->columns, options.columns);
}

TEST(TextTable, OfWhichColumnsAreNamedMustBeOne) {
  const ReadOptions options{{"skip", "x", "y", "z"}};
  try {
    (void)read_scan_bytes("v 1 2 3\nv 4 5 6\n", "a.obj", options);
    FAIL() << "columns of an OBJ file";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), HasSubstr("no text table: OBJ"));
  }
}

}  // namespace
}  // namespace sparsha::pipeline
