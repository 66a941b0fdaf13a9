// COLMAP's points3D.bin: points, colours and what is known of them; files that are none, cut or lie.
#include <gmock/gmock.h>

#include <random>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using testing::error_of_bytes;
using testing::expect_refused;
using ::testing::HasSubstr;
using testing::put;

constexpr int kPoints = 12;

std::string points3d() {
  std::string bytes;
  put(bytes, std::uint64_t{kPoints});
  for (int i = 0; i < kPoints; ++i) {
    put(bytes, static_cast<std::uint64_t>(100 + i));
    for (const double x : {0.5 * i, -1.0 * i, 1e6 + i}) put(bytes, x);
    for (const int x : {i, 2 * i, 255}) put(bytes, static_cast<std::uint8_t>(x));
    put(bytes, 0.25 * i);
    put(bytes, static_cast<std::uint64_t>(2 + i % 3));
    for (int k = 0; k < 2 * (2 + i % 3); ++k) put(bytes, static_cast<std::uint32_t>(k));
  }
  return bytes;
}

TEST(Colmap, PointsColoursAndFieldsAreRead) {
  ReadOptions options;
  options.fields = {"error", "track_length"};
  const RawScan scan = read_scan_bytes(points3d(), "sparse/0/points3D.bin", options);
  EXPECT_EQ(scan.format, "COLMAP points3D");
  ASSERT_EQ(scan.points.size(), 12U);
  for (std::size_t i = 0; i < 12; ++i) {
    const auto v = static_cast<double>(i);
    EXPECT_EQ(scan.points[i], Eigen::Vector3d(0.5 * v, -v, 1e6 + v));
    EXPECT_EQ(scan.rgba[i], 0xFFFF0000U | i * 2 << 8U | i);
    EXPECT_EQ(scan.values[0][i], 0.25F * static_cast<float>(i));
    EXPECT_EQ(scan.values[1][i], static_cast<float>(2 + i % 3));
  }
  EXPECT_TRUE(scan.warnings.empty());
  EXPECT_EQ(read_scan_bytes(points3d(), "points").format, "COLMAP points3D");
  EXPECT_THAT(read_scan_bytes(points3d() + "abc", "points3D.bin").warnings,
              ElementsAre(HasSubstr("3 bytes behind the last point")));
}

TEST(Colmap, AFileThatIsCutIsRefused) {
  const std::string bytes = points3d();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    expect_refused("points3D.bin", bytes.substr(0, size), "");
    if (size > bytes.size() - 40) {
      expect_refused("points3D.bin", bytes.substr(0, size), "the file ends within point 12 of 12, at byte");
    }
  }
}

TEST(Colmap, NumbersThatLieTakeNoMemory) {
  std::string bytes = points3d();
  const std::uint64_t many = ~std::uint64_t{0};
  std::memcpy(bytes.data(), &many, 8);
  expect_refused("points3D.bin", bytes, "binary data of no known format");
  bytes = points3d();
  std::memcpy(bytes.data() + 8 + 51 + 16 + 43, &many, 8);  // the track of the second point
  expect_refused("points3D.bin", bytes, "the file ends within point 2 of 12, at byte 75");
}

TEST(Colmap, OtherBinaryFilesAreNone) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string bytes;
    put(bytes, static_cast<std::uint64_t>(random() % 10));
    for (int i = 0; i < 600; ++i) bytes += static_cast<char>(random());
    for (const char* name : {"cameras.bin", "a", "a.dat"}) EXPECT_TRUE(error_of_bytes(name, bytes)) << trial;
  }
}

TEST(Colmap, ChangedBytesGivePointsOrAnError) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 5000; ++trial) {
    std::string bytes = points3d();
    for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    try {
      const RawScan scan = read_scan_bytes(bytes, "points3D.bin");
      EXPECT_EQ(scan.points.size() + scan.invalid, scan.records);
    } catch (const Error&) {
    }
  }
}

}  // namespace
}  // namespace sparsha::pipeline
