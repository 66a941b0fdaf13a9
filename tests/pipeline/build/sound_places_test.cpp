// Where sounds lie when a scene is built: on pillars that are found, under a label image, also of a turned object.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>

#include "base/error.h"
#include "base/files/files.h"
#include "pipeline/build/build.h"
#include "scene/area/regions.h"
#include "tests/support/part_scenes.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

/// Three pillars of 1.5 m before a wall, seen from the front (+z), y up.
class SoundPlaces : public ::testing::Test {
 protected:
  SoundPlaces() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::string text;
    const auto add = [&](double x, double y, double z) {
      text += std::to_string(x) + ' ' + std::to_string(y) + ' ' + std::to_string(z) + '\n';
    };
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 10000; ++i) {
        const double angle = std::numbers::pi * unit(random);
        const double radius = kRadius_m[static_cast<std::size_t>(k)];
        add(k + radius * std::cos(angle), 1.5 * unit(random), radius * std::sin(angle));
      }
    for (int i = 0; i < 30000; ++i) add(-0.5 + 3.0 * unit(random), 1.5 * unit(random), -0.3);
    write_file(folder_ / "hall.xyz", text);
  }
  [[nodiscard]] scene::Config config(const std::string& orientation, const std::string& audio) const {
    write_file(folder_ / "hall.yaml", "scans: [{file: hall.xyz, units: m}]\ngrid: {spacing_mm: 10}\norientation: " +
                                          orientation + "\naudio: " + audio + "\n");
    return scene::load_config(folder_ / "hall.yaml");
  }

  static constexpr std::array<double, 3> kRadius_m{0.06, 0.12, 0.06};
  const test::TestFolder folder_;
  Progress progress_;
};

const char* const kFront = "{look_from: [0, 0, 1], up: [0, 1, 0]}";
/// The same object lying on its side, its regions as they were.
const char* const kTurned =
    "{matrix: [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], "
    "regions_matrix: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}";

TEST_F(SoundPlaces, PillarsOfATurnedObjectAreWhereTheRegionsAreWritten) {
  for (const char* orientation : {kFront, kTurned}) {
    const BuildResult built = build_scene(config(orientation, "{find: pillars}"), {}, progress_);
    const auto& regions = built.scene->description().config.audio->regions;
    ASSERT_EQ(regions.size(), 3U) << orientation;
    const std::array<double, 3> truth_x_m{1.0, 0.0, 2.0};  // the thickest first
    for (std::size_t k = 0; k < 3; ++k) {
      double low = 1e9, high = -1e9, top = -1e9;
      for (const auto& corner : regions[k].polygon_m) {
        low = std::min(low, corner[0]), high = std::max(high, corner[0]);
        top = std::max(top, corner[1]);
      }
      EXPECT_NEAR(0.5 * (low + high), truth_x_m[k], 0.02) << orientation;
      EXPECT_NEAR(top, 1.5, 0.1) << orientation;
    }
  }
}

TEST_F(SoundPlaces, PillarsAreTheSameOutOfCore) {
  BuildOptions by_tiles;
  by_tiles.memory_points = 10000;
  by_tiles.scratch_folder = folder_.path();
  const auto yaml = [&](const BuildOptions& options) {
    return scene::to_yaml(
        build_scene(config(kFront, "{find: pillars}"), options, progress_).scene->description().config);
  };
  EXPECT_EQ(yaml({}), yaml(by_tiles));
}

TEST_F(SoundPlaces, ALabelImageKeepsThePlaceThatItWasDrawnFor) {
  test::write_labels(folder_ / "labels.png", 1, 1, [](int, int) { return 3; });
  const BuildResult built = build_scene(
      config(kFront, "{labels: labels.png, regions: [{name: a, label: 3, material: wood}]}"), {}, progress_);
  const auto& labels = built.scene->description().config.audio->labels;
  ASSERT_TRUE(labels && labels->bounds_m);
  const scene::Lattice& grid = built.scene->description().levels.front();
  EXPECT_EQ(*labels->bounds_m,
            (std::array<double, 4>{grid.x_m(0), grid.y_m(0), grid.x_m(grid.nx - 1), grid.y_m(grid.ny - 1)}));
  EXPECT_THROW(
      static_cast<void>(build_scene(
          config(kTurned, "{labels: labels.png, regions: [{name: a, label: 3, material: wood}]}"), {}, progress_)),
      Error);
}

