// Scenes built through files on disk, byte by byte against scenes built in memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include <fmt/format.h>

#include <Eigen/Core>

#include "base/error.h"
#include "base/files/files.h"
#include "base/yaml/yaml.h"
#include "pipeline/build/build.h"
#include "pipeline/simulate/simulate.h"
#include "scene/scene.h"
#include "tests/pipeline/outofcore/two_builds.h"
#include "tests/support/test_folder.h"

#if !defined(_WIN32)
#include <sys/resource.h>
#include <csignal>
#endif

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

SimulationConfig relief(int nodes, int files) {
  SimulationConfig config;
  config.nodes = nodes;
  config.seed = 4;
  config.surface.form = AccuracyForm{};
  config.surface.back = {BackConfig::Kind::rough, 0.1, 0.003, 0.3};
  config.outlier_fraction = 0.005;
  config.scan = SamplerConfig{2.5, 1.0, files};
  config.write_truth = false;
  return config;
}

class OutOfCore : public TwoBuilds {};

const std::vector<std::string> kAllLayers = {"texture={}", "friction={}", "fill={max_gap_mm: 8}",
                                             "check={samples: 5000}"};

TEST_F(OutOfCore, OneFileGivesTheSameBytesAsInMemory) {
  expect_same_out_of_core(simulated(relief(200, 1), kAllLayers), 40'000);
}

TEST_F(OutOfCore, NeitherThreadsNorTheOrderOfFilesChangeAByte) {
  scene::Config config = simulated(relief(180, 3), kAllLayers);
  build(config, "memory", 0);
  for (const unsigned threads : {1U, 2U, 3U}) {
    std::rotate(config.scans.begin(), config.scans.begin() + 1, config.scans.end());
    build(config, "disk", 30'000, threads);
    // The report lists inputs and their points in the configuration's order.
    auto a = report(folder_ / "memory");
    auto b = report(folder_ / "disk");
    a.erase("inputs");
    b.erase("inputs");
    EXPECT_EQ(a, b);
    EXPECT_TRUE(read_file(folder_ / "memory" / "scene.yaml", kLargest) ==
                read_file(folder_ / "disk" / "scene.yaml", kLargest));
    for (const char* layer : {"height.tif", "mask.tif", "envelope.tif", "curvature.tif"}) {
      EXPECT_TRUE(read_file(folder_ / "memory" / "level-0" / layer, kLargest) ==
                  read_file(folder_ / "disk" / "level-0" / layer, kLargest))
          << layer;
    }
  }
}

TEST_F(OutOfCore, StripsTooFullForMemoryAreCutIntoColumns) {
  // The halo of a node holds up to 17 x 17 bins of about 4 points.
  expect_same_out_of_core(simulated(relief(120, 1)), 6'000);
}

TEST_F(OutOfCore, GridsFinerAndCoarserThanTheCloudAreTheSame) {
  write_simulation(relief(120, 1), folder_ / "scan", progress_);
  for (const char* grid : {"grid={size: 300}", "grid={size: 40}", "grid={}"}) {
    expect_same_out_of_core(scene::load_config(folder_ / "scan" / "sparsha.yaml", {grid}), 25'000);
  }
}

TEST_F(OutOfCore, EveryPointMayBeChecked) {
  expect_same_out_of_core(simulated(relief(100, 2), {"check={samples: all}"}), 15'000);
}

TEST_F(OutOfCore, ColourAndIntensityAreTheSame) {
  SimulationConfig simulation = relief(120, 2);
  simulation.colour = true;
  simulation.intensity = true;
  expect_same_out_of_core(simulated(simulation, {"grid.colour=true", "grid.intensity=true"}), 20'000);
}

TEST_F(OutOfCore, GeoreferencedScansSeenHorizontallyAreTheSame) {
  SimulationConfig simulation = relief(150, 2);
  simulation.origin_m = {450000.25, 5412000.5, 312.0};
  simulation.look_from = {0.6, 0.8, 0.0};
  simulation.up = {0.0, 0.0, 1.0};
  simulation.double_precision = true;
  expect_same_out_of_core(simulated(simulation, {"texture={}"}), 30'000);
}

TEST_F(OutOfCore, CroppedPointsAreFilteredWhileTheyAreStreamed) {
  expect_same_out_of_core(
      simulated(relief(150, 2), {"filters=[{crop: {min_m: [0.2, 0.1, -1], max_m: [0.9, 0.7, 1]}}]", "grid={}"}),
      20'000);
}

TEST_F(OutOfCore, APassAndAPlaneAreFilteredWhileTheyAreStreamed) {
  // The relief's back goes with the plane of its ground.
  expect_same_out_of_core(
      simulated(relief(150, 2),
                {"filters=[{pass: {axis: x, min_m: 0.2}}, {remove_plane: {distance_mm: 20, side: above, "
                 "max_angle_deg: 30}}, {pass: {axis: y, max_m: 0.7}}]",
                 "grid={spacing_mm: 8}"}),
      20'000);
  const nlohmann::json filters = report(folder_ / "disk")["filters"];
  ASSERT_EQ(filters.size(), 3U);
  for (const nlohmann::json& filter : filters) EXPECT_GT(filter["removed"], 0) << filter["name"];
}

TEST_F(OutOfCore, AFilterThatNeedsAllPointsIsRefusedByName) {
  write_simulation(relief(150, 1), folder_ / "scan", progress_);
  for (const std::string name : {"outliers", "radius_outliers", "keep", "smooth", "thin"}) {
    const scene::Config config = scene::load_config(folder_ / "scan" / "sparsha.yaml",
                                                    {"filters=[{pass: {axis: x, min_m: 0.1}}, {" + name + ": }]"});
    BuildOptions options;
    options.memory_points = 10'000;
    Progress progress;
    try {
      build_scene_folder(config, options, folder_ / "disk", progress);
      FAIL() << name << " was not refused";
    } catch (const Error& error) {
      EXPECT_NE(error.wrong().find("'" + name + "'"), std::string::npos) << error.what();
      EXPECT_NE(error.expected().find("--memory"), std::string::npos) << error.what();
    }
  }
}

TEST_F(OutOfCore, AVoxelFilterStreamsIntoMemory) {
  SimulationConfig simulation = relief(150, 2);
  simulation.colour = true;
  simulation.intensity = true;
  const std::string crop = "{crop: {min_m: [0.2, 0.1, -1], max_m: [0.9, 0.7, 1]}}";
  const std::string filters = "filters=[" + crop + ", {voxel: {leaf_mm: 12}}, {outliers: {neighbours: 8, sigma: 3}}]";
  const scene::Config config = simulated(simulation, {filters, "grid={spacing_mm: 8, colour: true, intensity: true}"});
  build(config, "memory", 0);
  BuildOptions options;
  options.memory_points = 20'000;
  build_scene_folder(config, options, folder_ / "disk", progress_);
  expect_same(folder_ / "memory", folder_ / "disk");
  options.memory_points = 1000;  // fewer than voxels
  Progress progress;
  try {
    build_scene_folder(config, options, folder_ / "disk", progress);
    FAIL() << "more voxels than allowed";
  } catch (const Error& error) {
    EXPECT_NE(error.wrong().find("'voxel'"), std::string::npos) << error.what();
  }
}

TEST_F(OutOfCore, FarOutliersAndDuplicatesAreTheSame) {
  scene::Config config = simulated(relief(120, 1), {"grid={}"});
  std::ofstream far(folder_ / "scan" / "far.xyz");
  far << "1e6 2e6 -3e6\n4000 -4000 4000\n4000 -4000 4000\n";
  far.close();
  config.scans.push_back(config.scans.front());
  scene::ScanConfig scan;
  scan.file = folder_ / "scan" / "far.xyz";
  scan.units.unit = scene::LengthUnit::m;
  config.scans.push_back(scan);
  expect_same_out_of_core(config, 20'000);
}

/// The simulated points with a scan file's own precision: text, or whole steps of a LAS file.
std::vector<std::array<std::int32_t, 3>> whole_steps(double step_m) {
  const SimulatedScan scan = generate(relief(100, 1));
  std::vector<std::array<std::int32_t, 3>> points;
  for (const Eigen::Vector3d& p : scan.points_m) {
    points.push_back({static_cast<std::int32_t>(std::lround(p.x() / step_m)),
                      static_cast<std::int32_t>(std::lround(p.y() / step_m)),
                      static_cast<std::int32_t>(std::lround(p.z() / step_m))});
  }
  return points;
}

scene::Config config_of(const fs::path& file) {
  scene::Config config;
  scene::ScanConfig scan;
  scan.file = file;
  scan.units.unit = scene::LengthUnit::m;
  config.scans = {scan};
  config.check = scene::CheckConfig{3000};
  return config;
}

TEST_F(OutOfCore, TextIsTheSame) {
  std::ofstream text(folder_ / "scan.xyz");
  for (const auto& p : whole_steps(1e-5))
    text << fmt::format("{:.5f} {:.5f} {:.5f}\n", p[0] * 1e-5, p[1] * 1e-5, p[2] * 1e-5);
  text.close();
  expect_same_out_of_core(config_of(folder_ / "scan.xyz"), 15'000);
}

TEST_F(OutOfCore, WhatADepthCameraDidNotSeeIsInvalidAsInMemory) {
  std::string points;
  for (const auto& p : whole_steps(1e-5)) {
    points += fmt::format("{:.5f} {:.5f} {:.5f}\n", p[0] * 1e-5, p[1] * 1e-5, p[2] * 1e-5 - 2.0);
    if (p[0] % 3 == 0) points += "0 0 0\n";
  }
  write_file(folder_ / "camera.xyz", points);
  expect_same_out_of_core(config_of(folder_ / "camera.xyz"), 15'000);
  const std::string warnings = report(folder_ / "disk")["warnings"].dump();
  EXPECT_NE(warnings.find("stand at 0 0 0"), std::string::npos) << warnings;
}

TEST_F(OutOfCore, PlyInTextIsTheSame) {
  // Properties in an order of their own, lines of Windows, no faces.
  const auto points = whole_steps(1e-5);
  std::ofstream ply(folder_ / "scan.ply", std::ios::binary);
  ply << "ply\r\nformat ascii 1.0\r\ncomment points only\r\nelement vertex " << points.size()
      << "\r\nproperty double z\r\nproperty uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\n"
         "property double x\r\nproperty float intensity\r\nproperty double y\r\nend_header\r\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i];
    ply << fmt::format("{:.5f} {} {} {} {:.5f} {} {:.5f}\r\n", p[2] * 1e-5, i % 256, i / 7 % 256, i / 3 % 256,
                       p[0] * 1e-5, 0.25 * static_cast<double>(i % 1000), p[1] * 1e-5);
  }
  ply.close();
  scene::Config config = config_of(folder_ / "scan.ply");
  config.grid.colour = true;
  config.grid.intensity = true;
  expect_same_out_of_core(config, 15'000);
}

/// One station of the sheet as a PTX file has it, with x beyond `from` and up to `to`.
std::string ptx_station(double from, double to, bool colour) {
  std::string rows;
  std::size_t count = 0;
  for (const auto& p : whole_steps(1e-5)) {
    const double x = p[0] * 1e-5;
    if (x < from || x >= to) continue;
    rows += fmt::format("{:.5f} {:.5f} {:.5f} 0.5{}\n", x, p[1] * 1e-5, p[2] * 1e-5, colour ? " 200 100 50" : "");
    ++count;
  }
  return fmt::format("{}\n1\n0 0 1\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", count) + rows;
}

TEST_F(OutOfCore, GreyAndColouredStationsAreTheSameAndGreyIsNoColour) {
  double low = 1e9;
  double high = -1e9;
  for (const auto& p : whole_steps(1e-5)) {
    low = std::min(low, p[0] * 1e-5);
    high = std::max(high, p[0] * 1e-5);
  }
  const double middle = 0.5 * (low + high);
  write_file(folder_ / "scan.ptx", ptx_station(low, middle, false) + ptx_station(middle, high, true));
  scene::Config config = config_of(folder_ / "scan.ptx");
  config.grid.colour = true;
  config.grid.intensity = true;
  expect_same_out_of_core(config, 15'000);
  const scene::Layers level = scene::open_scene(folder_ / "disk")->read_level(0);
  const scene::Lattice& lattice = level.grid.lattice;
  std::size_t grey = 0;
  std::size_t coloured = 0;
  std::size_t none = 0;  // nodes that no used point is near
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t n = lattice.index(i, j);
      if (level.grid.state[n] != scene::NodeState::measured) continue;
      const double x = lattice.x_m(i);
      if (x < middle - lattice.spacing_m) {
        EXPECT_EQ(level.colour_rgba[n], kNoColour);
        ++grey;
      } else if (x > middle + lattice.spacing_m) {
        EXPECT_TRUE(level.colour_rgba[n] == 0xFF3264C8U || level.colour_rgba[n] == kNoColour) << "mixed";
        coloured += level.colour_rgba[n] == kNoColour ? 0 : 1;
        none += level.colour_rgba[n] == kNoColour ? 1 : 0;
      }
    }
  EXPECT_GT(std::min(grey, coloured), 100U);
  EXPECT_LT(none, coloured / 20);
}

TEST_F(OutOfCore, LasIsTheSame) {
  // LAS 1.2, point format 0, steps of 10 um.
  const auto points = whole_steps(1e-5);
  std::string bytes(227, '\0');
  const auto set = [&](std::size_t at, const auto& value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
  std::memcpy(bytes.data(), "LASF", 4);
  bytes[24] = 1;
  bytes[25] = 2;
  set(94, std::uint16_t{227});
  set(96, std::uint32_t{227});
  set(105, std::uint16_t{20});
  set(107, static_cast<std::uint32_t>(points.size()));
  for (std::size_t k = 0; k < 3; ++k) set(131 + 8 * k, 1e-5);
  for (const auto& p : points) {
    std::string record(20, '\0');
    std::memcpy(record.data(), p.data(), 12);
    bytes += record;
  }
  write_file(folder_ / "scan.las", bytes);
  expect_same_out_of_core(config_of(folder_ / "scan.las"), 15'000);
}

/// The error that building under that option gives.
Error refused(const scene::Config& config, const BuildOptions& options, const fs::path& scene) {
  Progress progress;
  try {
    build_scene_folder(config, options, scene, progress);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "the limit was not refused";
  return usage_error("");
}

TEST_F(OutOfCore, WhatCannotBeKeptIsRefusedByNameAndLeavesNothing) {
  BuildOptions options;
  options.memory_points = 10'000;
  const scene::Config outliers = simulated(relief(100, 1), {"filters=[{outliers: {neighbours: 8, sigma: 2}}]"});
  EXPECT_NE(refused(outliers, options, folder_ / "scene").wrong().find("'outliers'"), std::string::npos);
  scene::Config plain = outliers;
  plain.filters.clear();
  options.memory_points = 20;  // fewer than the halo of a node
  EXPECT_NE(refused(plain, options, folder_ / "scene").wrong().find("a single node"), std::string::npos);
  options = {};
  options.memory_bytes = 1'000'000;
  EXPECT_NE(refused(plain, options, folder_ / "scene").wrong().find("MB"), std::string::npos);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1) << "only the scan is left";
}

TEST_F(OutOfCore, ManyPointsToANodeNeedNoMemoryForAllOfThem) {
  // 160 000 points on 6 x 5 nodes: some 4000 to a node, of which 1024 decide.
  const scene::Config coarse = simulated(relief(400, 1), {"grid={size: 6}", "check={samples: 5000}"});
  expect_same_out_of_core(coarse, 150'000);
}

TEST_F(OutOfCore, OneNodeWithMostOfThePointsNeedsNoMemoryForAllOfThem) {
  std::string text;
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto add = [&](double x, double y) { text += fmt::format("{:.7f} {:.7f} {:.7f}\n", x, y, 0.05 * x * y); };
  for (int k = 0; k < 10'000; ++k) add(unit(random), unit(random));
  for (int k = 0; k < 20'000; ++k) add(0.51 + 0.004 * unit(random), 0.51 + 0.004 * unit(random));
  write_file(folder_ / "crowd.xyz", text);
  const std::string yaml =
      "scans: [{file: crowd.xyz, units: m}]\ngrid: {spacing_mm: 25, bounds_m: [0, 0, 1, 1]}\ncheck: {samples: 2000}\n";
  expect_same_out_of_core(scene::parse_config(yaml::parse_text(yaml, "crowd"), folder_.path()), 9'000);
}

TEST_F(OutOfCore, ACrossCheckOfMorePointsThanFitIsRefused) {
  // About 400 000 points: 19 MB of sample beside 70 MB for the program.
  scene::Config config = simulated(relief(600, 1), {"check={samples: all}"});
  BuildOptions options;
  options.memory_bytes = 80'000'000;
  EXPECT_NE(refused(config, options, folder_ / "scene").wrong().find("cross-check"), std::string::npos);
  config.check->samples = 5000;
  build_scene_folder(config, options, folder_ / "scene", progress_);
  EXPECT_TRUE(kept_on_disk(folder_ / "scene"));
}

TEST_F(OutOfCore, CancellingInAnyStageKeepsTheOldSceneAndLeavesNothingElse) {
  const scene::Config config = simulated(relief(100, 1), kAllLayers);
  build(config, "scene", 10'000);
  const std::string before = read_file(folder_ / "scene" / "scene.yaml", kLargest);
  for (const char* stage : {"points to disk", "project", "cross-check"}) {
    for (const int updates : {1, 3}) {
      Progress* cancelled = nullptr;
      int seen = 0;
      bool here = false;
      Progress progress([&](const ProgressUpdate& update) {
        if (update.kind == ProgressUpdate::Kind::stage) here = update.text == stage;
        if (here && ++seen == updates) cancelled->cancel();
      });
      cancelled = &progress;
      BuildOptions options;
      options.memory_points = 10'000;
      EXPECT_THROW(build_scene_folder(config, options, folder_ / "scene", progress), Cancelled) << stage;
    }
  }
  EXPECT_EQ(read_file(folder_ / "scene" / "scene.yaml", kLargest), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 2);
}

#if !defined(_WIN32)
TEST_F(OutOfCore, AFullDiskIsAnErrorThatKeepsTheOldScene) {
  const scene::Config config = simulated(relief(150, 1));
  build(config, "scene", 20'000);
  // A limit on the size of files stands for the full disk: what is on disk has some 600 kB.
  struct rlimit old {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  auto* const handler = std::signal(SIGXFSZ, SIG_IGN);
  struct rlimit little = old;
  little.rlim_cur = 300'000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &little), 0);
  BuildOptions options;
  options.memory_points = 20'000;
  const Error error = refused(config, options, folder_ / "scene");
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(error.kind(), ErrorKind::failure);
  EXPECT_NE(error.expected().find("room on the disk"), std::string::npos) << error.what();
  EXPECT_TRUE(fs::exists(folder_ / "scene" / "scene.yaml"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 2);
}
#endif

}  // namespace
}  // namespace sparsha::pipeline
