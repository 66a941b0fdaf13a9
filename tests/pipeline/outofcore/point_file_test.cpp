// What is written comes back, whole and in order, and nothing stays on the disk.
#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <thread>

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

TEST(PointFile, AFolderThatIsNotThereIsAnError) { EXPECT_THROW(PointFile("/no/such/folder", PointLayout{}, 1), Error); }

}  // namespace
}  // namespace sparsha::pipeline
