// A crop of a COPC file gives the scene that reading all of it would give, from less of the file.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/files/files.h"
#include "pipeline/build/build.h"
#include "pipeline/suggest/suggest.h"
#include "scene/scene.h"
#include "tests/support/copc_file.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

using testing::CopcNode;

/// Waves over 16 x 16 m, a tenth of the points in the root and the others in the cells of level 1.
std::vector<CopcNode> waves() {
  std::mt19937 random(4);
  std::uniform_int_distribution<std::int32_t> place(0, 1600);
  std::vector<CopcNode> nodes = {{0, {0, 0, 0}, {}}};
  for (int i = 0; i < 4; ++i) nodes.push_back({1, {i & 1, i >> 1, 0}, {}});
  for (int i = 0; i < 30000; ++i) {
    const std::int32_t x = place(random), y = place(random);
    const auto z = static_cast<std::int32_t>(400.0 + 60.0 * std::sin(x * 0.005) * std::cos(y * 0.007));
    const std::size_t cell = 1U + (x > 800 ? 1U : 0U) + (y > 800 ? 2U : 0U);
    nodes[i % 10 == 0 ? 0 : cell].points.push_back({x, y, z});
  }
  return nodes;
}

TEST(CroppedCopc, GivesTheSceneOfTheWholeFileFromLessOfIt) {
  const test::TestFolder folder;
  const testing::CopcFile file(waves());
  std::string plain = file.bytes;  // the same points, no longer COPC
  plain[377] = 'x';
  std::string spoilt = file.bytes;  // the cell with the greatest x and y
  std::fill_n(spoilt.begin() + static_cast<std::ptrdiff_t>(file.chunks[4]), file.sizes[4], '\xA5');
  const auto build = [&](const std::string& name, const std::string& bytes) {
    write_file(folder / (name + ".laz"), bytes);
    write_file(
        folder / (name + ".yaml"),
        "scans:\n  - {file: " + name + ".laz, units: m}\n" + "filters:\n  - pass: {axis: x, min_m: 0.5, max_m: 16}\n" +
            "  - crop: {min_m: [0, 0, 0], max_m: [7.5, 7.5, 16]}\n" +
            "orientation: {look_from: [0, 0, 1], up: [0, 1, 0]}\ngrid: {spacing_mm: 200}\ncheck: {samples: all}\n");
    Progress progress;
    return build_scene_folder(scene::load_config(folder / (name + ".yaml")), {}, folder / name, progress);
  };
  const BuildResult all = build("all", plain);
  const BuildResult some = build("some", spoilt);
  EXPECT_EQ(some.report.points.read, 30000U);
  EXPECT_EQ(some.report.points.read, all.report.points.read);
  EXPECT_EQ(some.report.points.filtered, all.report.points.filtered);
  EXPECT_EQ(some.report.points.used, all.report.points.used);
  EXPECT_EQ(some.report.points.outlier, all.report.points.outlier);
  const scene::Lattice& lattice = some.scene->description().levels.front();
  EXPECT_EQ(lattice.nx, all.scene->description().levels.front().nx);
  EXPECT_EQ(lattice.ny, all.scene->description().levels.front().ny);
  EXPECT_NEAR(some.scene->description().noise_m, all.scene->description().noise_m, 1e-6);
  EXPECT_NEAR(some.report.check->cloud_to_surface.rms_m, all.report.check->cloud_to_surface.rms_m, 1e-6);
  std::uint64_t removed = 0;
  for (const auto& filter : some.report.filters) removed += filter.removed;
  EXPECT_EQ(removed, some.report.points.filtered);
}

TEST(CroppedCopc, OutOfCoreCountsTheSame) {
  const test::TestFolder folder;
  write_file(folder / "a.laz", testing::CopcFile(waves()).bytes);
  write_file(folder / "a.yaml",
             "scans:\n  - {file: a.laz, units: m}\n"
             "filters:\n  - crop: {min_m: [0, 0, 0], max_m: [7.5, 7.5, 16]}\n"
             "orientation: {look_from: [0, 0, 1], up: [0, 1, 0]}\ngrid: {spacing_mm: 200}\n");
  Progress progress;
  const scene::Config config = scene::load_config(folder / "a.yaml");
  const BuildResult memory = build_scene_folder(config, {}, folder / "memory", progress);
  BuildOptions options;
  options.memory_points = 5000;
  const BuildResult disk = build_scene_folder(config, options, folder / "disk", progress);
  EXPECT_EQ(disk.report.points.read, 30000U);
  EXPECT_EQ(disk.report.points.filtered, memory.report.points.filtered);
  EXPECT_EQ(disk.report.points.used, memory.report.points.used);
}

TEST(DamagedLazWithoutConfiguration, IsRefusedAndIsBuiltFromItsWholeChunksWhenForced) {
  const test::TestFolder folder;
  testing::CopcFile file(waves());
  file.bytes[377] = 'x';  // plain LAZ
  std::fill_n(file.bytes.begin() + static_cast<std::ptrdiff_t>(file.chunks[4]), file.sizes[4], '\xA5');
  write_file(folder / "a.laz", file.bytes);
  Progress progress;
  EXPECT_THROW((void)suggest_config({folder / "a.laz"}, {}, progress), Error);
  SuggestOptions options;
  options.whole_chunks_only = true;
  const Suggestion suggestion = suggest_config({folder / "a.laz"}, {}, progress, options);
  EXPECT_NE(suggestion.yaml.find("1 damaged LAZ chunks are left out"), std::string::npos) << suggestion.yaml;
  BuildOptions forced;
  forced.force = true;
  const BuildResult built = build_scene_folder(suggestion.config, forced, folder / "scene", progress);
  EXPECT_GT(built.report.points.read, 20000U);
  EXPECT_LT(built.report.points.read, 25000U);
}

TEST(CroppedCopc, ABoxBesideAllPointsIsTheErrorOfAnyScan) {
  const test::TestFolder folder;
  write_file(folder / "a.laz", testing::CopcFile(waves()).bytes);
  write_file(folder / "a.yaml",
             "scans:\n  - {file: a.laz, units: m}\n"
             "filters:\n  - crop: {min_m: [50, 0, 0], max_m: [60, 7.5, 16]}\n"
             "orientation: {look_from: [0, 0, 1], up: [0, 1, 0]}\n");
  Progress progress;
  try {
    (void)build_scene_folder(scene::load_config(folder / "a.yaml"), {}, folder / "scene", progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("crop"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace sparsha::pipeline
