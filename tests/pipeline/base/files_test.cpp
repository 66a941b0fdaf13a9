// Atomic outputs, SHA-256, mapped files.
#include "pipeline/base/files.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "pipeline/base/error.h"
#include "pipeline/base/system.h"
#include "tests/support/test_folder.h"

namespace sparsha {
namespace {
namespace fs = std::filesystem;

class Files : public ::testing::Test {
 protected:
  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  const test::TestFolder folder_;
};

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span<const char>(text.data(), text.size()));
}

TEST_F(Files, Sha256GivesTheDigestsOfTheStandard) {  // FIPS 180-4 examples
  EXPECT_EQ(sha256(bytes_of("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(bytes_of("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST_F(Files, AnUncommittedFileLeavesTheOldOneAndNothingElse) {
  write_file(folder_ / "a.txt", "old");
  {
    const AtomicPath path(folder_ / "a.txt");
    std::ofstream(path.temporary()) << "new";
  }
  EXPECT_EQ(read_file(folder_ / "a.txt", 100), "old");
  EXPECT_EQ(entries(), 1U);
}

TEST_F(Files, ACommittedFolderReplacesTheOldOneWhole) {
  fs::create_directories(folder_ / "scene");
  write_file(folder_ / "scene" / "old.txt", "old");
  AtomicPath path(folder_ / "scene");
  fs::create_directories(path.temporary());
  write_file(path.temporary() / "new.txt", "new");
  path.commit();
  EXPECT_FALSE(fs::exists(folder_ / "scene" / "old.txt"));
  EXPECT_EQ(read_file(folder_ / "scene" / "new.txt", 100), "new");
}

TEST_F(Files, AFolderDoesNotReplaceAFileOfTheSameName) {
  write_file(folder_ / "scene", "precious");
  AtomicPath path(folder_ / "scene");
  fs::create_directories(path.temporary());
  EXPECT_THROW(path.commit(), Error);
  EXPECT_EQ(read_file(folder_ / "scene", 100), "precious");
}

TEST_F(Files, APipeIsWrittenToAndNeverReplaced) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string heard;
  std::thread listener([&] { std::getline(std::ifstream(pipe), heard); });
  write_file(pipe, "a result\n");
  listener.join();
  EXPECT_EQ(heard, "a result");
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(entries(), 1U);
}

TEST_F(Files, LinesAppendedByManyAtOnceAreAllThereAndWholeBelowOneHeader) {
  const fs::path file = folder_ / "study.csv";
  constexpr int kWriters = 8;
  constexpr int kLines = 100;
  std::vector<std::thread> writers;
  for (int w = 0; w < kWriters; ++w)
    writers.emplace_back([&file, w] {
      for (int i = 0; i < kLines; ++i)
        system::append_line(file, "writer,line\n", std::to_string(w) + "," + std::to_string(i) + "\n");
    });
  for (std::thread& writer : writers) writer.join();
  std::ifstream stream(file);
  std::string line;
  ASSERT_TRUE(std::getline(stream, line));
  EXPECT_EQ(line, "writer,line");
  std::vector<int> next(kWriters, 0);
  while (std::getline(stream, line)) {
    const auto writer = static_cast<std::size_t>(line.at(0) - '0');
    ASSERT_LT(writer, next.size()) << line;
    EXPECT_EQ(line, std::to_string(writer) + "," + std::to_string(next[writer]++));
  }
  EXPECT_EQ(next, std::vector<int>(kWriters, kLines));

  std::ofstream(file) << "writer,line\n0,0";  // edited by hand
  system::append_line(file, "writer,line\n", "1,1\n");
  EXPECT_EQ(read_file(file, 100), "writer,line\n0,0\n1,1\n");
  EXPECT_THROW(system::append_line(folder_, "", "x\n"), Error) << "a folder";
}

TEST_F(Files, MissingFilesFoldersAndOversizeAreErrorsThatNameTheFile) {
  write_file(folder_ / "long", "0123456789");
  EXPECT_THROW((void)read_file(folder_ / "none", 100), Error);
  EXPECT_THROW((void)read_file(folder_, 100), Error);
  EXPECT_THROW((void)read_file(folder_ / "long", 9), Error);
  EXPECT_THROW(AtomicPath(folder_ / "no" / "such" / "folder.txt"), Error);
}

TEST_F(Files, AnEmptyFileMapsToNoBytes) {
  write_file(folder_ / "empty", "");
  const MappedFile mapped(folder_ / "empty");
  EXPECT_EQ(mapped.bytes().size(), 0U);
}

}  // namespace
}  // namespace sparsha
