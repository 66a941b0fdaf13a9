// Scans that several ranks read together: each reads its stretch, and all come to what one process finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <mutex>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "base/files/files.h"
#include "base/threads/thread_pool.h"
#include "pipeline/filter/streamed.h"
#include "pipeline/scan/read_bytes.h"
#include "pipeline/scan/set.h"
#include "pipeline/scan/shared_reading.h"
#include "scene/scene.h"
#include "tests/pipeline/outofcore/rank_threads.h"
#include "tests/support/las_files.h"
#include "tests/support/scan_files.h"
#include "tests/support/test_folder.h"
#include "tests/support/wave_files.h"

namespace sparsha::pipeline {
namespace {

TEST(SharedReading, NoByteOfRecordsOfOneLengthIsReadByTwoRanksAndNoneIsLeftOut) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 300; ++round) {
    std::vector<std::uint64_t> bytes(1 + random() % 12);
    std::vector<bool> of_one_length(bytes.size());
    for (std::size_t k = 0; k < bytes.size(); ++k) {
      bytes[k] = random() % 4 == 0 ? 0 : random() >> (4 + random() % 50);
      of_one_length[k] = random() % 3 > 0;
    }
    const std::uint64_t all = std::accumulate(bytes.begin(), bytes.end(), std::uint64_t{0});
    const std::size_t size = 1 + random() % 9;
    std::vector<std::vector<FileShare>> shares;
    for (std::size_t r = 0; r < size; ++r) shares.push_back(shares_of_files(bytes, of_one_length, r, size));
    std::vector<double> read(size);
    for (std::size_t k = 0; k < bytes.size(); ++k) {
      std::uint64_t next = 0, whole = 0, digests = 0;
      const std::uint64_t records = bytes[k] / 12;
      for (std::size_t r = 0; r < size; ++r) {
        const FileShare& share = shares[r][k];
        ASSERT_EQ(share.kind, shares[0][k].kind);
        digests += share.digests ? 1 : 0;
        if (share.kind == FileShare::Kind::part && share.reads) {
          ASSERT_EQ(record_at(records, share.from), next) << "rank " << r << " of " << size << ", file " << k;
          next = record_at(records, share.to);
          read[r] += static_cast<double>(bytes[k]) * (share.to - share.from);
        }
        whole += share.kind == FileShare::Kind::whole_by_one && share.reads ? 1 : 0;
      }
      EXPECT_EQ(digests, 1U);
      const FileShare::Kind kind = shares[0][k].kind;
      if (kind == FileShare::Kind::part) {
        EXPECT_EQ(next, records);
      } else if (kind == FileShare::Kind::whole_by_one) {
        EXPECT_EQ(whole, 1U);
      } else if (size > 1) {
        EXPECT_GE(bytes[k] + 2, all / size) << "a small file is read by all";
      }
    }
    // Rounding of a share of a file: 2^-52 of its bytes.
    for (std::size_t r = 0; r < size; ++r)
      EXPECT_LE(read[r], static_cast<double>(all) / static_cast<double>(size) + 2.0 + 1e-15 * static_cast<double>(all));
  }
}

using Point = std::array<std::uint32_t, 5>;  // bits, since an intensity that is not there is no number

struct Found {
  std::vector<Point> points;  ///< of all ranks, in no order
  std::uint64_t valid = 0, invalid = 0, beyond = 0, faces = 0;
  Eigen::Vector3d origin_m;
  std::vector<Eigen::Vector3d> sample_m;
  std::vector<std::string> digests, warnings;
  std::vector<std::uint64_t> records, tallied;
  std::vector<double> stations;
  std::vector<std::uint64_t> of_rank;

  void operator<<(const CloudBlock& block) {
    for (std::size_t k = 0; k < block.points.size(); ++k) {
      const Eigen::Vector3f& p = block.points[k];
      const float intensity = block.intensity.empty() ? 0.0F : block.intensity[k];
      points.push_back({std::bit_cast<std::uint32_t>(p.x()), std::bit_cast<std::uint32_t>(p.y()),
                        std::bit_cast<std::uint32_t>(p.z()), block.rgba.empty() ? 0U : block.rgba[k],
                        std::bit_cast<std::uint32_t>(intensity)});
    }
  }
  void look(ScanSet& set) {
    valid = set.points();
    invalid = set.invalid();
    faces = set.faces();
    origin_m = set.origin_m();
    sample_m = set.sample_m();
    std::ranges::sort(sample_m,
                      [](const auto& a, const auto& b) { return std::ranges::lexicographical_compare(a, b); });
    for (const Station& station : set.stations()) {
      stations.insert(stations.end(), station.place_m.begin(), station.place_m.end());
      stations.push_back(static_cast<double>(station.seen_m.size()));
      stations.push_back(static_cast<double>(station.normals.size()));
    }
    for (const scene::ScanSource& source : set.sources()) {
      digests.push_back(source.sha256);
      records.push_back(source.points);
    }
    for (std::size_t s = 0; s < records.size(); ++s) {
      for (const FieldTally& tally : set.tallies_of(s)) {
        tallied.insert(tallied.end(), {tally.values(), tally.missing(), tally.below(3.0F)});
      }
    }
  }
};