TEST_F(SoundPlaces, ThatAreNowhereOnTheGridAreWarnedOfByName) {
  test::write_labels(folder_ / "labels.png", 4, 4, [](int column, int) { return column < 2 ? 3 : 0; });
  const BuildResult built =
      build_scene(config(kFront,
                         "{labels: labels.png, regions: [{name: there, box_m: [0, 0, 1, 1], material: wood}, "
                         "{name: millimetres, box_m: [3000, 0, 4000, 1000], material: wood}, "
                         "{name: far, polygon_m: [[8, 8], [9, 8], [9, 9]], material: wood}, "
                         "{name: pixels, label: 3, material: wood}, {name: none, label: 4, material: wood}]}\n"
                         "parts: [{name: beside, box_m: [-9, 0, -8, 1]}, {name: half, box_m: [-9, 0, 0, 1]}]"),
                  {}, progress_);
  const auto told = [&](const std::string& what) {
    return std::count_if(built.report.warnings.begin(), built.report.warnings.end(),
                         [&](const std::string& text) { return text.find(what + " is nowhere") != std::string::npos; });
  };
  for (const char* name : {"audio region 'millimetres'", "audio region 'far'", "audio region 'none'", "part 'beside'"})
    EXPECT_EQ(told(name), 1) << name;
  for (const char* name : {"audio region 'there'", "audio region 'pixels'", "part 'half'"})
    EXPECT_EQ(told(name), 0) << name;
}

/// The hall is 3 m wide: a picture of 30 x 15 pixels over it, value 4 in the left half.
class PartPlaces : public SoundPlaces {
 protected:
  PartPlaces() {
    test::write_labels(folder_ / "labels.png", 30, 15, [](int column, int) { return column < 15 ? 4 : 0; });
  }
  [[nodiscard]] scene::Config with_parts(const char* orientation, const std::string& labels) const {
    return config(orientation, "{labels: " + labels +
                                   "}\nparts: [{name: left, label: 4}, {name: lost, label: 9}, "
                                   "{name: notch, polygon_m: [[1, 0], [2, 0], [2, 1], [1.5, 0.2], [1, 1]]}]");
  }
};

TEST_F(PartPlaces, OfALabelThatNoPixelHasAreWarnedOfByName) {
  const BuildResult built = build_scene(with_parts(kFront, "labels.png"), {}, progress_);
  const auto named = [&](const std::string& name) {
    return std::count_if(built.report.warnings.begin(), built.report.warnings.end(), [&](const std::string& text) {
      return text.find("'" + name + "' is nowhere") != std::string::npos;
    });
  };
  EXPECT_EQ(named("lost"), 1);
  EXPECT_EQ(named("left") + named("notch"), 0);
  const scene::SceneDescription& scene = built.scene->description();
  const scene::PartConfig* part = scene::part_at(scene, {0.0, 0.5, 0.0});
  ASSERT_NE(part, nullptr);
  EXPECT_EQ(part->name, "left");
  EXPECT_EQ(scene::part_at(scene, {1.5, 0.6, 0.0}), nullptr) << "in the notch, right of the label";
  EXPECT_EQ(scene::part_at(scene, {1.5, 0.1, 0.0})->name, "notch");
}

TEST_F(PartPlaces, OfALabelImageThatCannotBeReadStopTheBuildBeforeItBegins) {
  write_file(folder_ / "labels.png", "no picture");
  write_file(folder_ / "hall.xyz", "no scan\n");
  try {
    static_cast<void>(build_scene(with_parts(kFront, "labels.png"), {}, progress_));
    FAIL() << "a broken label image was built with";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("labels.png"), std::string::npos) << error.what();
  }
}

TEST_F(SoundPlaces, OfALabelImageThatCannotBeReadStopTheBuildBeforeItBegins) {
  write_file(folder_ / "labels.png", "no picture");
  write_file(folder_ / "hall.xyz", "no scan\n");
  try {
    static_cast<void>(build_scene(
        config(kFront, "{labels: labels.png, regions: [{name: a, label: 3, material: wood}]}"), {}, progress_));
    FAIL() << "a broken label image was built with";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("labels.png"), std::string::npos) << error.what();
  }
}

TEST_F(PartPlaces, OfATurnedObjectAreTheSameAndTheFolderHoldsTheLabels) {
  const std::string labels = "{file: labels.png, bounds_m: [-0.5, 0, 2.5, 1.5]}";
  static_cast<void>(build_scene_folder(with_parts(kTurned, labels), {}, folder_ / "scene", progress_));
  std::filesystem::rename(folder_ / "scene", folder_ / "elsewhere");
  std::filesystem::remove(folder_ / "labels.png");
  const scene::ScenePointer scene = scene::open_scene(folder_ / "elsewhere");
  ASSERT_TRUE(scene->description().region_from_grid);
  // x of the grid is -y of the regions' frame, y of the grid is its x.
  const auto left = scene::part_place(*scene, 0);
  ASSERT_TRUE(left);
  EXPECT_NEAR(left->box_m[1], -0.5, 0.05);
  EXPECT_NEAR(left->box_m[3], 1.0, 0.05);
  const auto notch = scene::part_place(*scene, 2);
  ASSERT_TRUE(notch);
  EXPECT_NEAR(notch->box_m[1], 1.0, 0.05);
  EXPECT_NEAR(notch->box_m[3], 2.0, 0.05);
  const Eigen::Vector4d middle =
      *scene->description().region_from_grid * Eigen::Vector4d(notch->middle_m.x(), notch->middle_m.y(), 0.0, 1.0);
  EXPECT_TRUE(scene::area_of(scene->description(), 2).holds(middle.x(), middle.y()));
  EXPECT_FALSE(scene::part_place(*scene, 1));
}

}  // namespace
}  // namespace sparsha::pipeline
