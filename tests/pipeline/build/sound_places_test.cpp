// Where sounds lie when a scene is built: on pillars that are found, under a label image, also of a turned object.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "base/error.h"
#include "base/files.h"
#include "pipeline/build/build.h"
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
  [[nodiscard]] Config config(const std::string& orientation, const std::string& audio) const {
    write_file(folder_ / "hall.yaml", "scans: [{file: hall.xyz, units: m}]\ngrid: {spacing_mm: 10}\norientation: " +
                                          orientation + "\naudio: " + audio + "\n");
    return load_config(folder_ / "hall.yaml");
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
    return to_yaml(build_scene(config(kFront, "{find: pillars}"), options, progress_).scene->description().config);
  };
  EXPECT_EQ(yaml({}), yaml(by_tiles));
}

TEST_F(SoundPlaces, ALabelImageKeepsThePlaceThatItWasDrawnFor) {
  // One grey pixel of value 3; what is in the file does not matter for where it lies.
  write_file(folder_ / "labels.png", "");
  const BuildResult built = build_scene(
      config(kFront, "{labels: labels.png, regions: [{name: a, label: 3, material: wood}]}"), {}, progress_);
  const auto& labels = built.scene->description().config.audio->labels;
  ASSERT_TRUE(labels && labels->bounds_m);
  const Lattice& grid = built.scene->description().levels.front();
  EXPECT_EQ(*labels->bounds_m,
            (std::array<double, 4>{grid.x_m(0), grid.y_m(0), grid.x_m(grid.nx - 1), grid.y_m(grid.ny - 1)}));
  EXPECT_THROW(
      static_cast<void>(build_scene(
          config(kTurned, "{labels: labels.png, regions: [{name: a, label: 3, material: wood}]}"), {}, progress_)),
      Error);
}

}  // namespace
}  // namespace sparsha::pipeline
