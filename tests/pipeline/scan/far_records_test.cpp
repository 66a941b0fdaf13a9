// Files of more records than 32 bits count: sparse ones, of which only the last few records are there and are read.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/reader.h"
#include "tests/support/las_files.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kRecords = 5'000'000'000;
constexpr std::uint64_t kLast = 3;  // records that are there

struct FarFile {
  std::string name, head;
  std::vector<std::string> last;  ///< kLast records
};

std::string floats(int number) {
  const std::array<float, 3> values{0.5F, static_cast<float>(number), 2.0F};
  std::string bytes(sizeof values, '\0');
  std::memcpy(bytes.data(), values.data(), sizeof values);
  return bytes;
}

std::vector<FarFile> far_files() {
  const std::string count = std::to_string(kRecords);
  std::vector<FarFile> files{
      {"far.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex " + count +
           "\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
       {}},
      {"far.pcd",
       "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + count +
           "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n",
       {}},
  };
  for (FarFile& file : files)
    for (int k = 1; k <= static_cast<int>(kLast); ++k) file.last.push_back(floats(k));
  testing::LasFile las;
  las.minor = 4;
  las.format = 6;
  las.scale = 0.5;
  las.offset = 0.0;
  FarFile far{"far.las", las.bytes(), {}};
  testing::set(far.head, 247, kRecords);
  const std::array<double, 6> box{0.5, 0.0, 3.0, 0.0, 2.0, 0.0};  // highest and lowest x, y, z
  testing::set(far.head, 179, box);
  for (int k = 1; k <= static_cast<int>(kLast); ++k) far.last.push_back(testing::las_point(6, 1, 2 * k, 4));
  files.push_back(far);
  return files;
}

TEST(FarRecords, AreReadAndCountedBeyond32Bits) {
  const test::TestFolder folder;
  for (const FarFile& far : far_files()) {
    const std::filesystem::path path = folder / far.name;
    const std::uint64_t bytes = far.head.size() + kRecords * far.last.front().size();
    std::ofstream(path, std::ios::binary) << far.head;
    std::error_code refused;
    std::filesystem::resize_file(path, bytes, refused);
    if (refused) GTEST_SKIP() << "no sparse file of " << bytes << " bytes here: " << refused.message();
    {
      std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
      file.seekp(static_cast<std::streamoff>(bytes - kLast * far.last.front().size()));
      for (const std::string& record : far.last) file << record;
    }
    ReadOptions options;
    options.from = 1.0 - 1e-6;  // 5000 records
    std::uint64_t count = 0;
    std::vector<Eigen::Vector3d> last;
    const auto keep = [&](const PointBlock& block) {
      for (const Eigen::Vector3d& p : block.points) {
        ++count;
        if (p.z() > 0.0) last.push_back(p);
      }
    };
    (void)stream_scan(path, keep, nullptr, options);
    EXPECT_NEAR(static_cast<double>(count), 5000.0, 1.0) << far.name;
    ASSERT_EQ(last.size(), kLast) << far.name;
    for (std::uint64_t k = 0; k < kLast; ++k)
      EXPECT_EQ(last[k], Eigen::Vector3d(0.5, static_cast<double>(k + 1), 2.0)) << far.name;
  }
}

}  // namespace
}  // namespace sparsha::pipeline
