// Nothing doubtful is said without a warning, and a sound surface gets none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/files/files.h"
#include "base/yaml/yaml.h"
#include "pipeline/build/build.h"
#include "pipeline/build/warnings.h"
#include "scene/config/config.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kMeasured = 10'000;

scene::Lattice millimetre_grid() {
  scene::Lattice lattice;
  lattice.nx = lattice.ny = 100;
  lattice.spacing_m = 0.001;
  return lattice;
}

Projection sound() {
  Projection projection;
  projection.noise_m = 0.0001;
  projection.point_spacing_m = 0.001;
  projection.closed = true;
  projection.facing_asked = true;
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
  noisy.closed = false;
  expect_one(warnings_of(noisy), "grid.noise_mm");
  noisy.point_spacing_m = 0.0005;  // four points to a node halve the noise,
  EXPECT_TRUE(warnings_of(noisy).empty());
  noisy.closed = true;  // not where a second face may be as near
  expect_one(warnings_of(noisy), "crop one away");
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
  CheckResult nothing = checked(0.0);
  nothing.cloud_to_surface.samples = 0;
  expect_one(surface_warnings(sound(), millimetre_grid(), kMeasured, nothing), "nothing to compare");
  Projection relief = sound();
  relief.closed = false;
  relief.nodes_unsure = 200;
  expect_one(warnings_of(relief), "200 nodes");
  Projection turned = sound();
  turned.facing_known = false;
  expect_one(warnings_of(turned), "not believed");
}

// 50 x 50 places 10 mm apart in a plane, as points or as a mesh, on a grid of 2.5 mm.
std::vector<std::string> warnings_of_plane(bool faces, const std::string& noise) {
  const test::TestFolder folder;
  constexpr int kSide = 50;
  std::string corners;
  std::string triangles;
  int count = 0;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      corners += std::to_string(0.01 * i) + ' ' + std::to_string(0.01 * j) + " 0\n";
      if (i + 1 == kSide || j + 1 == kSide) continue;
      const int a = kSide * j + i;
      for (const int corner : {0, 1}) {
        triangles += "3 " + std::to_string(a + corner * (kSide + 1)) + ' ' + std::to_string(a + kSide) + ' ' +
                     std::to_string(a + 1) + '\n';
      }
      count += 2;
    }
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(kSide * kSide);
  text += "\nproperty double x\nproperty double y\nproperty double z\n";
  if (faces) text += "element face " + std::to_string(count) + "\nproperty list uchar int vertex_indices\n";
  write_file(folder / "plane.ply", text + "end_header\n" + corners + (faces ? triangles : ""));
  scene::Config config = scene::parse_config(
      yaml::parse_text("scans: [{file: plane.ply, units: m}]\norientation: {look_from: [0, 0, 1], up: "
                       "[0, 1, 0]}\ngrid: {spacing_mm: 2.5" +
                           noise + "}\n",
                       "test"),
      folder);
  Progress progress;
  return build_scene(config, {}, progress).report.warnings;
}

TEST(SurfaceWarnings, AreGivenForPointsWhoseNoiseIsZeroAndNotForAMesh) {
  expect_one(warnings_of_plane(false, ", noise_mm: 0"), "times finer than the points");
  expect_one(warnings_of_plane(false, ""), "times finer than the points");
  EXPECT_TRUE(warnings_of_plane(true, "").empty());
}

TEST(SurfaceWarnings, ASurfaceFartherThanASpacingFromHalfOfItsPointsIsAnError) {
  EXPECT_NO_THROW(require_surface_near_points(sound(), millimetre_grid(), checked(0.001)));
  EXPECT_THROW(require_surface_near_points(sound(), millimetre_grid(), checked(0.00101)), Error);
}

/// Of a site of 300 m in a table, which begins there and has those names and units.
std::vector<std::string> warnings_of_site(double corner, const std::string& names, const std::string& units) {
  const test::TestFolder folder;
  std::string table = names;
  for (int j = 0; j <= 30; ++j)
    for (int i = 0; i <= 30; ++i)
      table += fmt::format("{:.3f},{:.3f},{:.3f}\n", corner + 10 * i, corner + 10 * j, std::sin(0.4 * i + 0.3 * j));
  write_file(folder / "site.csv", table);
  const scene::Config config = scene::parse_config(
      yaml::parse_text("scans: [{file: site.csv" + units +
                           "}]\norientation: {look_from: [0, 0, 1], up: [0, 1, 0]}\ngrid: {spacing_mm: 10000}\n",
                       "test"),
      folder);
  BuildOptions options;
  options.grid_only = true;
  Progress progress;
  return build_scene(config, options, progress).report.warnings;
}

