// Six views of a box whose sides are known.
#include "pipeline/report/six_views.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace sparsha::pipeline {
namespace {

using scene::Side;

constexpr int kNodes = 101;

/// A side of a box of 1 x 1 x 1, with a hole where its three coordinates' other two are above 0.2 and below 0.4.
scene::Sheet side_of_a_box(Side side) {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  scene::Sheet sheet;
  sheet.side = side;
  sheet.first_u = sheet.first_v = -kNodes / 2;
  sheet.nx = sheet.ny = kNodes;
  sheet.height_m.assign(sheet.count(), 0.5F);
  sheet.slope_u.assign(sheet.count(), 0.0F);
  sheet.slope_v.assign(sheet.count(), 0.0F);
  sheet.mask.assign(sheet.count(), scene::Sheet::kMeasured);
  for (int j = 70; j <= 90; ++j) {
    for (int i = 70; i <= 90; ++i) {
      sheet.mask[sheet.index(i, j)] = 0;
      sheet.height_m[sheet.index(i, j)] = kUnknown;
    }
  }
  return sheet;
}

scene::Charts box_without(Side missing) {
  scene::Charts charts;
  charts.spacing_m = 0.01;
  for (std::size_t k = 0; k < scene::kSides; ++k) {
    if (static_cast<Side>(k) != missing) charts.sheets.push_back(side_of_a_box(static_cast<Side>(k)));
  }
  return charts;
}

/// Light at a place of one view; the box reaches from -0.5 to 0.5.
float light_at(const SixViews& views, int column, int row, double right, double up) {
  const double pixels_per_m = views.light.width / views.width_m;
  const double pitch_x = views.light.width / 3.0;
  const double pitch_y = views.light.height / 2.0;
  // The gaps move the middle of the outer views by a third or a half of one.
  const double gap = (views.light.width - 3.0 * 330.0) / 2.0;
  const double x = (column + 0.5) * pitch_x + (column - 1) * gap / 3.0 + right * pixels_per_m;
  const double y = (row + 0.5) * pitch_y + (row - 0.5) * gap / 2.0 - up * pixels_per_m;
  return views.light.at(static_cast<int>(x), static_cast<int>(y));
}

TEST(SixViews, ShowEachSideUprightAndWhatNoScanSawAsNothing) {
  const SixViews views = six_views(box_without(Side::down));
  struct Place {
    int column, row;
    double right, up;  // where the hole of that side is to be seen
  };
  // Left, front, right; above, behind, below.
  const std::array<Place, 5> places = {
      Place{0, 0, 0.3, 0.3}, {1, 0, 0.3, 0.3}, {2, 0, -0.3, 0.3}, {0, 1, 0.3, -0.3}, {1, 1, -0.3, 0.3}};
  const float level = static_cast<float>(0.2 + 0.8 * 0.65 / std::sqrt(0.25 + 0.36 + 0.65 * 0.65));
  for (const Place& p : places) {
    for (const double a : {-0.3, 0.3}) {
      for (const double b : {-0.3, 0.3}) {
        const float light = light_at(views, p.column, p.row, a, b);
        if (a == p.right && b == p.up) {
          EXPECT_TRUE(std::isnan(light)) << p.column << ' ' << p.row << ": the hole";
        } else {
          EXPECT_NEAR(light, level, 1e-5F) << p.column << ' ' << p.row << ' ' << a << ' ' << b;
        }
      }
    }
    EXPECT_FALSE(std::isnan(light_at(views, p.column, p.row, 0.49, -0.49)));
    EXPECT_TRUE(std::isnan(light_at(views, p.column, p.row, 0.515, -0.4))) << "beside the box";
  }
  for (const double a : {-0.3, 0.0, 0.3}) EXPECT_TRUE(std::isnan(light_at(views, 2, 1, a, 0.1))) << "from below";
}

TEST(SixViews, OfManyNodesAreThoseOfFewer) {
  scene::Charts one;
  one.spacing_m = 1.0;
  one.sheets.push_back(side_of_a_box(Side::front));
  one.sheets.back().height_m.assign(one.sheets.back().count(), 0.0F);
  scene::Charts fine = one;
  scene::Sheet& sheet = fine.sheets.back();
  fine.spacing_m = 0.1;
  sheet.first_u = sheet.first_v = -500;
  sheet.nx = sheet.ny = 1001;
  sheet.height_m.assign(sheet.count(), 0.0F);
  sheet.slope_u.assign(sheet.count(), 0.0F);
  sheet.slope_v.assign(sheet.count(), 0.0F);
  sheet.mask.assign(sheet.count(), scene::Sheet::kMeasured);
  for (std::uint8_t& mask : one.sheets.back().mask) mask = scene::Sheet::kMeasured;
  const SixViews few = six_views(one);
  const SixViews many = six_views(fine);
  EXPECT_NEAR(few.width_m, many.width_m, 1e-9);
  for (const double a : {-40.0, 0.0, 40.0})
    EXPECT_NEAR(light_at(few, 1, 0, a, a), light_at(many, 1, 0, a, a), 1e-6F) << a;
}

}  // namespace
}  // namespace sparsha::pipeline
