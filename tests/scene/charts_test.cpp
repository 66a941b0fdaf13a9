// Frames of charts.
#include "scene/charts.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace sparsha::scene {
namespace {

using Eigen::Vector3d;

TEST(Charts, FramesAreRightHandedAndLookAlongTheirSides) {
  const Vector3d outward[kSides] = {Vector3d::UnitX(),  -Vector3d::UnitX(), Vector3d::UnitY(),
                                    -Vector3d::UnitY(), Vector3d::UnitZ(),  -Vector3d::UnitZ()};
  for (std::size_t side = 0; side < kSides; ++side) {
    const SideAxes axes = SideAxes::of(static_cast<Side>(side));
    const Vector3d u = axes.to_grid(Vector3d(1.0, 0.0, 0.0));
    const Vector3d v = axes.to_grid(Vector3d(0.0, 1.0, 0.0));
    const Vector3d w = axes.to_grid(Vector3d(0.0, 0.0, 1.0));
    EXPECT_EQ(w, outward[side]);
    EXPECT_EQ(u.cross(v), w);
    const Vector3d p(1.0, 2.0, 3.0);
    EXPECT_EQ(axes.to_chart(axes.to_grid(p)), p);
  }
}

TEST(Charts, PlacesAndNormalsOfNodesAreThoseOfTheGridFrame) {
  Charts charts;
  charts.spacing_m = 0.5;
  Sheet sheet;
  sheet.side = Side::left;  // u is z, v is y
  sheet.first_u = 2;
  sheet.first_v = -4;
  sheet.nx = sheet.ny = 1;
  sheet.height_m = {7.0F};
  sheet.slope_u = {3.0F};
  sheet.slope_v = {0.0F};
  sheet.mask = {Sheet::kMeasured};
  EXPECT_EQ(charts.place_m(sheet, 0, 0), Vector3d(-7.0, -2.0, 1.0));
  // dw/du = 3: w grows with z, so the normal leans to -z.
  EXPECT_LT((Charts::normal(sheet, 0, 0) - Vector3d(-1.0, 0.0, -3.0) / std::sqrt(10.0)).norm(), 1e-12);
}

}  // namespace
}  // namespace sparsha::scene
