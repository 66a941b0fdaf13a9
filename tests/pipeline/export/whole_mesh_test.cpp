// The mesh of a whole object as a ball's volume and surface tell it, in the frame of the scans.
#include "pipeline/export/whole_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "base/error.h"
#include "pipeline/scan/reader.h"
#include "readers.h"
#include "tests/support/ball_scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

namespace fs = std::filesystem;
using Triangle = std::array<std::uint32_t, 3>;

constexpr double kRadius_m = 0.05, kSpacing_m = 0.0031;
const Eigen::Vector3d kOrigin_m(0.1, -0.2, 0.3);

/// Turned, halved and moved; with `mirrored` also turned inside out.
Eigen::Matrix4d pose(bool mirrored) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = 0.5 * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  if (mirrored) m.col(0) *= -1.0;
  m.topRightCorner<3, 1>() = Eigen::Vector3d(4500.0, 5412.0, 300.0);
  return m;
}

void expect_ball(const std::vector<Eigen::Vector3d>& points, const std::vector<Triangle>& triangles,
                 const Eigen::Vector3d& centre_m, double slack_m) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> ways;
  double volume = 0.0;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++ways[{t[k], t[(k + 1) % 3]}];
    volume += (points[t[0]] - centre_m).dot((points[t[1]] - centre_m).cross(points[t[2]] - centre_m)) / 6.0;
  }
  for (const auto& [way, count] : ways) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(ways.contains({way.second, way.first}));
  }
  const double radius = 0.5 * kRadius_m;
  EXPECT_NEAR(volume / (4.0 / 3.0 * M_PI * radius * radius * radius), 1.0, 0.01);
  for (const Eigen::Vector3d& p : points) ASSERT_NEAR((p - centre_m).norm(), radius, slack_m);
}

template <typename Points>
std::vector<Eigen::Vector3d> vectors(const Points& points) {
  std::vector<Eigen::Vector3d> result;
  for (const auto& p : points) result.emplace_back(p[0], p[1], p[2]);
  return result;
}

TEST(ExportWholeMesh, IsTheClosedObjectInTheScanFrameInAllFormats) {
  ThreadPool pool(2);
  Progress progress;
  for (const bool mirrored : {false, true}) {
    const test::TestFolder folder;
    const Eigen::Matrix4d m = pose(mirrored);
    const Eigen::Vector3d centre = m.topLeftCorner<3, 3>() * kOrigin_m + m.topRightCorner<3, 1>();
    const scene::ScenePointer scene = test::ball_scene(kRadius_m, kSpacing_m, m, kOrigin_m);
    // Most vertices are nodes; those between charts lie on chords of a cell.
    constexpr double kSlack_m = 0.05 * kSpacing_m;
    for (const char* name : {"a.ply", "a.obj"}) {
      const ClosedMeshFacts facts = export_whole_mesh(*scene, folder / name, Holes::close, {pool, progress});
      EXPECT_EQ(facts.shells, 1U);
      EXPECT_EQ(facts.closing_m2, 0.0);
      EXPECT_NEAR(facts.area_m2, 4.0 * M_PI * kRadius_m * kRadius_m, 0.01 * facts.area_m2);
      const test::Mesh mesh =
          fs::path(name).extension() == ".ply" ? test::read_ply(folder / name) : test::read_obj(folder / name);
      expect_ball(vectors(mesh.vertices), mesh.faces, centre, kSlack_m);
    }
    static_cast<void>(export_whole_mesh(*scene, folder / "a.glb", Holes::close, {pool, progress}));
    const RawScan glb = read_scan(folder / "a.glb");
    EXPECT_TRUE(glb.warnings.empty());
    expect_ball(vectors(glb.points), glb.faces, centre, kSlack_m);
  }
}

// As charts of a scan with colours have them: one a node, by its direction from the ball's middle.
TEST(ExportWholeMesh, HasTheColoursOfAllSides) {
  const auto level = [](const Eigen::Vector3d& p, int axis) { return 128.0 + 100.0 * p.normalized()[axis]; };
  scene::Charts charts = test::ball_charts(kRadius_m, kSpacing_m, kOrigin_m);
  for (scene::Sheet& sheet : charts.sheets) {
    sheet.colour_rgba.assign(sheet.count(), 0);
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        std::uint32_t rgba = 0xFF000000U;
        for (int axis = 0; axis < 3; ++axis)
          rgba |= static_cast<std::uint32_t>(std::lround(level(charts.place_m(sheet, i, j), axis))) << (8 * axis);
        sheet.colour_rgba[sheet.index(i, j)] = rgba;
      }
  }
  const Eigen::Matrix4d m = pose(true);
  const scene::ScenePointer scene = test::scene_of_charts(std::move(charts), m, kRadius_m);
  ThreadPool pool(2);
  Progress progress;
  const test::TestFolder folder;
  const Eigen::Matrix4d grid_from_scan = m.inverse();
  const auto expect_colours = [&](const std::vector<Eigen::Vector3d>& places, const auto& colour_of, double slack) {
    ASSERT_GT(places.size(), 3000U);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Eigen::Vector3d at = (grid_from_scan * places[k].homogeneous()).head<3>() - kOrigin_m;
      for (int axis = 0; axis < 3; ++axis) ASSERT_NEAR(colour_of(k, axis), level(at, axis), slack);
    }
  };
  constexpr double kSlack = 0.75 * 100.0 * kSpacing_m / kRadius_m;  // a vertex between nodes has the nearer one's
  for (const char* name : {"a.ply", "a.obj"}) {
    static_cast<void>(export_whole_mesh(*scene, folder / name, Holes::close, {pool, progress}));
    const test::Mesh mesh =
        fs::path(name).extension() == ".ply" ? test::read_ply(folder / name) : test::read_obj(folder / name);
    ASSERT_EQ(mesh.colours.size(), mesh.vertices.size()) << name;
    expect_colours(
        vectors(mesh.vertices),
        [&](std::size_t k, int axis) { return static_cast<double>(mesh.colours[k][static_cast<std::size_t>(axis)]); },
        kSlack);
  }
  static_cast<void>(export_whole_mesh(*scene, folder / "a.glb", Holes::close, {pool, progress}));
  const RawScan glb = read_scan(folder / "a.glb");
  ASSERT_EQ(glb.rgba.size(), glb.points.size());
  expect_colours(
      vectors(glb.points),
      [&](std::size_t k, int axis) { return static_cast<double>(glb.rgba[k] >> (8 * axis) & 255U); }, kSlack);
}

TEST(ExportWholeMesh, NeedsAnEndingThatNamesAMesh) {
  EXPECT_TRUE(is_mesh("a.PLY") && is_mesh("b.obj") && is_mesh("c.glb"));
  EXPECT_FALSE(is_mesh("a.xyz") || is_mesh("a.tif"));
  ThreadPool pool(1);
  Progress progress;
  const test::TestFolder folder;
  const scene::ScenePointer scene = test::ball_scene(kRadius_m, kSpacing_m, Eigen::Matrix4d::Identity());
  EXPECT_THROW((void)export_whole_mesh(*scene, folder / "a.xyz", Holes::close, {pool, progress}), Error);
  EXPECT_FALSE(fs::exists(folder / "a.xyz"));
}

}  // namespace
}  // namespace sparsha::pipeline