class SharedScans : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    const std::filesystem::path file = folder_ / name;
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }
  [[nodiscard]] std::vector<scene::ScanConfig> configs(const std::vector<std::string>& names) const {
    std::vector<scene::ScanConfig> configs;
    for (const std::string& name : names) {
      configs.emplace_back();
      configs.back().file = folder_ / name;
      configs.back().units.unit = scene::LengthUnit::m;
    }
    return configs;
  }
  [[nodiscard]] Found alone(const std::vector<std::string>& names) const {
    Found found;
    Progress progress;
    ScanSet set(configs(names), ScanSet::Keep::disk, true, progress);
    found.beyond = set.stream([&](const CloudBlock& block) { found << block; }, progress);
    found.look(set);
    found.warnings = progress.warnings();
    std::ranges::sort(found.points);
    return found;
  }
  [[nodiscard]] Found together(const std::vector<std::string>& names, std::size_t size) const {
    Found found;
    std::mutex mutex;
    found.of_rank.resize(size);
    test::on_ranks(size, 1U << 16U, [&](const Ranks& ranks, Progress& progress) {
      ScanSet set(configs(names), ScanSet::Keep::disk, true, progress, {}, {}, {}, test::readers(ranks));
      Found own;
      own.beyond = set.stream([&](const CloudBlock& block) { own << block; }, progress);
      own.look(set);
      const std::lock_guard lock(mutex);
      found.points.insert(found.points.end(), own.points.begin(), own.points.end());
      found.beyond += own.beyond;
      found.of_rank[ranks.number()] = own.points.size();
      own.beyond = found.beyond;
      own.points.swap(found.points);
      own.of_rank = found.of_rank;
      if (ranks.is_root()) own.warnings = progress.warnings();
      if (!ranks.is_root()) own.warnings = found.warnings;
      found = std::move(own);
    });
    std::ranges::sort(found.points);
    return found;
  }
  void expect_same(const std::vector<std::string>& names) const {
    const Found expected = alone(names);
    for (const std::size_t size : {2U, 3U, 5U}) {
      const Found found = together(names, size);
      EXPECT_EQ(found.faces > 0, expected.faces > 0) << names.front();
      if (expected.faces > 0) continue;  // which ranks build no scene of
      EXPECT_TRUE(found.points == expected.points) << names.front() << " by " << size;
      EXPECT_EQ(found.valid, expected.valid) << names.front();
      EXPECT_EQ(found.invalid, expected.invalid) << names.front();
      EXPECT_EQ(found.beyond, expected.beyond);
      EXPECT_EQ(found.origin_m, expected.origin_m);
      EXPECT_EQ(found.sample_m, expected.sample_m) << names.front();
      EXPECT_EQ(found.digests, expected.digests);
      EXPECT_EQ(found.records, expected.records) << names.front();
      EXPECT_EQ(found.tallied, expected.tallied) << names.front();
      EXPECT_EQ(found.stations, expected.stations) << names.front();
      EXPECT_EQ(found.warnings, expected.warnings) << names.front();
    }
  }

  const test::TestFolder folder_;
};

TEST_F(SharedScans, OfEveryFormatAllRanksFindWhatOneProcessFinds) {
  const testing::Waves waves{60};
  std::vector<std::string> names;
  for (const testing::WaveFile& wave : testing::wave_files()) {
    const std::string name(wave.name);
    const auto file = write(name, wave.bytes(waves));
    if (may_hold_faces(file)) continue;
    expect_same({name});
    if (std::ranges::find(names, name) == names.end() && alone({name}).faces == 0) names.push_back(name);
  }
  ASSERT_GE(names.size(), 8U);
  expect_same(names);
}

std::string ply(std::size_t points, int seed) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points) +
                      "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float "
                      "ny\nproperty float nz\nproperty float confidence\nproperty uchar red\nproperty uchar "
                      "green\nproperty uchar blue\nend_header\n";
  std::mt19937 random(static_cast<std::uint32_t>(seed));
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  for (std::size_t k = 0; k < points; ++k) {
    for (int value = 0; value < 6; ++value) {
      float number = unit(random);
      if (value == 2 && k % 17 == 3) number = std::numeric_limits<float>::quiet_NaN();
      if (value == 1 && k % 1001 == 5) number = 1e35F;
      testing::put(bytes, number);
    }
    testing::put(bytes, std::floor(5.0F * unit(random)));
    for (int value = 0; value < 3; ++value) bytes += static_cast<char>(random() & 0xFFU);
  }
  return bytes;
}

