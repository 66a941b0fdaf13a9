// A path over a whole object: rows come back in the frame that the path is given in.
#include "haptics/replay/around_trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "scene/charts.h"
#include "tests/support/test_folder.h"

namespace sparsha::haptics {
namespace {

/// One level sheet of 20 mm that faces +x, 3 mm beyond the charts' origin.
scene::Charts one_sheet() {
  scene::Charts charts;
  charts.spacing_m = 0.001;
  charts.origin_m = {1.0, 2.0, 3.0};
  scene::Sheet sheet;
  sheet.side = scene::Side::right;
  sheet.nx = sheet.ny = 21;
  sheet.first_u = sheet.first_v = -10;
  sheet.height_m.assign(sheet.count(), 0.003F);
  sheet.slope_u.assign(sheet.count(), 0.0F);
  sheet.slope_v.assign(sheet.count(), 0.0F);
  sheet.mask.assign(sheet.count(), scene::Sheet::kMeasured);
  for (int j = 0; j + 1 < sheet.ny; ++j)
    for (int i = 0; i + 1 < sheet.nx; ++i) sheet.mask[sheet.index(i, j)] |= scene::Sheet::kCell;
  charts.sheets.push_back(sheet);
  return charts;
}

TEST(AroundTrace, ComesBackInTheScanFrame) {
  const auto object = make_object_surface(one_sheet());
  Eigen::Matrix4d scan_from_grid = Eigen::Matrix4d::Identity();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  const double scale = 2.0;
  scan_from_grid.topLeftCorner<3, 3>() = scale * turn;
  scan_from_grid.topRightCorner<3, 1>() = Eigen::Vector3d(5.0, 6.0, 7.0);
  const auto in_scan = [&](const Eigen::Vector3d& grid) -> Eigen::Vector3d {
    return (scan_from_grid * grid.homogeneous()).head<3>();
  };
  const Eigen::Vector3d outside(1.004, 2.0015, 3.0025), inside(1.001, 2.0015, 3.0025), away(1.001, 2.0155, 3.0025);
  std::vector<HipSample> path;
  for (const Eigen::Vector3d& place : {outside, inside, away})
    path.push_back({0.001 * double(path.size()), in_scan(place)});
  scene::HapticsConfig haptics;
  haptics.stiffness_n_per_m = 500.0;
  const TraceResult result = trace_around(*object, path, scan_from_grid, haptics, {});
  ASSERT_EQ(result.rows.size(), 3U);
  EXPECT_FALSE(result.rows[0].contact);
  EXPECT_EQ(result.rows[0].proxy_m, path[0].position_m);
  EXPECT_EQ(result.rows[0].sheet, -1);
  ASSERT_TRUE(result.rows[1].contact);
  EXPECT_EQ(result.rows[1].sheet, 0);
  EXPECT_NEAR((result.rows[1].proxy_m - in_scan({1.003, 2.0015, 3.0025})).norm(), 0.0, 1e-9);
  // 2 mm of the object, in newtons at the hand.
  EXPECT_NEAR((result.rows[1].force_n - turn * Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 0.0, 1e-6);
  // The sheet ends at 2.01 m: the proxy is let go.
  EXPECT_FALSE(result.rows[2].contact);
  ASSERT_TRUE(result.summary.around);
  EXPECT_EQ(result.summary.around->releases, 1U);
  EXPECT_EQ(result.summary.around->touched, 1U);
  EXPECT_EQ(result.summary.contacts, 1U);
  EXPECT_EQ(result.summary.below_surface, 0U);
}

TEST(AroundTrace, RowsFarFromTheObjectAndForcesOfNoDeviceAreCountedAndSaid) {
  const auto object = make_object_surface(one_sheet());
  Eigen::Matrix4d scan_from_grid = Eigen::Matrix4d::Identity();
  scan_from_grid.topLeftCorner<3, 3>() *= 2.0;
  // The sheet is 20 mm long: 19 mm beside it is none of its business, 30 mm and a path in other units are too far.
  const std::vector<Eigen::Vector3d> places{{1.003, 2.029, 3.0}, {1.033, 2.0, 3.0}, {1.004, 2.0, 3.0},
                                            {1.001, 2.0, 3.0},   {0.9, 2.0, 3.0},   {1000.0, 2000.0, 3000.0}};
  std::vector<HipSample> path;
  for (const Eigen::Vector3d& place : places) path.push_back({0.001 * double(path.size()), 2.0 * place});
  path.push_back({0.1, Eigen::Vector3d::Constant(std::nan(""))});
  const TraceResult result = trace_around(*object, path, scan_from_grid, {}, {});
  const PathDoubts& doubts = result.summary.path;
  EXPECT_EQ(doubts.outside, 3U);
  EXPECT_EQ(doubts.first_outside, 2U);
  EXPECT_EQ(doubts.not_a_number, 1U);
  // Of the scan frame, which is twice as large.
  EXPECT_NEAR(doubts.outside_m, 2.0 * std::hypot(998.997, 1997.99, 2996.99), 1e-3);
  EXPECT_EQ(doubts.impossible_force, 1U);
  EXPECT_NEAR(doubts.deepest_m, 2.0 * 0.103, 1e-6);
  const std::vector<std::string> said = sentences(doubts);
  ASSERT_EQ(said.size(), 3U);
  EXPECT_NE(said[1].find("3 rows of the hand's path are farther from the object than it is long, by up to 7"),
            std::string::npos)
      << said[1];
  EXPECT_NE(said[2].find("1 row of the path has forces above 50 N"), std::string::npos) << said[2];
}

TEST(AroundTrace, WritesTheSheetOfEachRow) {
  test::TestFolder folder;
  const auto object = make_object_surface(one_sheet());
  const std::vector<HipSample> path{{0.0, {1.004, 2.0, 3.0}}, {0.001, {1.001, 2.0, 3.0}}};
  const TraceResult result = trace_around(*object, path, Eigen::Matrix4d::Identity(), {}, {});
  write_trace(folder / "trace.csv", result);
  std::ifstream file(folder / "trace.csv");
  std::string header, first, second;
  std::getline(file, header);
  std::getline(file, first);
  std::getline(file, second);
  EXPECT_TRUE(header.ends_with(",contact,level,tick_ns,sheet")) << header;
  EXPECT_TRUE(first.ends_with(",-1")) << first;
  EXPECT_TRUE(second.ends_with(",0")) << second;
}

}  // namespace
}  // namespace sparsha::haptics
