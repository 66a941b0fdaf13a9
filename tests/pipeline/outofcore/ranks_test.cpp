// Scenes that several ranks build, byte by byte against those of one process. Ranks are threads here; the plug-in for
// MPI is tested with processes (tests/tools/mpi_test.py).
#include "pipeline/cluster/ranks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "base/error.h"
#include "pipeline/build/build.h"
#include "pipeline/build/on_ranks.h"
#include "pipeline/simulate/simulate.h"
#include "scene/config/config.h"
#include "scene/scene.h"
#include "tests/pipeline/outofcore/rank_threads.h"
#include "tests/pipeline/outofcore/two_builds.h"

namespace sparsha::pipeline {
namespace {

using test::on_ranks;

TEST(Ranks, MessagesOfAnySizeArriveWholeInSmallRounds) {
  constexpr std::size_t kSize = 3;
  const auto message = [](std::size_t from, std::size_t to) {
    Ranks::Bytes bytes(from == 1 && to == 2 ? 0 : 1000 * from + 37 * to);
    for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<std::byte>(k * 7 + from * 31 + to);
    return bytes;
  };
  on_ranks(kSize, 100, [&](const Ranks& ranks, Progress&) {
    std::vector<Ranks::Bytes> to;
    for (std::size_t r = 0; r < kSize; ++r) to.push_back(message(ranks.number(), r));
    const std::vector<Ranks::Bytes> got = ranks.all_to_all(to);
    for (std::size_t r = 0; r < kSize; ++r) EXPECT_EQ(got[r], message(r, ranks.number()));

    Ranks::Bytes joined = message(ranks.number(), 0);
    ranks.join(joined);
    Ranks::Bytes expected;
    for (std::size_t r = 0; r < kSize; ++r) {
      const Ranks::Bytes part = message(r, 0);
      expected.insert(expected.end(), part.begin(), part.end());
    }
    EXPECT_EQ(joined, expected);
    std::size_t merges = 0;
    const Ranks::Bytes merged = ranks.merged(message(ranks.number(), 0), [&](const auto& first, const auto& second) {
      ++merges;
      Ranks::Bytes two = second;
      two.insert(two.begin(), first.begin(), first.end());
      return two;
    });
    EXPECT_EQ(merged, expected);
    EXPECT_EQ(merges, ranks.is_root() ? 2U : 0U);
    const std::vector<Ranks::Bytes> gathered = ranks.gather(message(ranks.number(), 1));
    for (std::size_t r = 0; r < kSize; ++r) EXPECT_EQ(gathered[r], ranks.is_root() ? message(r, 1) : Ranks::Bytes());
  });
}

class SharedBuild : public TwoBuilds {
 protected:
  static SimulationConfig relief(int nodes, int files) {
    SimulationConfig config;
    config.nodes = nodes;
    config.seed = 11;
    config.surface.form = AccuracyForm{};
    config.outlier_fraction = 0.005;
    config.scan = SamplerConfig{2.5, 1.0, files};
    config.write_truth = false;
    return config;
  }
  void build_on(std::size_t size, const scene::Config& config, const std::string& name, std::uint64_t points = 0) {
    on_ranks(size, std::size_t{1} << 16U, [&](const Ranks& ranks, Progress& progress) {
      BuildOptions options;
      options.threads = 1;
      options.ranks = &ranks;
      options.memory_points = points;
      if (ranks.is_root()) {
        build_scene_folder(config, options, folder_ / name, progress);
      } else {
        take_part_in_build(config, options, folder_ / name, progress);
      }
    });
  }