TEST(SizeWarnings, AreGivenOnceAndNotWhereTheFileNamesItsUnitOrLiesInAGridOfTheEarth) {
  const auto about_size = [](const std::vector<std::string>& warnings) {
    return std::count_if(warnings.begin(), warnings.end(),
                         [](const std::string& text) { return text.find(" long") != std::string::npos; });
  };
  EXPECT_EQ(about_size(warnings_of_site(0, "x,y,z\n", "")), 1) << "300 mm rather";
  EXPECT_EQ(about_size(warnings_of_site(0, "x,y,z\n", ", units: m")), 1);
  EXPECT_EQ(about_size(warnings_of_site(0, "x [m],y [m],z [m]\n", "")), 0);
  EXPECT_EQ(about_size(warnings_of_site(0, "x [m],y [m],z [m]\n", ", units: m")), 0);
  EXPECT_EQ(about_size(warnings_of_site(412000, "x,y,z\n", "")), 0);
  EXPECT_EQ(about_size(warnings_of_site(412000, "x,y,z\n", ", units: m")), 0);
  EXPECT_EQ(about_size(warnings_of_site(12000, "x,y,z\n", "")), 1);
}

TEST(GridNoise, IsReadAndWrittenAndMayNotBeNegative) {
  const auto parsed = [](const std::string& noise) {
    return scene::parse_config(yaml::parse_text("scans: [{file: a.ply}]\ngrid: {noise_mm: " + noise + "}\n", "test"),
                               ".");
  };
  ASSERT_TRUE(parsed("0.25").grid.noise_m.has_value());
  EXPECT_DOUBLE_EQ(*parsed("0.25").grid.noise_m, 0.00025);
  EXPECT_NE(scene::to_yaml(parsed("0.25")).find("noise_mm: 0.25"), std::string::npos);
  EXPECT_THROW((void)parsed("-1"), Error);
}

TEST(SurfaceWarnings, WhatIsSeenEdgeOnIsSaidWithTheFilterThatTakesItAway) {
  Projection projection = sound();
  projection.used = 10'000;
  projection.edge_on = 100;
  projection.edge_on_normal = {-0.001, 1.0, -0.002};  // no minus before a zero
  EXPECT_TRUE(warnings_of(projection).empty());
  EXPECT_NO_THROW(require_surface_near_points(projection, millimetre_grid(), checked(0.0001)));
  projection.edge_on = 5'000;
  expect_one(warnings_of(projection), "remove_plane: {normal: [0.00, 1.00, 0.00], distance_mm: 1}");
  EXPECT_NO_THROW(require_surface_near_points(projection, millimetre_grid(), checked(0.0001)));
  const auto message = [&](double median_m) {
    try {
      require_surface_near_points(projection, millimetre_grid(), checked(median_m));
    } catch (const Error& error) {
      return error.wrong() + "; " + error.expected();
    }
    return std::string();
  };
  EXPECT_NE(message(0.002).find("remove_plane"), std::string::npos) << message(0.002);
  // Nearly nothing but what cannot be judged.
  projection.edge_on = 100'000;
  EXPECT_NE(message(0.0001).find("edge-on"), std::string::npos) << message(0.0001);
  EXPECT_NE(message(0.0001).find("remove_plane"), std::string::npos) << message(0.0001);
  // A round wall is no plane that could be taken away.
  projection.edge_on_normal.setZero();
  EXPECT_EQ(message(0.0001).find("remove_plane"), std::string::npos) << message(0.0001);
  projection.edge_on = 5'000;
  expect_one(warnings_of(projection), "round wall");
  EXPECT_EQ(message(0.002).find("remove_plane"), std::string::npos) << message(0.002);
}

}  // namespace
}  // namespace sparsha::pipeline
