// Arrays in files: what was written is there after its pages have gone, and nothing is left of the files.
#include <gtest/gtest.h>

#include "base/system/disk_arrays.h"

#if defined(__linux__)
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "base/error.h"
#include "tests/support/test_folder.h"

namespace sparsha::system {
namespace {

constexpr std::size_t kBytes = std::size_t{64} << 20U;

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

// Pages of files alone: a sanitizer's own pages of each array stay.
std::uint64_t resident_bytes_of_files() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t size = 0, resident = 0, of_files = 0;
  statm >> size >> resident >> of_files;
  return of_files * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::uint64_t word(std::size_t k) { return k * 0x9E3779B97F4A7C15ULL + 1; }

TEST(DiskArrays, HoldTheirValuesWhileTheirPagesLeaveMemory) {
  const test::TestFolder folder;
  const DiskArrays arrays(folder.path(), 1);  // less than the process has: pages always go
  const std::uint64_t before = resident_bytes_of_files();
  auto* const words = static_cast<std::uint64_t*>(take_disk_array(kBytes));
  ASSERT_NE(words, nullptr);
  constexpr std::size_t kWords = kBytes / sizeof(std::uint64_t);
  for (std::size_t k = 0; k < kWords; ++k) ASSERT_EQ(words[k], 0U);
  for (std::size_t k = 0; k < kWords; ++k) words[k] = word(k);
  while (resident_bytes_of_files() > before + kBytes / 2) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  for (std::size_t k = 0; k < kWords; ++k) ASSERT_EQ(words[k], word(k));
  EXPECT_EQ(files_in(folder.path()), 0U) << "their files have no names";
  EXPECT_TRUE(give_disk_array(words));
  EXPECT_FALSE(give_disk_array(words));
}

TEST(DiskArrays, AreLargeOnesWhileOneIsInForce) {
  const test::TestFolder folder;
  EXPECT_FALSE(wants_disk_array(kBytes));
  void* array = nullptr;
  {
    const DiskArrays arrays(folder.path(), kBytes);
    EXPECT_TRUE(wants_disk_array(kLeastDiskArray));
    EXPECT_FALSE(wants_disk_array(kLeastDiskArray - 1));
    array = take_disk_array(kBytes);
  }
  EXPECT_FALSE(wants_disk_array(kBytes));
  ASSERT_NE(array, nullptr);
  static_cast<char*>(array)[kBytes - 1] = 7;  // still there
  EXPECT_TRUE(give_disk_array(array));
}

TEST(DiskArrays, AreToldFromOtherMemory) {
  const test::TestFolder folder;
  const DiskArrays arrays(folder.path(), kBytes);
  void* const array = take_disk_array(kBytes);
  void* const of_heap = std::malloc(kBytes);
  void* const of_pages = std::aligned_alloc(4096, kBytes);
  EXPECT_FALSE(give_disk_array(of_heap));
  EXPECT_FALSE(give_disk_array(of_pages));
  EXPECT_FALSE(give_disk_array(nullptr));
  EXPECT_TRUE(give_disk_array(array));
  std::free(of_heap);
  std::free(of_pages);
}

TEST(DiskArrays, AFullDiskAndAMissingFolderAreErrorsByName) {
  const test::TestFolder folder;
  EXPECT_THROW(DiskArrays(folder / "missing", kBytes), Error);
  const DiskArrays arrays(folder.path(), kBytes);
  throw_if_disk_was_full();  // it was not
  // A limit on the size of files stands for the full disk.
  struct rlimit old {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  auto* const handler = std::signal(SIGXFSZ, SIG_IGN);
  struct rlimit little = old;
  little.rlim_cur = kBytes / 2;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &little), 0);
  void* const array = take_disk_array(kBytes);
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(array, nullptr);
  try {
    throw_if_disk_was_full();
    FAIL() << "the array got no room";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::failure);
    EXPECT_NE(std::string(error.what()).find(folder.path().string()), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace sparsha::system
#endif
