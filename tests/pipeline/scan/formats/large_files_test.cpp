// Headers that declare 5 * 10^9 records, of files that have room for them: sparse, so that they take none.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/files/files.h"
#include "pipeline/scan/formats/las/header.h"
#include "pipeline/scan/formats/ply/ply.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kRecords = 5'000'000'000;

class LargeFiles : public ::testing::Test {
 protected:
  /// What `parse` makes of a file that begins with those bytes and is that long.
  template <typename Parse>
  auto parsed(const std::string& begin, std::uint64_t size, const Parse& parse) {
    const std::filesystem::path file = folder_ / "scan";
    std::ofstream(file, std::ios::binary) << begin;
    std::filesystem::resize_file(file, size);
    const MappedFile map(file);
    return parse(ScanFile{"scan", "", map.text(), &map});
  }
  const test::TestFolder folder_;
};

TEST_F(LargeFiles, APlyHeaderCountsBeyond32Bits) {
  const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(kRecords) +
                             "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  const ply::Header found = parsed(header, header.size() + 12 * kRecords, ply::parse_header);
  ASSERT_EQ(found.elements.size(), 1U);
  EXPECT_EQ(found.elements[0].count, kRecords);
  EXPECT_EQ(found.body, header.size());
}

TEST_F(LargeFiles, ALasHeaderCountsBeyond32BitsAndTheRoomForItsPointsToo) {
  std::string header(375, '\0');
  const auto put = [&](std::size_t at, auto value) { std::memcpy(header.data() + at, &value, sizeof(value)); };
  std::memcpy(header.data(), "LASF", 4);
  put(24, std::uint8_t{1});
  put(25, std::uint8_t{4});
  put(94, std::uint16_t{375});
  put(96, std::uint32_t{375});
  put(104, std::uint8_t{6});
  put(105, std::uint16_t{30});
  put(247, kRecords);
  for (std::size_t axis = 0; axis < 3; ++axis) put(131 + 8 * axis, 0.001);
  const auto with_room_for = [&](std::uint64_t records) {
    return parsed(header, 375 + 30 * records, las::parse_header);
  };
  const las::Header whole = with_room_for(kRecords);
  EXPECT_EQ(whole.points, kRecords);
  EXPECT_TRUE(whole.warnings.empty()) << whole.warnings.front();
  EXPECT_EQ(with_room_for(kRecords + (std::uint64_t{1} << 32U)).points, kRecords);
}

}  // namespace
}  // namespace sparsha::pipeline