  /// That one process and several have drawn the same, and all of them.
  void expect_same_pictures(const std::vector<std::string>& names) const {
    for (const std::string& name : names) {
      ASSERT_TRUE(std::filesystem::exists(folder_ / "alone" / name)) << name;
      ASSERT_TRUE(std::filesystem::exists(folder_ / "shared" / name)) << name;
      EXPECT_TRUE(read_file(folder_ / "alone" / name, kLargest) == read_file(folder_ / "shared" / name, kLargest))
          << name;
    }
  }
};

const std::vector<std::string> kLayers = {"texture={}", "friction={}", "fill={max_gap_mm: 8}", "check={samples: 5000}"};

TEST_F(SharedBuild, NeitherTheNumberOfRanksNorTheOrderOfFilesChangesAByte) {
  scene::Config config = simulated(relief(150, 3), kLayers);
  build(config, "alone", 0);
  for (const std::size_t size : {1U, 2U, 3U, 8U}) {
    build_on(size, config, "shared");
    expect_same(folder_ / "alone", folder_ / "shared");
  }
  std::swap(config.scans.front(), config.scans.back());
  build(config, "alone", 0);
  build_on(3, config, "shared");
  expect_same(folder_ / "alone", folder_ / "shared");
}

TEST_F(SharedBuild, ALimitOfPointsARankChangesNoByte) {
  const scene::Config config = simulated(relief(150, 1), kLayers);
  build(config, "alone", 0);
  build_on(2, config, "shared", 20'000);
  expect_same(folder_ / "alone", folder_ / "shared");
}

TEST_F(SharedBuild, ClosedObjectsAndCroppedScansAreTheSameToo) {
  SimulationConfig object = relief(150, 2);
  object.surface.back = {BackConfig::Kind::rough, 0.1, 0.003, 0.3};
  const scene::Config config =
      simulated(object, {"filters=[{crop: {min_m: [-10, -10, -10], max_m: [0.15, 10, 10]}}]", "check={samples: 3000}"});
  build(config, "alone", 0);
  for (const std::size_t size : {1U, 2U, 3U}) {
    build_on(size, config, "shared");
    expect_same(folder_ / "alone", folder_ / "shared");
    expect_same_pictures({"filters.png", "sides.png"});
  }
}

TEST_F(SharedBuild, WhatOneProcessBuildsOnlyIsNamedBeforeAnythingIsRead) {
  const auto wrong = [&](const char* setting) {
    const scene::Config config = simulated(relief(20, 1), {setting});
    try {
      require_fit_for_ranks(config);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(wrong("around={}").find("around: a whole object is built by one process only"), std::string::npos);
  EXPECT_NE(wrong("filters=[{outliers: {neighbours: 8, sigma: 4}}]").find("the filter 'outliers'"), std::string::npos);
  EXPECT_EQ(wrong("filters=[{crop: {min_m: [0, 0, 0], max_m: [1, 1, 1]}}]"), "");
}

TEST_F(SharedBuild, AConfigurationThatOneRankHasOtherwiseEndsAllOfThemWithoutAScene) {
  const scene::Config config = simulated(relief(60, 1));
  const auto wrong = [&](const scene::Config& other, bool grid_only) {
    try {
      on_ranks(3, 1U << 16U, [&](const Ranks& ranks, Progress& progress) {
        BuildOptions options;
        options.threads = 1;
        options.ranks = &ranks;
        if (ranks.is_root()) build_scene_folder(config, options, folder_ / "shared", progress);
        if (ranks.is_root()) return;
        const bool differs = ranks.number() == 1;
        options.grid_only = differs && grid_only;
        take_part_in_build(differs ? other : config, options, folder_ / "shared", progress);
      });
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return std::string(error.what());
    }
    return std::string("a scene was built");
  };
  scene::Config other = config;
  other.scans.front().file = folder_ / "nowhere.ply";
  EXPECT_NE(wrong(other, false).find("rank 1 on here has another configuration"), std::string::npos);
  EXPECT_NE(wrong(other, false).find("nowhere.ply"), std::string::npos);
  other = config;
  other.grid.size = 61;
  EXPECT_NE(wrong(other, false).find("{size: 61, "), std::string::npos) << wrong(other, false);
  EXPECT_NE(wrong(config, true).find("'--only: grid' where that has '--only: '"), std::string::npos);
  const auto left =
      std::distance(std::filesystem::directory_iterator(folder_.path()), std::filesystem::directory_iterator());
  EXPECT_EQ(left, 1);  // the scans' folder
}

TEST(Ranks, ScansThatOneRankReadsOtherwiseAreNamedWithIt) {
  const std::vector<scene::ScanSource> sources = {{"a.ply", "0a", 7}, {"b.ply", "0b", 8}};
  const auto wrong = [&](const std::vector<scene::ScanSource>& other, std::uint64_t points, std::uint64_t invalid) {
    try {
      on_ranks(3, 1U << 16U, [&](const Ranks& ranks, Progress&) {
        const bool differs = ranks.number() == 2;
        require_same_scans(ranks, differs ? other : sources, differs ? points : 15, differs ? invalid : 0);
      });
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.place().file + ": " + error.wrong();
    }
    return std::string();
  };
  EXPECT_EQ(wrong(sources, 15, 0), "");
  EXPECT_EQ(wrong({{"a.ply", "0a", 7}, {"b.ply", "0c", 8}}, 15, 0),
            "b.ply: rank 2 on here has another file here than rank 0");
  EXPECT_EQ(wrong({{"a.ply", "0a", 6}, {"b.ply", "0b", 8}}, 15, 0),
            "a.ply: rank 2 on here has another file here than rank 0");
  EXPECT_EQ(wrong({{"a.ply", "0a", 7}}, 7, 0).substr(0, 7), "b.ply: ");
  EXPECT_EQ(wrong(sources, 14, 1).substr(0, 7), "a.ply: ");
  EXPECT_NE(wrong(sources, 14, 1).find("14 points, 1 invalid ones where that finds 15 points, 0 invalid ones"),
            std::string::npos);
}

}  // namespace
}  // namespace sparsha::pipeline
