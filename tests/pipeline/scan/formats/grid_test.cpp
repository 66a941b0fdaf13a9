// ESRI's and Surfer's grids in text: the same heights in every form that programs write, holes that stay holes, and
// damage that is refused with its line.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_of_bytes;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Heights of a grid, the southernmost row first.
struct Grid {
  std::size_t columns = 4, rows = 3;
  double x = 10.0, y = 20.0, dx = 2.0, dy = 2.0;  ///< of the south-western node
  std::vector<double> z{1, 2, 4, 8, 1.5, 3, 6, 12, -1, -2, -4, -8};

  [[nodiscard]] double at(std::size_t i, std::size_t j) const { return z[j * columns + i]; }
};

void expect_grid(const RawScan& scan, const Grid& grid, const std::string& text) {
  ASSERT_EQ(scan.records, grid.z.size()) << text;
  std::size_t known = 0;
  for (std::size_t j = 0; j < grid.rows; ++j) {
    for (std::size_t i = 0; i < grid.columns; ++i) {
      if (std::isnan(grid.at(i, j))) continue;
      ++known;
      const Eigen::Vector3d node(grid.x + grid.dx * static_cast<double>(i), grid.y + grid.dy * static_cast<double>(j),
                                 grid.at(i, j));
      EXPECT_EQ(std::count(scan.points.begin(), scan.points.end(), node), 1) << node.transpose() << "\n" << text;
    }
  }
  EXPECT_EQ(scan.points.size(), known) << text;
  EXPECT_EQ(scan.invalid, grid.z.size() - known) << text;
  // Every triangle is seen from above and covers half a cell.
  for (const auto& [a, b, c] : scan.faces) {
    const Eigen::Vector3d normal = (scan.points[b] - scan.points[a]).cross(scan.points[c] - scan.points[a]);
    EXPECT_NEAR(normal.z(), grid.dx * grid.dy, 1e-9 * grid.dx * grid.dy) << text;
  }
  ASSERT_TRUE(scan.cell);
  EXPECT_NEAR(scan.cell->x(), grid.dx, 1e-12 * grid.dx);
  EXPECT_NEAR(scan.cell->y(), grid.dy, 1e-12 * grid.dy);
}

