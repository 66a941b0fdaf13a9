// Nothing doubtful is said without a warning, and a sound surface gets none.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/error.h"
#include "pipeline/build/warnings.h"
#include "scene/config.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kMeasured = 10'000;

Lattice millimetre_grid() {
  Lattice lattice;
  lattice.nx = lattice.ny = 100;
  lattice.spacing_m = 0.001;
  return lattice;
}

Projection sound() {
  Projection projection;
  projection.noise_m = 0.0001;
  projection.point_spacing_m = 0.001;
  projection.closed = true;
  projection.facing_known = true;
  return projection;
}

CheckResult checked(double median_m) {
  CheckResult check;
  check.cloud_to_surface.samples = 1000;
  check.cloud_to_surface.median_m = median_m;
  return check;
}

std::vector<std::string> warnings_of(const Projection& projection, double median_m = 0.0001) {
  return surface_warnings(projection, millimetre_grid(), kMeasured, checked(median_m));
}

void expect_one(const std::vector<std::string>& warnings, const std::string& words) {
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings.front().find(words), std::string::npos) << warnings.front();
}

TEST(SurfaceWarnings, ASoundSurfaceAndAMeshHaveNone) {
  EXPECT_TRUE(warnings_of(sound()).empty());
  Projection mesh = sound();
  mesh.only_mesh = true;
  mesh.noise_m = 0.0;
  EXPECT_TRUE(warnings_of(mesh, 1.0).empty());
}

TEST(SurfaceWarnings, APointCloudWithoutNoiseHasThemAsAnyOther) {
  Projection flat = sound();
  flat.noise_m = 0.0;
  expect_one(warnings_of(flat, 0.00021), "farther than 0.21 mm");
  flat.point_spacing_m = 0.0031;
  expect_one(warnings_of(flat), "3.1 times finer");
}

TEST(SurfaceWarnings, NameWhatIsDoubtfulAndWhatToDo) {
  Projection noisy = sound();
  noisy.noise_m = 0.00051;
  expect_one(warnings_of(noisy), "grid.noise_mm");
  Projection sparse = sound();
  sparse.point_spacing_m = 0.0031;
  expect_one(warnings_of(sparse), "3.1 times finer");
  expect_one(warnings_of(sound(), 0.00051), "farther than 0.51 mm");
  Projection close = sound();
  close.nodes_doubtful = kMeasured / 50;
  expect_one(warnings_of(close), "2.0 % of the nodes");
  Projection holes = sound();
  holes.nodes_turned_away = 200;
  expect_one(warnings_of(holes), "200 nodes");
  Projection unknown = sound();
  unknown.nodes_unsure = kMeasured / 2;
  expect_one(warnings_of(unknown), "50 %");
  Projection turned = sound();
  turned.facing_known = false;
  expect_one(warnings_of(turned), "not believed");
}

TEST(SurfaceWarnings, ASurfaceFartherThanASpacingFromHalfOfItsPointsIsAnError) {
  EXPECT_NO_THROW(require_surface_near_points(millimetre_grid(), checked(0.001)));
  EXPECT_THROW(require_surface_near_points(millimetre_grid(), checked(0.00101)), Error);
}

TEST(GridNoise, IsReadAndWrittenAndMayNotBeNegative) {
  const auto parsed = [](const std::string& noise) {
    return parse_config(yaml::parse_text("scans: [{file: a.ply}]\ngrid: {noise_mm: " + noise + "}\n", "test"), ".");
  };
  ASSERT_TRUE(parsed("0.25").grid.noise_m.has_value());
  EXPECT_DOUBLE_EQ(*parsed("0.25").grid.noise_m, 0.00025);
  EXPECT_NE(to_yaml(parsed("0.25")).find("noise_mm: 0.25"), std::string::npos);
  EXPECT_THROW((void)parsed("-1"), Error);
}

}  // namespace
}  // namespace sparsha::pipeline
