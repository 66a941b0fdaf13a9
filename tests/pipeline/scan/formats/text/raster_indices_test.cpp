// Tables without names whose first two columns count along a grid, and others that look like them. The tables are
// written with their true coordinates; grids of several programs' orders.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "pipeline/scan/reader.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

struct Grid {
  int rows = 20;
  int columns = 30;
  int first_row = 0;
  int first_column = 0;
  bool by_columns = false;  ///< the row number changes from point to point
  bool column_first = false;
  bool back_and_forth = false;
  int holes = 0;  ///< each of how many places has no row
  std::string separator = " ";
  std::string behind;
};

/// What a camera above a bumpy plane measures at a place of the grid.
Eigen::Vector3d point_of(int row, int column) {
  return {0.731 * column - 11.0417, 7.3081 - 0.729 * row, 2.0013 + 0.31 * std::sin(0.8 * row) * std::cos(0.3 * column)};
}

std::string table_of(const Grid& grid, std::vector<Eigen::Vector3d>& points) {
  std::string text;
  const int slow = grid.by_columns ? grid.columns : grid.rows;
  const int fast = grid.by_columns ? grid.rows : grid.columns;
  for (int s = 0; s < slow; ++s) {
    for (int k = 0; k < fast; ++k) {
      const int f = grid.back_and_forth && s % 2 != 0 ? fast - 1 - k : k;
      const int row = grid.by_columns ? f : s;
      const int column = grid.by_columns ? s : f;
      if (grid.holes > 0 && (7 * row + 3 * column) % grid.holes == 0) continue;
      const Eigen::Vector3d p = point_of(row, column);
      int numbers[2] = {grid.first_row + row, grid.first_column + column};
      if (grid.column_first) std::swap(numbers[0], numbers[1]);
      const std::string& c = grid.separator;
      const std::string at = fmt::format("{:.4f}{}{:.4f}{}{:.4f}", p.x(), c, p.y(), c, p.z());
      text += fmt::format("{}{}{}{}{}{}\n", numbers[0], c, numbers[1], c, at, grid.behind);
      points.emplace_back(std::stod(fmt::format("{:.4f}", p.x())), std::stod(fmt::format("{:.4f}", p.y())),
                          std::stod(fmt::format("{:.4f}", p.z())));
    }
  }
  return text;
}

TEST(RasterIndices, InFrontOfUnnamedCoordinatesAreNotTakenAsXAndY) {
  std::vector<Grid> grids(10);
  grids[1].by_columns = true;
  grids[2].column_first = true;
  grids[3].by_columns = grids[3].column_first = true;
  grids[4].back_and_forth = true;
  grids[5].holes = 3;
  grids[6].separator = ",";
  grids[6].first_row = grids[6].first_column = 1;
  grids[7].separator = ";";
  grids[7].first_row = 412;
  grids[7].first_column = 1033;
  grids[8].columns = 1500;  // the first thousand rows lie in one line of the grid
  grids[8].rows = 6;
  grids[9].separator = "\t";
  grids[9].columns = 12;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    std::vector<Eigen::Vector3d> points;
    const RawScan scan = read_scan_bytes(table_of(grids[k], points), "a.txt");
    EXPECT_EQ(scan.points, points) << k;
    ASSERT_TRUE(scan.table) << k;
    EXPECT_EQ(scan.table->by, TextTable::By::shape) << k;
    EXPECT_THAT(scan.table->columns, ElementsAre("skip", "skip", "x", "y", "z")) << k;
    EXPECT_THAT(scan.warnings, ::testing::Contains(AllOf(HasSubstr("count along the rows and columns"),
                                                         HasSubstr("columns 3, 4 and 5"), HasSubstr("'columns'"))))
        << k;
  }
}

TEST(RasterIndices, LeaveWhatStandsBehindTheCoordinatesAsItIs) {
  const std::pair<const char*, std::vector<std::string>> tails[] = {
      {" 117", {"intensity"}},
      {" 10 20 30", {"red", "green", "blue"}},
      {" 0.25 10 20 30", {"intensity", "red", "green", "blue"}},
  };
  for (const auto& [behind, words] : tails) {
    Grid grid;
    grid.behind = behind;
    std::vector<Eigen::Vector3d> points;
    const RawScan scan = read_scan_bytes(table_of(grid, points), "a.txt");
    EXPECT_EQ(scan.points, points) << behind;
    ASSERT_TRUE(scan.table);
    std::vector<std::string> wanted = {"skip", "skip", "x", "y", "z"};
    wanted.insert(wanted.end(), words.begin(), words.end());
    EXPECT_EQ(scan.table->columns, wanted) << behind;
  }
}

TEST(RasterIndices, HeightFieldsOfWholeXAndYStayWhatTheyAre) {
  const auto height = [](int i, int j) { return 0.31 * std::sin(0.8 * i) * std::cos(0.3 * j) + 0.02 * j + 0.003; };
  const auto noise = [](int i, int j) { return (i * 7919 + j * 104729) % 1009 / 1009.0; };
  const std::function<std::string(int, int)> tails[] = {
      [](int i, int j) { return fmt::format(" {:.4f} {:.4f}", (i + 0.5) / 20, (j + 0.5) / 30); },  // in a picture
      [&](int i, int j) { return fmt::format(" {:.4f} {:.4f}", noise(i, j), noise(j, i)); },       // measures
      [&](int i, int j) { return fmt::format(" {:.4f} {:.4f}", 0.5 + 0.5 * std::sin(i), noise(i, j)); },
      [&](int i, int j) {  // unit vectors
        const Eigen::Vector3d n = Eigen::Vector3d(std::cos(i), std::sin(0.3 * j), 3.0).normalized();
        return fmt::format(" {:.6f} {:.6f} {:.6f}", n.x(), n.y(), n.z());
      },
      [](int, int) { return std::string(" 120 90 60"); },
  };
  for (std::size_t k = 0; k < std::size(tails); ++k) {
    std::string text;
    for (int i = 0; i < 20; ++i)
      for (int j = 0; j < 30; ++j) text += fmt::format("{} {} {:.4f}{}\n", i, j, height(i, j), tails[k](i, j));
    const RawScan scan = read_scan_bytes(text, "a.txt");
    ASSERT_TRUE(scan.table);
    EXPECT_EQ(scan.table->by, TextTable::By::position) << k;
    EXPECT_EQ(scan.points[31].x(), 1.0) << k;
    EXPECT_EQ(scan.points[31].y(), 1.0) << k;
  }
}

TEST(RasterIndices, WhichOneRowFarDownContradictsAreOnlySaid) {
  Grid grid;
  grid.rows = 60;
  std::vector<Eigen::Vector3d> points;
  std::string text = table_of(grid, points);
  text += "3 3 1.5 2.5 3.5\n";
  const RawScan scan = read_scan_bytes(text, "a.txt");
  EXPECT_EQ(scan.table->by, TextTable::By::position);
  EXPECT_THAT(scan.warnings, ::testing::Contains(HasSubstr("the first two columns hold whole numbers")));
  EXPECT_THAT(scan.warnings, Not(::testing::Contains(HasSubstr("count along"))));
}

}  // namespace
}  // namespace sparsha::pipeline