std::string rows_of(const Grid& grid, bool from_north, const std::string& no_data, const char* between = " ") {
  std::string text;
  for (std::size_t row = 0; row < grid.rows; ++row) {
    const std::size_t j = from_north ? grid.rows - 1 - row : row;
    for (std::size_t i = 0; i < grid.columns; ++i) {
      const double z = grid.at(i, j);
      text += (i > 0 ? between : "") + (std::isnan(z) ? no_data : fmt::format("{}", z));
    }
    text += "\n";
  }
  return text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

const std::string kHead = "ncols 4\nnrows 3\nxllcorner 9\nyllcorner 19\ncellsize 2\nNODATA_value -9999\n";

TEST(EsriGrid, ReadsEveryFormOfHeader) {
  const Grid grid;
  const std::string rows = rows_of(grid, true, "-9999");
  for (const std::string& head : {
           kHead,
           std::string("NCOLS        4\r\nNROWS        3\r\nXLLCORNER 9.0\r\nYLLCORNER 1.9e1\r\nCELLSIZE 2.000\r\n"),
           std::string("ncols 4\nnrows 3\nxllcenter 10\nyllcenter 20\ncellsize 2\nnodata_value -9999\n"),
           std::string("ncols 4\nnrows 3\nxllcorner 9\nyllcenter 20\ncellsize 2\n"),
           std::string("ncols 4\nnrows 3\nxllcorner 9\nyllcorner 19\ndx 2\ndy 2\nNODATA_value nan\n"),
           std::string("\n\nNODATA_value -9999\ncellsize 2\n\nyllcorner 19\nxllcorner 9\nnrows 3\nncols 4\n\n"),
           std::string("ncols\t4\nnrows\t3\nxllcorner\t9\nyllcorner\t19\ncellsize\t2\n"),
           std::string("  ncols 4\n  nrows 3\n  xllcorner 9,0\n  yllcorner 19,0\n  cellsize 2,0\n"),
           std::string("ncols: 4\nnrows = 3\nxllcorner= 9\nyllcorner: 19\ncellsize= 2\n"),
           std::string("ncols 4 nrows 3 xllcorner 9 yllcorner 19 cellsize 2\n"),
           "\xEF\xBB\xBF" + kHead,
       }) {
    const bool comma = head.find(',') != std::string::npos;
    const std::string text = head + (comma ? replaced(rows, ".", ",") : rows);
    for (const char* name : {"a.asc", "a.txt", "a.grd", "a"}) {
      const RawScan scan = read_scan_bytes(text, name);
      EXPECT_EQ(scan.format, "ESRI ASCII grid");
      EXPECT_EQ(scan.faces.size(), 12U);
      EXPECT_THAT(scan.warnings, IsEmpty());
      expect_grid(scan, grid, text);
    }
  }
}

TEST(EsriGrid, ReadsRowsOfEveryKind) {
  const Grid grid;
  const std::string rows = rows_of(grid, true, "");
  for (const std::string& text : {
           kHead + rows,
           kHead + replaced(rows, "\n", "\r\n"),
           kHead + replaced(rows, "\n", " \n\n"),
           kHead + replaced(rows, " ", "\t"),
           kHead + "  " + replaced(rows, " ", "   "),
           kHead + replaced(rows, "\n", " "),
           kHead + replaced(rows, " ", "\n"),
           kHead + rows.substr(0, rows.size() - 1),
           kHead + rows + "\n \n",
           kHead + rows + "\x1A",
           replaced(kHead + rows, "\n", "\r"),
           kHead + replaced(rows, ".", ","),
           kHead + "-1\n-2\n-4 -8\n1.5\n3\n6 12\n1\n2\n4 8\n",
           kHead + replaced(rows, "6", "6.0e0"),
       }) {
    const RawScan scan = read_scan_bytes(text, "a.asc");
    EXPECT_EQ(scan.faces.size(), 12U);
    expect_grid(scan, grid, text);
  }
}

TEST(EsriGrid, CellsMayBeWiderThanHigh) {
  Grid grid;
  grid.dx = 0.5;
  grid.dy = 0.25;
  const std::string head = "ncols 4\nnrows 3\nxllcorner 9.75\nyllcorner 19.875\n";
  for (const char* cells : {"dx 0.5\ndy 0.25\n", "cellsize 0.5\ndy 0.25\n", "DX 0.5\nDY 0.25\nNODATA_VALUE -1e38\n"}) {
    expect_grid(read_scan_bytes(head + cells + rows_of(grid, true, ""), "a.asc"), grid, cells);
  }
}

TEST(EsriGrid, AHoleStaysAHole) {
  Grid grid;
  grid.z[5] = kNaN;  // an inner node: four of six cells lose one corner
  for (const auto& [declared, word] : {std::pair{"-9999", "-9999"},
                                       {"-9999", "-9999.0"},
                                       {"-9999.00", "-9999"},
                                       {"-3.402823466e+38", "-3.4028234663852886e+38"},
                                       {"0", "0"},
                                       {"nan", "nan"},
                                       {"-9999", "nan"},
                                       {"-32768", "-32768"},
                                       {"-9999", "1.70141e+38"},
                                       {"-99999,5", "-99999,5"}}) {
    std::string text = replaced(kHead, "-9999", declared) + rows_of(grid, true, word);
    if (std::string(declared).find(',') != std::string::npos) text = replaced(text, ".", ",");
    const RawScan scan = read_scan_bytes(text, "a.asc");
    EXPECT_EQ(scan.faces.size(), 8U) << text;
    expect_grid(scan, grid, text);
  }
  const std::string undeclared = replaced(kHead, "NODATA_value -9999\n", "") + rows_of(grid, true, "-9999");
  const RawScan scan = read_scan_bytes(undeclared, "a.asc");
  expect_grid(scan, grid, undeclared);
  EXPECT_THAT(scan.warnings, ::testing::ElementsAre(HasSubstr("no NODATA_value; 1 values of -9999")));
}

TEST(EsriGrid, RefusesDamageWithItsLine) {
  const auto refuse = [](const std::string& text, int line, const char* message) {
    const auto error = error_of_bytes("a.asc", text);
    ASSERT_TRUE(error) << text;
    EXPECT_THAT(error->what(), HasSubstr(message)) << text;
    EXPECT_EQ(error->place().line, line) << text;
  };
  const std::string rows = "1 2 3 4\n5 6 7 8\n9 10 11 12\n";
  refuse(kHead + "1 2 3 4\n5 6 7\n9 10 11 12\n", 8, "row 2 of the grid has 3 values");
  refuse(kHead + "1 2 3 4\n5 6 7 8 9\n9 10 11 12\n", 8, "row 2 of the grid has more than 4 values");
  refuse(kHead + "1 2 3 4\n5 6 7 8\n9 10 11", 9, "row 3 of the grid has 3 values");
  refuse(kHead + "1 2 3 4\n5 6 7 8\n", 8, "the grid ends after 2 of 3 rows");
  refuse(kHead + "1 2\n3 4\n5 6\n7\n8 9\n10 11\n12\n", 11, "does not end where a line ends");
  refuse(kHead + rows + "13\n", 10, "more values than the header promises");
  refuse(kHead + "1 2 3 4\n5 six 7 8\n9 10 11 12\n", 8, "'six' is not a number");
  refuse(kHead + "1,2,3,4\n5,6,7,8\n9,10,11,12\n", 7, "'1,2,3,4' is not a number");
  refuse(kHead + "1.5 2,5 3 4\n5 6 7 8\n9 10 11 12\n", 7, "'2,5' among numbers with points");
  refuse(kHead + "1;2;3;4\n", 7, "is not a number");
  refuse(kHead, 6, "the grid ends after 0 of 3 rows");
  refuse("ncols 400000\nnrows 300000\nxllcorner 9\nyllcorner 19\ncellsize 2\n" + rows, 5, "values cannot be in the");
  refuse("ncols 4294967296\nnrows 3\nxllcorner 9\nyllcorner 19\ncellsize 2\n" + rows, 1, "ncols is 4.29497e+09");
  refuse("ncols 4\nnrows 2.5\nxllcorner 9\nyllcorner 19\ncellsize 2\n" + rows, 2, "nrows is 2.5");
  refuse("ncols 4\nnrows -3\nxllcorner 9\nyllcorner 19\ncellsize 2\n" + rows, 2, "nrows is -3");
  refuse("ncols 4\nxllcorner 9\nyllcorner 19\ncellsize 2\n" + rows, 4, "no 'nrows'");
  refuse("ncols 4\nnrows 3\nxllcorner 9\nyllcorner 19\n" + rows, 4, "no 'cellsize'");
  refuse("ncols 4\nnrows 3\nxllcorner 9\nyllcorner 19\ncellsize 0\n" + rows, 5, "a cell of 0");
  refuse("ncols 4\nnrows 3\nxllcorner 9\nxllcenter 9\nyllcorner 19\ncellsize 2\n" + rows, 4,
         "both xllcorner and xllcenter");
  refuse("ncols 4\nncols 4\n", 2, "'ncols' is there twice");
  refuse("ncols 4\nnrows 3\nxllcorner here\n", 3, "'here' is no value of 'xllcorner'");
  refuse("ncols 4\nnrows 3\nxurcorner 9\n", 3, "unknown key 'xurcorner'");
}

TEST(EsriGrid, DegreesAreToldByTheirSlopes) {
  std::string head = "ncols 4\nnrows 3\nxllcorner 76.5\nyllcorner 12.25\ncellsize 0.000833\n";
  const std::string rows = "801 805 811 820\n799 800 806 813\n790 797 800 808\n";
  EXPECT_TRUE(read_scan_bytes(head + rows, "a.asc").guessed_degrees);
  EXPECT_FALSE(read_scan_bytes(replaced(head, "0.000833", "0.5") + rows, "a.asc").degrees);
  EXPECT_FALSE(read_scan_bytes(replaced(head, "76.5", "765000") + rows, "a.asc").degrees);
  const std::string flat = "801 801.001 801.002 801\n801 801 801 801.003\n801 801 801 801\n";
  EXPECT_FALSE(read_scan_bytes(head + flat, "a.asc").degrees);
}

TEST(SurferGrid, ReadsRowsFromSouthToNorthAndBlanksAsHoles) {
  Grid grid;
  const std::string head = "DSAA\n4 3\n10 16\n20 24\n-8 12\n";
  const std::string rows = rows_of(grid, false, "");
  for (const std::string& text : {
           head + rows,
           replaced(head + rows, "\n", "\r\n"),
           head + replaced(rows, "\n", "\n\n"),
           head + replaced(rows, " ", "\n"),
           replaced(head, "\n", " ") + "\n" + rows,
           "dsaa\n" + head.substr(5) + rows,
           "\xEF\xBB\xBF" + head + rows,
           head + replaced(rows, ".", ","),
           head + "1 2 4\n8\n\n1.5 3 6\n12\n\n-1 -2 -4\n-8\n\n",
           std::string("DSAA\n4 3\n10.0000 16.0000\n20 24\n-8 12\n") + rows,
       }) {
    const RawScan scan = read_scan_bytes(text, "a.grd");
    EXPECT_EQ(scan.format, "Surfer ASCII grid");
    EXPECT_EQ(scan.faces.size(), 12U);
    expect_grid(scan, grid, text);
  }
  grid.z[0] = kNaN;
  for (const char* blank : {"1.70141e+38", "1.70141E38", "1.7014100091878E+038", "nan"}) {
    const std::string text = head + rows_of(grid, false, blank);
    const RawScan scan = read_scan_bytes(text, "a.grd");
    EXPECT_EQ(scan.faces.size(), 11U);
    expect_grid(scan, grid, text);
  }
}

TEST(SurferGrid, LimitsMayFall) {
  Grid grid;
  const std::string text = "DSAA\n4 3\n10 16\n24 20\n-8 12\n" + rows_of(grid, true, "");
  const RawScan scan = read_scan_bytes(text, "a.grd");
  EXPECT_EQ(scan.faces.size(), 12U);
  expect_grid(scan, grid, text);
}

TEST(SurferGrid, RefusesDamageWithItsLine) {
  const auto refuse = [](const std::string& text, int line, const char* message) {
    const auto error = error_of_bytes("a.grd", text);
    ASSERT_TRUE(error) << text;
    EXPECT_THAT(error->what(), HasSubstr(message)) << text;
    EXPECT_EQ(error->place().line, line) << text;
  };
  refuse("DSAA\n4 3\n10 16\n", 3, "ends within the grid's header");
  refuse("DSAA\n4 x\n10 16\n20 24\n0 1\n", 2, "'x' in the grid's header");
  refuse("DSAA\n4 3\n10 10\n20 24\n0 1\n1 2 3 4\n5 6 7 8\n9 10 11 12\n", 5, "x goes from 10 to 10");
  refuse("DSAA\n4 3\n10 16\n20 24\n0 1\n1 2 3 4\n5 6 7\n9 10 11 12\n", 7, "row 2 of the grid has 3 values");
  refuse("DSAA\n4 3\n10 16\n20 24\n0 1\n1 2 3 4\n5 6 7 8\n", 7, "the grid ends after 2 of 3 rows");
  refuse("DSAA\n40000 30000\n10 16\n20 24\n0 1\n1 2 3 4\n", 5, "values cannot be in the");
}

/// 12 x 10 heights of 100 to 112 m with a hole of six.
Grid grid_with_hole() {
  Grid grid;
  grid.columns = 12;
  grid.rows = 10;
  grid.z.clear();
  for (int k = 0; k < 120; ++k) grid.z.push_back(100.0 + k % 12 + 0.5 * (k / 12 % 2));
  for (const std::size_t k : {40U, 41U, 42U, 52U, 53U, 54U}) grid.z[k] = kNaN;
  return grid;
}

TEST(Grids, AnotherUsualValueThanTheHeadersIsUnknownAndSaid) {
  const Grid grid = grid_with_hole();
  const std::string esri = "ncols 12\nnrows 10\nxllcorner 9\nyllcorner 19\ncellsize 2\n";
  const std::string surfer = "DSAA\n12 10\n10 32\n20 38\n100 112\n";
  const auto expect_said = [&](const std::string& text, const std::string& value) {
    const RawScan scan = read_scan_bytes(text, "a.grd");
    expect_grid(scan, grid, text);
    EXPECT_THAT(scan.warnings, ElementsAre(AllOf(HasSubstr("6 of 120 values"), HasSubstr(value), HasSubstr("unknown"))))
        << text;
  };
  expect_said(esri + "NODATA_value -9999\n" + rows_of(grid, true, "-32768"), "-32768");
  expect_said(esri + "NODATA_value -9999\n" + rows_of(grid, true, "-99999.000"), "-99999");
  expect_said(esri + "NODATA_value -32768\n" + rows_of(grid, true, "-9999"), "-9999");
  expect_said(esri + rows_of(grid, true, "-32767"), "-32767");
  for (const char* value : {"-9999", "-9999.0", "9999", "-32768"}) {
    expect_said(surfer + rows_of(grid, false, value), std::to_string(std::stoi(value)));
  }
  // Beside the header's own.
  Grid both = grid;
  both.z[0] = kNaN;
  const std::string text = esri + "NODATA_value -9999\n" + rows_of(both, true, "-32768");
  const RawScan scan =
      read_scan_bytes(text.substr(0, text.rfind("\n", text.size() - 2) + 1) +
                          replaced(text.substr(text.rfind("\n", text.size() - 2) + 1), "-32768", "-9999"),
                      "a.asc");
  expect_grid(scan, both, text);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("6 of 120 values")));
}