TEST_F(SharedScans, InvalidPointsNormalsAndFieldsAreCountedOnceAndPlyIsReadInEqualParts) {
  static_cast<void>(write("a.ply", ply(9000, 1)));
  static_cast<void>(write("b.ply", ply(2500, 2)));
  expect_same({"a.ply"});
  expect_same({"a.ply", "b.ply"});
  const Found found = together({"a.ply", "b.ply"}, 4);
  for (const std::uint64_t points : found.of_rank) EXPECT_NEAR(static_cast<double>(points), 11500.0 * 16 / 17 / 4, 150);
}

TEST_F(SharedScans, WithheldPointsOfLasAreSaidAsOneProcessSaysThem) {
  std::vector<std::string> points;
  for (int k = 0; k < 5000; ++k) {
    points.push_back(testing::las_point(1, k % 70, k / 70, (k * 7) % 11));
    if (k % 50 == 49) points.back()[15] = static_cast<char>(0x80);
  }
  testing::LasFile file;
  file.format = 1;
  file.points = points;
  std::string bytes = file.bytes();
  const auto set_box = [&](double high) {
    for (const std::size_t axis : {0U, 1U, 2U}) {
      testing::set(bytes, 179 + 16 * axis, high);
      testing::set(bytes, 187 + 16 * axis, 100.0);
    }
  };
  static_cast<void>(write("no_box.las", bytes));
  set_box(100.8);
  static_cast<void>(write("withheld.las", bytes));
  for (std::size_t k = 0; k < points.size(); ++k) bytes[bytes.size() - 28 * (k + 1) + 15] = 0;
  static_cast<void>(write("plain.las", bytes));
  set_box(100.4);
  static_cast<void>(write("small_box.las", bytes));
  for (const char* name : {"no_box.las", "withheld.las", "plain.las", "small_box.las"}) expect_same({name});
  const std::vector<std::uint64_t> shares = together({"plain.las"}, 2).of_rank;
  EXPECT_NEAR(static_cast<double>(shares[0]), 2500.0, 5.0);  // the header counts as bytes of the first
  EXPECT_EQ(shares[0] + shares[1], 5000U);
}

TEST_F(SharedScans, AnEmptyScanBesideOthersIsLeftOutByAllRanks) {
  static_cast<void>(write("a.ply", ply(3000, 1)));
  static_cast<void>(write("b.ply", ply(0, 2)));
  static_cast<void>(write("c.xyz", "\n"));
  expect_same({"b.ply", "a.ply", "c.xyz"});
}

TEST_F(SharedScans, PlanesAndFieldsThatFiltersLookAtAreThoseOfAllPoints) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  constexpr int kPoints = 30000;
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(kPoints) +
                      "\nproperty float x\nproperty float y\nproperty float z\nproperty float confidence\nend_header\n";
  for (int k = 0; k < kPoints; ++k) {
    const float x = unit(random), y = unit(random);
    const float z = k % 3 > 0 ? 0.002F * unit(random) : 0.5F + 0.3F * x * y;
    for (const float value : {x, y, z, std::floor(3.0F + 2.0F * unit(random))}) testing::put(bytes, value);
  }
  static_cast<void>(write("floor.ply", bytes));
  scene::RemovePlaneConfig plane;
  plane.distance_m = 0.005;
  scene::FieldConfig field;
  field.name = "confidence";
  field.min = 2.0F;
  const std::vector<scene::FilterConfig> filters = {field, plane};
  const auto filtered = [&](const ReadingRanks& readers, Progress& progress) {
    const ScanSet set(configs({"floor.ply"}), ScanSet::Keep::disk, false, progress, {"confidence"}, {}, {}, readers);
    ThreadPool pool(1);
    StreamedFilters streamed(set, filters, {pool, progress});
    streamed.sample_kept();
    static_cast<void>(set.stream(
        [&](const CloudBlock& block) {
          for (std::size_t k = 0; k < block.points.size(); ++k) static_cast<void>(streamed.keep(block, k));
        },
        progress));
    if (set.is_shared()) streamed.join(set.ranks());
    std::string found;
    const FilterSteps steps = streamed.finish(progress);
    for (const FilterStep& step : steps.steps) {
      found += step.name + " " + std::to_string(step.removed) + " " + std::to_string(step.in_plane) + " " + step.found +
               " " + std::to_string(step.sample.points().size()) + "\n";
    }
    return found + std::to_string(steps.kept.points().size());
  };
  Progress progress;
  const std::string expected = filtered({}, progress);
  for (const std::size_t size : {2U, 3U, 5U}) {
    test::on_ranks(size, 1U << 16U, [&](const Ranks& ranks, Progress& own) {
      EXPECT_EQ(filtered(test::readers(ranks), own), expected) << size << " ranks";
    });
  }
}

}  // namespace
}  // namespace sparsha::pipeline
