// What is written comes back, whole and in order, and nothing stays on the disk.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <filesystem>
#include <thread>

#if defined(__linux__)
#include <sys/stat.h>
#endif

#include "base/error.h"
#include "pipeline/outofcore/point_file.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

class PointFiles : public ::testing::TestWithParam<PointLayout> {
 protected:
  const test::TestFolder folder_;
};

TEST_P(PointFiles, GiveBackEachBucketInTheOrderOfWriting) {
  constexpr std::uint64_t kPoints = 100'000;
  constexpr std::size_t kBuckets = 7;
  const PointLayout layout = GetParam();
  PointFile file(folder_, layout, kBuckets);
  std::array<float, 5> record{};
  for (std::uint64_t k = 0; k < kPoints; ++k) {
    record[0] = static_cast<float>(k);
    if (layout.colour) record[3] = std::bit_cast<float>(0xFF000000U + static_cast<std::uint32_t>(k));
    if (layout.intensity) record[layout.words() - 1] = 0.5F * static_cast<float>(k);
    file.add(static_cast<std::size_t>(k * k % kBuckets), record.data());
  }
  file.finish();
  EXPECT_TRUE(fs::is_empty(folder_)) << "the file has a name";
  std::uint64_t all = 0;
  for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
    std::vector<std::jthread> readers;  // at once, with pieces of different sizes
    for (const std::size_t piece : {1U, 6000U, 1U << 20U}) {
      readers.emplace_back([&file, &layout, bucket, piece] {
        std::uint64_t expected = 0;
        std::uint64_t seen = 0;
        file.read(bucket, piece, [&](const PointRecords& records) {
          EXPECT_EQ(records.first, seen);
          for (std::size_t k = 0; k < records.count; ++k, ++expected) {
            while (expected * expected % kBuckets != bucket) ++expected;
            ASSERT_EQ(records.xyz(k)[0], static_cast<float>(expected));
            if (layout.colour) {
              ASSERT_EQ(records.rgba(k), 0xFF000000U + expected);
            }
            if (layout.intensity) {
              ASSERT_EQ(records.intensity(k), 0.5F * static_cast<float>(expected));
            }
          }
          seen += records.count;
        });
        EXPECT_EQ(seen, file.size(bucket));
      });
    }
    readers.clear();
    all += file.size(bucket);
  }
  EXPECT_EQ(all, kPoints);
}

INSTANTIATE_TEST_SUITE_P(AllLayouts, PointFiles,
                         ::testing::Values(PointLayout{false, false}, PointLayout{true, false},
                                           PointLayout{false, true}, PointLayout{true, true}));

#if defined(__linux__)
// Of files of this process that have no name any more: where the disk has room for them, in bytes.
std::uint64_t disk_of_nameless_files() {
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
    struct stat status {};
    if (::stat(entry.path().c_str(), &status) == 0 && S_ISREG(status.st_mode) && status.st_nlink == 0)
      bytes += 512U * static_cast<std::uint64_t>(status.st_blocks);
  }
  return bytes;
}

// Whether the file system takes a piece out of a file.
bool releases_pieces(const fs::path& folder) {
  const std::uint64_t before = disk_of_nameless_files();
  system::ScratchFile file(folder);
  file.write(0, std::vector<std::byte>(1U << 20U, std::byte{1}));
  const std::uint64_t whole = disk_of_nameless_files();
  file.release(0, 1U << 19U);
  return disk_of_nameless_files() - before <= (whole - before) / 2 + 4096;
}

TEST(PointFile, DrainGivesTheDiskBackWhileItGoes) {
  const test::TestFolder folder;
  constexpr std::uint64_t kPoints = 500'000;  // 6 MB
  constexpr std::uint64_t kPart = 1U << 20U;
  constexpr std::size_t kPieceRecords = 10'000;
  const std::uint64_t before = disk_of_nameless_files();
  PointFile file(folder, PointLayout{}, 1, kPart);
  for (std::uint64_t k = 0; k < kPoints; ++k) {
    const std::array<float, 3> record{static_cast<float>(k), 1.0F, 2.0F};
    file.add(0, record.data());
  }
  file.finish();
  const std::uint64_t whole = disk_of_nameless_files() - before;
  if (whole < 12 * kPoints) GTEST_SKIP() << "this file system does not say what files take";
  std::uint64_t seen = 0;
  bool same = true;
  std::uint64_t most_beyond = 0;  // bytes on the disk beside those that are still to be read
  file.drain(0, kPieceRecords, [&](const PointRecords& records) {
    for (std::size_t k = 0; k < records.count; ++k, ++seen)
      same = same && records.xyz(k)[0] == static_cast<float>(seen);
    const std::uint64_t left = 12 * (kPoints - seen), held = disk_of_nameless_files() - before;
    most_beyond = std::max(most_beyond, held - std::min(held, left));
  });
  EXPECT_TRUE(same);
  EXPECT_EQ(seen, kPoints);
  EXPECT_LT(most_beyond, releases_pieces(folder) ? 12 * 3 * kPieceRecords : kPart + kPart / 4);
  EXPECT_EQ(disk_of_nameless_files(), before);
}
#endif

TEST(PointFile, AFolderThatIsNotThereIsAnError) { EXPECT_THROW(PointFile("/no/such/folder", PointLayout{}, 1), Error); }

}  // namespace
}  // namespace sparsha::pipeline
