// Builds that are killed and begun again give the bytes of one that was not.
#include <gtest/gtest.h>

#if !defined(_WIN32)
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <random>
#include <thread>

#include <gmock/gmock.h>

#include "pipeline/outofcore/finished_tiles.h"
#include "tests/pipeline/outofcore/two_builds.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

class Resume : public TwoBuilds {
 protected:
  scene::Config relief(const std::vector<std::string>& settings = {"texture={}", "fill={max_gap_mm: 8}",
                                                                   "check={samples: 5000}"},
                       std::uint64_t seed = 6) {
    SimulationConfig simulation;
    simulation.nodes = 220;
    simulation.seed = seed;
    simulation.surface.form = AccuracyForm{};
    simulation.outlier_fraction = 0.005;
    simulation.scan = SamplerConfig{2.5, 1.0, 2};
    simulation.write_truth = false;
    return simulated(simulation, settings);
  }
  [[nodiscard]] BuildOptions keeping(const std::string& program = "this program") const {
    BuildOptions options;
    options.threads = 2;
    options.memory_points = 12'000;
    options.finished_tiles = tiles_;
    options.program = program;
    return options;
  }
  /// Builds in a process of its own and kills it after that time; false when it was done before.
  bool killed(const scene::Config& config, std::chrono::microseconds after) {
    const pid_t child = ::fork();
    if (child == 0) {
      Progress progress;
      build_scene_folder(config, keeping(), folder_ / "resumed", progress);
      ::_exit(0);
    }
    std::this_thread::sleep_for(after);
    ::kill(child, SIGKILL);
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return WIFSIGNALED(status);
  }
  /// Ends a build when it has measured about that share of its tiles, and says how many are there.
  std::size_t stop_at(const scene::Config& config, double share) {
    Progress* cancelled = nullptr;
    bool projects = false;
    Progress progress([&](const ProgressUpdate& update) {
      if (update.kind == ProgressUpdate::Kind::stage) projects = update.text.starts_with("project (");
      if (projects && update.kind == ProgressUpdate::Kind::fraction && update.fraction > 0.45 + share * 0.4)
        cancelled->cancel();
    });
    cancelled = &progress;
    EXPECT_THROW(build_scene_folder(config, keeping(), folder_ / "resumed", progress), Cancelled);
    return tiles_of_last_build();
  }
  [[nodiscard]] std::size_t tiles_of_last_build() const {
    const std::string text = read_file(tiles_, kLargest);
    const std::string first = text.substr(0, text.find('\n'));
    return FinishedTiles(tiles_, first.substr(first.rfind(' ') + 1)).found();
  }
  /// Stages of a build that goes on.
  std::vector<std::string> go_on(const scene::Config& config, const std::string& program = "this program") {
    Progress progress;
    build_scene_folder(config, keeping(program), folder_ / "resumed", progress);
    std::vector<std::string> names;
    for (const StageTime& stage : progress.stages()) names.push_back(stage.name);
    for (const std::string& warning : progress.warnings()) names.push_back("warning: " + warning);
    return names;
  }

  const fs::path tiles_ = folder_ / "kept";
};

TEST_F(Resume, ABuildKilledAtRandomMomentsGoesOnToTheSameBytes) {
  const scene::Config config = relief();
  build(config, "plain", 12'000);
  std::mt19937 random(11);
  int kills = 0;
  std::uniform_int_distribution<int> pause(1'000, 400'000);  // microseconds
  // Kills come later and later, so that it is done some time on however slow a machine.
  for (int longest = 1; killed(config, std::chrono::microseconds(pause(random)) * longest / 4); ++longest) ++kills;
  EXPECT_GT(kills, 0);
  expect_same(folder_ / "plain", folder_ / "resumed");
  EXPECT_FALSE(fs::exists(tiles_));
}

TEST_F(Resume, TilesThatAreThereAreNotMeasuredAgain) {
  const scene::Config config = relief();
  build(config, "plain", 12'000);
  const std::size_t few = stop_at(config, 0.2);
  EXPECT_GT(few, 0U);
  const std::size_t more = stop_at(config, 0.7);
  EXPECT_GT(more, few);
  EXPECT_THAT(go_on(config), ::testing::Contains("project (" + std::to_string(more) + " tiles are there)"));
  expect_same(folder_ / "plain", folder_ / "resumed");
  EXPECT_FALSE(fs::exists(tiles_));
}

TEST_F(Resume, WhatWasKeptDecidesTheScene) {
  // A tile with other heights than the points have would be taken as it is: so that tiles are really gone on from.
  const scene::Config config = relief({});
  build(config, "plain", 12'000);
  stop_at(config, 0.5);
  const std::string text = read_file(tiles_, kLargest);
  const std::string key = text.substr(0, text.find('\n')).substr(text.substr(0, text.find('\n')).rfind(' ') + 1);
  struct Borders {
    std::int32_t first_row, last_row, first_column, last_column;
  } borders{};
  std::memcpy(&borders, text.data() + text.find('\n') + 1, sizeof(borders));
  Tile tile;
  tile.first_row = borders.first_row;
  tile.last_row = borders.last_row;
  tile.first_column = borders.first_column;
  tile.last_column = borders.last_column;
  TileNodes nodes;
  ASSERT_TRUE(FinishedTiles(tiles_, key).take(tile, nodes));
  for (float& height : nodes.height_m) height += 1e-3F;
  fs::remove(tiles_);
  FinishedTiles(tiles_, key).add(tile, nodes);
  go_on(config);
  EXPECT_FALSE(read_file(folder_ / "plain" / "level-0" / "height.tif", kLargest) ==
               read_file(folder_ / "resumed" / "level-0" / "height.tif", kLargest));
}

TEST_F(Resume, TilesOfAnotherConfigurationScanOrProgramAreBegunAnewWithAWarning) {
  const scene::Config config = relief();
  const auto begins_anew = ::testing::Contains(::testing::HasSubstr("begins anew"));
  stop_at(config, 0.5);
  EXPECT_THAT(go_on(relief({"grid={size: 150}"})), begins_anew);
  stop_at(config, 0.5);
  EXPECT_THAT(go_on(config, "another program"), begins_anew);
  stop_at(config, 0.5);
  EXPECT_THAT(go_on(relief({"texture={}", "fill={max_gap_mm: 8}", "check={samples: 5000}"}, 7)), begins_anew);
  // What only later stages read does not matter.
  stop_at(relief(), 0.5);
  EXPECT_THAT(go_on(relief({"check={samples: 100}"})), ::testing::Not(begins_anew));
}

TEST_F(Resume, WhatIsBuiltInMemoryAloneSaysSo) {
  BuildOptions options = keeping();
  options.memory_points = 0;
  Progress progress;
  build_scene_folder(relief({"filters=[{outliers: {neighbours: 8, sigma: 2}}]"}), options, folder_ / "scene", progress);
  EXPECT_THAT(progress.warnings(), ::testing::Contains(::testing::HasSubstr("built in memory as a whole")));
  EXPECT_FALSE(fs::exists(tiles_));
}

}  // namespace
}  // namespace sparsha::pipeline
#endif
