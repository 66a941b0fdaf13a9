// A scene built in memory, and the same through files on disk, byte by byte.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "base/files/files.h"
#include "pipeline/build/build.h"
#include "pipeline/simulate/simulate.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {

class TwoBuilds : public ::testing::Test {
 protected:
  static constexpr std::size_t kLargest = 1U << 30U;  // bytes of a file

  scene::Config simulated(const SimulationConfig& simulation, const std::vector<std::string>& settings = {}) {
    write_simulation(simulation, folder_ / "scan", progress_);
    return scene::load_config(folder_ / "scan" / "sparsha.yaml", settings);
  }
  /// Every file of the scene, and of the report all but times and memory.
  static void expect_same(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::size_t compared = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(a)) {
      const std::filesystem::path relative = entry.path().lexically_relative(a);
      const bool counts = relative == "scene.yaml" || relative.string().starts_with("level-");
      if (!entry.is_regular_file() || !counts) continue;
      ASSERT_TRUE(std::filesystem::exists(b / relative)) << relative;
      EXPECT_TRUE(read_file(entry.path(), kLargest) == read_file(b / relative, kLargest)) << relative << " differs";
      ++compared;
    }
    EXPECT_GE(compared, 4U);
    EXPECT_EQ(report(a), report(b));
  }
  static nlohmann::json report(const std::filesystem::path& scene) {
    auto json = nlohmann::json::parse(read_file(scene / "report.json", kLargest));
    for (const char* key : {"stages", "total_seconds", "peak_rss_bytes"}) json.erase(key);
    return json;
  }
  static bool kept_on_disk(const std::filesystem::path& scene) {
    const auto json = nlohmann::json::parse(read_file(scene / "report.json", kLargest));
    return std::any_of(json["stages"].begin(), json["stages"].end(),
                       [](const auto& stage) { return stage["name"] == "points to disk"; });
  }
  void build(const scene::Config& config, const std::string& name, std::uint64_t points, unsigned threads = 2) {
    BuildOptions options;
    options.threads = threads;
    options.memory_points = points;
    Progress progress;
    build_scene_folder(config, options, folder_ / name, progress);
    EXPECT_EQ(kept_on_disk(folder_ / name), points > 0);
  }
  /// In memory and with so few points at once.
  void expect_same_out_of_core(const scene::Config& config, std::uint64_t points) {
    build(config, "memory", 0);
    build(config, "disk", points);
    expect_same(folder_ / "memory", folder_ / "disk");
  }

  const test::TestFolder folder_;
  Progress progress_;
};

}  // namespace sparsha::pipeline