TEST(Grids, HeightsThatAreUsualValuesButBelongToTheOthersStay) {
  Grid grid = grid_with_hole();
  const std::string head = "ncols 12\nnrows 10\nxllcorner 9\nyllcorner 19\ncellsize 2\nNODATA_value -1\n";
  for (double& z : grid.z) z = std::isnan(z) ? 9999.0 : z + 9890.0;
  EXPECT_THAT(read_scan_bytes(head + rows_of(grid, true, ""), "a.asc").warnings, IsEmpty()) << "a mountain";
  expect_grid(read_scan_bytes(head + rows_of(grid, true, ""), "a.asc"), grid, "");
  grid = grid_with_hole();
  for (double& z : grid.z) z = std::isnan(z) ? 100.0 : z;
  grid.z[7] = grid.z[80] = -9999.0;
  EXPECT_EQ(read_scan_bytes(head + rows_of(grid, true, ""), "a.asc").invalid, 0U) << "twice is chance";
  for (std::size_t k = 0; k < grid.z.size(); ++k) grid.z[k] = k % 3 == 0 ? 9999.0 : 9990.0;
  EXPECT_EQ(read_scan_bytes(head + rows_of(grid, true, ""), "a.asc").invalid, 0U) << "a plateau of two levels";
}

}  // namespace
}  // namespace sparsha::pipeline
