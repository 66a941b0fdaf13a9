// LAZ with damaged chunks: an error, or the whole chunks where that is asked for.
#include <gmock/gmock.h>

#include <random>

#include "tests/support/copc_file.h"
#include "tests/support/laz_encoder.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using testing::expect_refused;
using ::testing::HasSubstr;
using testing::las_point;
using testing::set;

constexpr int kEach = 20, kChunks = 5;

/// Chunks of 20 points whose x counts on.
std::vector<std::vector<std::string>> counted() {
  std::vector<std::vector<std::string>> chunks(kChunks);
  std::mt19937 random(2);
  for (int i = 0; i < kChunks * kEach; ++i) {
    chunks[static_cast<std::size_t>(i / kEach)].push_back(
        las_point(0, i, static_cast<std::int32_t>(random() % 5000), static_cast<std::int32_t>(random() % 5000)));
  }
  return chunks;
}

RawScan forced(const std::string& bytes) {
  ReadOptions options;
  options.whole_chunks_only = true;
  return read_scan_bytes(bytes, "a.laz", options);
}

/// The numbers that x counts.
std::vector<int> numbers_of(const RawScan& scan) {
  std::vector<int> numbers;
  for (const Eigen::Vector3d& p : scan.points) numbers.push_back(static_cast<int>(std::lround((p.x() - 100.0) / 0.01)));
  return numbers;
}

std::vector<int> without_chunk(int chunk) {
  std::vector<int> numbers;
  for (int i = 0; i < kChunks * kEach; ++i) {
    if (i / kEach != chunk) numbers.push_back(i);
  }
  return numbers;
}

/// Where the chunks begin: the first behind the table's place, each as long as it is alone.
std::vector<std::size_t> places(const std::vector<std::vector<std::string>>& chunks) {
  std::vector<std::size_t> begins;
  for (std::size_t k = 0; k <= chunks.size(); ++k) {
    const std::vector<std::vector<std::string>> some(chunks.begin(), chunks.begin() + static_cast<std::ptrdiff_t>(k));
    std::int64_t table = 0;
    const std::string bytes = testing::pack_las(some, kEach);
    std::uint32_t first = 0;
    std::memcpy(&first, bytes.data() + 96, 4);
    std::memcpy(&table, bytes.data() + first, 8);
    begins.push_back(static_cast<std::size_t>(table));
  }
  return begins;
}

TEST(DamagedLaz, ADamagedChunkIsAnErrorOrLeftOutWithAllItsPoints) {
  const auto chunks = counted();
  const std::vector<std::size_t> begin = places(chunks);
  for (const std::uint32_t each : {static_cast<std::uint32_t>(kEach), 0U}) {
    const std::string bytes = testing::pack_las(chunks, each);
    EXPECT_EQ(numbers_of(forced(bytes)), without_chunk(-1));
    EXPECT_TRUE(forced(bytes).warnings.empty());
    for (int chunk = 0; chunk < kChunks; ++chunk) {
      std::string damaged = bytes;
      const auto at = static_cast<std::size_t>(chunk);
      std::fill(damaged.begin() + static_cast<std::ptrdiff_t>(begin[at] + 20),
                damaged.begin() + static_cast<std::ptrdiff_t>(begin[at + 1]), '\xFF');
      expect_refused("a.laz", damaged, "LAZ chunk " + std::to_string(chunk + 1) + " of 5");
      const RawScan scan = forced(damaged);
      EXPECT_EQ(numbers_of(scan), without_chunk(chunk));
      EXPECT_THAT(scan.warnings,
                  Contains(HasSubstr("1 damaged LAZ chunks are left out with 20 points, 4 whole ones are kept")));
    }
  }
}

TEST(DamagedLaz, ACutFileKeepsTheChunksBeforeTheCut) {
  const auto chunks = counted();
  const std::vector<std::size_t> begin = places(chunks);
  const std::string bytes = testing::pack_las(chunks, kEach);
  for (std::size_t size = begin[1] + 1; size < begin.back(); ++size) {
    const RawScan scan = forced(bytes.substr(0, size));
    // The decoder may read up to four bytes fewer than the encoder wrote.
    const auto whole =
        static_cast<std::size_t>(std::upper_bound(begin.begin() + 1, begin.end(), size + 4) - begin.begin() - 1);
    const std::size_t certain =
        static_cast<std::size_t>(std::upper_bound(begin.begin() + 1, begin.end(), size) - begin.begin() - 1);
    EXPECT_GE(scan.points.size(), certain * kEach) << size;
    EXPECT_LE(scan.points.size(), whole * kEach) << size;
    EXPECT_EQ(scan.points.size() % kEach, 0U) << size;
    std::vector<int> numbers = without_chunk(-1);
    numbers.resize(scan.points.size());
    EXPECT_EQ(numbers_of(scan), numbers) << size;
    EXPECT_FALSE(scan.warnings.empty());
  }
  // Not one is whole.
  ReadOptions options;
  options.whole_chunks_only = true;
  EXPECT_THROW((void)read_scan_bytes(bytes.substr(0, begin[1] - 10), "a.laz", options), Error);
}

TEST(DamagedLaz, ATableThatLiesIsDoneWithoutWhereChunksHaveOneNumberOfPoints) {
  const auto chunks = counted();
  std::string bytes = testing::pack_las(chunks, kEach);
  set(bytes, places(chunks).back(), std::uint32_t{7});
  expect_refused("a.laz", bytes, "there is no table of LAZ chunks where it should be");
  const RawScan scan = forced(bytes);
  EXPECT_EQ(numbers_of(scan), without_chunk(-1));
  EXPECT_THAT(scan.warnings, Contains(HasSubstr("the chunks were read one after another")));
  std::string any = testing::pack_las(chunks, 0);
  set(any, places(chunks).back(), std::uint32_t{7});
  EXPECT_THROW((void)forced(any), Error);
}

TEST(DamagedLaz, LayersThatDisagreeTakeTheirChunkAlone) {
  const std::vector<testing::CopcNode> nodes = {{0, {0, 0, 0}, {{1, 1, 1}, {2, 2, 2}}},
                                                {1, {0, 0, 0}, {{3, 3, 3}, {4, 4, 4}, {5, 5, 5}}},
                                                {1, {1, 0, 0}, {{900, 6, 6}}}};
  testing::CopcFile file(nodes);
  set(file.bytes, file.chunks[1] + 30, std::uint32_t{0x7FFFFFFF});  // its own number of points
  expect_refused("a.laz", file.bytes, "LAZ chunk 2 of 3: the chunk has 2147483647 points");
  const RawScan scan = forced(file.bytes);
  ASSERT_EQ(scan.points.size(), 3U);
  EXPECT_EQ(scan.points[2].x(), 9.0);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("1 damaged LAZ chunks are left out with 3 points, 2 whole")));
}

}  // namespace
}  // namespace sparsha::pipeline
