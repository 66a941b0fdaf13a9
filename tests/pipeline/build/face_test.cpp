// `orientation: {face: ...}`: found in the points when a scene is built, in memory or not, and written down.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include <Eigen/Geometry>

#include "base/error.h"
#include "base/files/files.h"
#include "base/yaml/yaml.h"
#include "pipeline/build/build.h"
#include "scene/scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

/// An inscribed plate of 80 x 120 x 15 mm, turned; its front at z = +7.5 mm has a dome of 5 mm.
class FaceBuild : public ::testing::Test {
 protected:
  FaceBuild() {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::normal_distribution<double> noise(0.0, 0.0001);
    std::string text;
    for (int i = 0; i < 60000; ++i) {
      const Eigen::Vector2d at(0.04 * unit(random), 0.06 * unit(random));
      const double dome = 0.005 * std::max(0.0, 1.0 - at.squaredNorm() / (0.02 * 0.02));
      const bool front = i % 5 != 0;
      const Eigen::Vector3d p(at.x(), at.y(), (front ? 0.0075 + dome : -0.0075) + noise(random));
      const Eigen::Vector3d q = turn_ * p + Eigen::Vector3d(1.0, 2.0, 3.0);
      for (int axis = 0; axis < 3; ++axis) text += std::to_string(q[axis]) + (axis < 2 ? ' ' : '\n');
    }
    write_file(folder_ / "plate.xyz", text);
  }

  [[nodiscard]] scene::Config config(const std::string& orientation) const {
    write_file(folder_ / "plate.yaml",
               "scans: [{file: plate.xyz, units: m}]\ngrid: {spacing_mm: 1}\norientation: " + orientation + "\n");
    return scene::load_config(folder_ / "plate.yaml");
  }

  const Eigen::Matrix3d turn_ =
      (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const test::TestFolder folder_;
  Progress progress_;
};

double degrees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::min(1.0, a.normalized().dot(b.normalized()))) * 180.0 / M_PI;
}

TEST_F(FaceBuild, APlateIsSeenFromItsFrontAndStandsUpright) {
  for (const char* face : {"{face: plane}", "{face: auto}"}) {
    const BuildResult built = build_scene(config(face), {}, progress_);
    const scene::SceneDescription& scene = built.scene->description();
    EXPECT_FALSE(scene.config.orientation.face.has_value());
    const Eigen::Matrix3d m = scene.config.orientation.scan_to_grid.topLeftCorner<3, 3>();
    EXPECT_LT(degrees(m.row(2), turn_.col(2)), 0.3) << built.report.orientation;
    EXPECT_LT(degrees(m.row(1), turn_.col(1)), 0.5);
    EXPECT_NEAR((scene.levels[0].nx - 1) * 0.001, 0.08, 0.003);
    EXPECT_NEAR((scene.levels[0].ny - 1) * 0.001, 0.12, 0.003);
    EXPECT_NE(built.report.orientation.find("largest flat face"), std::string::npos) << built.report.orientation;
  }
}

TEST_F(FaceBuild, WhatIsWrittenBuildsTheSameSceneAgain) {
  build_scene_folder(config("{face: auto}"), {}, folder_ / "scene", progress_);
  const scene::Config again = scene::load_config(folder_ / "scene" / "scene.yaml");
  EXPECT_FALSE(again.orientation.face.has_value());
  build_scene_folder(again, {}, folder_ / "again", progress_);
  for (const char* file : {"scene.yaml", "level-0/height.tif"}) {
    EXPECT_EQ(read_file(folder_ / "scene" / file, 1U << 30U), read_file(folder_ / "again" / file, 1U << 30U)) << file;
  }
}

TEST_F(FaceBuild, OutOfCoreAndWithAnyThreadsItIsTheSameFace) {
  BuildOptions in_memory;
  in_memory.threads = 1;
  BuildOptions by_tiles;
  by_tiles.threads = 3;
  by_tiles.memory_points = 20000;
  by_tiles.scratch_folder = folder_.path();
  const BuildResult a = build_scene(config("{face: plane}"), in_memory, progress_);
  const BuildResult b = build_scene(config("{face: plane}"), by_tiles, progress_);
  EXPECT_EQ(a.scene->description().config.orientation.scan_to_grid,
            b.scene->description().config.orientation.scan_to_grid);
  EXPECT_EQ(a.report.orientation, b.report.orientation);
}

TEST_F(FaceBuild, UpAndScaleAreKept) {
  const BuildResult built = build_scene(config("{face: plane, up: [1, 0, 0], scale: 2}"), {}, progress_);
  const Eigen::Matrix3d m = built.scene->description().config.orientation.scan_to_grid.topLeftCorner<3, 3>();
  EXPECT_NEAR(m.determinant(), 8.0, 1e-9);
  EXPECT_LT(degrees(m.row(1), turn_.col(0)), 0.5);
}

TEST_F(FaceBuild, IsLookedForInWhatFiltersLeave) {
  // The dome's top alone has no plane that is flat to a fiftieth of its size.
  scene::Config cut = config("{face: plane}");
  const Eigen::Vector3d top = turn_ * Eigen::Vector3d(0.0, 0.0, 0.0115) + Eigen::Vector3d(1.0, 2.0, 3.0);
  cut.filters.emplace_back(
      scene::CropConfig{top - Eigen::Vector3d::Constant(0.0035), top + Eigen::Vector3d::Constant(0.0035)});
  const BuildResult built = build_scene(cut, {}, progress_);
  EXPECT_LT(built.report.points.read - built.report.points.filtered, 3000U);
  EXPECT_LT(degrees(built.scene->description().config.orientation.scan_to_grid.row(2).head<3>(), turn_.col(2)), 8.0)
      << built.report.orientation;
}

TEST_F(FaceBuild, ContradictionsAreRefused) {
  for (const char* wrong : {"{face: front}", "{face: auto, look_from: [0, 0, 1]}", "{face: plane, up: [0, 0, 0]}",
                            "{face: plane, euler_deg: [0, 0, 0]}"}) {
    EXPECT_THROW((void)config(wrong), Error) << wrong;
  }
  const scene::Config wish = config("{face: principal, up: [0, 1, 1], scale: 0.5}");
  const scene::Config read = scene::parse_config(yaml::parse_text(scene::to_yaml(wish), "text"), folder_.path());
  EXPECT_EQ(read.orientation.face, scene::OrientationConfig::Face::principal);
  EXPECT_EQ(*read.orientation.face_up, Eigen::Vector3d(0, 1, 1));
  EXPECT_EQ(read.orientation.face_scale, 0.5);
}

}  // namespace
}  // namespace sparsha::pipeline
