// Atomic outputs, SHA-256, mapped files.
#include "base/files/files.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/system.h"
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
  AtomicPath path(folder_ / "scene", AtomicPath::Kind::folder);
  write_file(path.temporary() / "new.txt", "new");
  path.commit();
  EXPECT_FALSE(fs::exists(folder_ / "scene" / "old.txt"));
  EXPECT_EQ(read_file(folder_ / "scene" / "new.txt", 100), "new");
}

TEST_F(Files, AFolderDoesNotReplaceAFileOfTheSameName) {
  write_file(folder_ / "scene", "precious");
  EXPECT_THROW(AtomicPath(folder_ / "scene", AtomicPath::Kind::folder), Error);
  fs::create_directories(folder_ / "folder");
  EXPECT_THROW(AtomicPath(folder_ / "folder"), Error) << "nor a file a folder";
  AtomicPath late(folder_ / "late", AtomicPath::Kind::folder);
  write_file(folder_ / "late", "precious");
  EXPECT_THROW(late.commit(), Error);
  EXPECT_EQ(read_file(folder_ / "late", 100), "precious");
  EXPECT_EQ(read_file(folder_ / "scene", 100), "precious");
}

TEST_F(Files, APipeIsRefusedByNameAndNeitherWaitedForNorReplaced) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink(pipe, folder_ / "link");
  for (const fs::path& target : {pipe, folder_ / "link"}) {
    try {
      write_file(target, "a result\n");
      ADD_FAILURE() << "nobody listens";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_NE(std::string(error.what()).find(target.string() + ": error: the output is a named pipe"),
                std::string::npos);
    }
    EXPECT_THROW(static_cast<void>(read_file(target, 100)), Error);
  }
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(entries(), 2U);
}

TEST_F(Files, TemporaryNamesAreRandomAndWhatStandsInTheirWayIsNeverFollowedOrTaken) {
  const AtomicPath one(folder_ / "a");
  const AtomicPath two(folder_ / "a");
  EXPECT_NE(one.temporary(), two.temporary());
  // Names as they could be predicted once: the victim would have been written over, the stale folder taken in.
  write_file(folder_ / "victim", "precious");
  const std::string process = std::to_string(system::process_id());
  for (int n = 0; n < 200; ++n) {
    const std::string number = ".part-" + process + "-" + std::to_string(n);
    fs::create_symlink(folder_ / "victim", folder_ / (".file" + number));
    fs::create_directories(folder_ / (".scene" + number) / "level-9");
  }
  write_file(folder_ / "file", "new");
  AtomicPath scene(folder_ / "scene", AtomicPath::Kind::folder);
  EXPECT_TRUE(fs::is_empty(scene.temporary()));
  scene.commit();
  EXPECT_TRUE(fs::is_empty(folder_ / "scene"));
  EXPECT_EQ(read_file(folder_ / "victim", 100), "precious");
  EXPECT_THROW(
      {
        fs::create_symlink(folder_ / "nowhere", folder_ / "taken");
        if (system::create_exclusively(folder_ / "taken", false) < 0) throw usage_error("taken");
      },
      Error);
  EXPECT_FALSE(fs::exists(folder_ / "nowhere"));
}

TEST_F(Files, WhatAKilledProgramLeftIsRemovedAndWhatARunningOneWritesStays) {
  const pid_t child = ::fork();
  if (child == 0) {
    const AtomicPath file(folder_ / "a");
    const AtomicPath scene(folder_ / "scene", AtomicPath::Kind::folder);
    std::ofstream(scene.temporary() / "half") << "half";
    ::raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_EQ(entries(), 2U);
  const AtomicPath running(folder_ / "a");
  std::ofstream(running.temporary()) << "so far";
  std::ofstream(folder_ / ".a.part-notes") << "a user's";
  std::ofstream(folder_ / ".a.part-999999999-0") << "of a version that named by process";
  std::ofstream(folder_ / ".a.part-999999998-0") << "of one that may still run elsewhere";
  fs::last_write_time(folder_ / ".a.part-999999999-0", fs::file_time_type::clock::now() - std::chrono::hours(48));
  write_file(folder_ / "a", "whole");
  require_writable(folder_ / "scene", AtomicPath::Kind::folder);
  EXPECT_EQ(read_file(running.temporary(), 100), "so far");
  std::set<std::string> left;
  for (const auto& entry : fs::directory_iterator(folder_)) left.insert(entry.path().filename().string());
  EXPECT_EQ(left, (std::set<std::string>{"a", running.temporary().filename().string(), ".a.part-notes",
                                         ".a.part-999999998-0"}));
}

TEST_F(Files, AFileCutShortWhileItIsReadIsAnErrorThatNamesIt) {
  system::survive_cut_files();
  const std::size_t page = 65536;
  for (const std::size_t left : {std::size_t{0}, std::size_t{100}, page, 7 * page + 1}) {
    write_file(folder_ / "scan", std::string(8 * page, 'x'));
    const MappedFile mapped(folder_ / "scan");
    std::size_t seen = 0;
    try {
      static_cast<void>(mapped.whole([&] {
        fs::resize_file(folder_ / "scan", left);
        return std::count(mapped.text().begin(), mapped.text().end(), 'x');
      }));
      ADD_FAILURE() << left;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_NE(std::string(error.what()).find("scan: error: the file became shorter"), std::string::npos);
      ++seen;
    }
    EXPECT_EQ(seen, 1U);
  }
  write_file(folder_ / "scan", "whole");
  const MappedFile mapped(folder_ / "scan");
  EXPECT_EQ(mapped.whole([&] { return std::string(mapped.text()); }), "whole");
}

TEST_F(Files, NamesOfOneFileAreToldApartFromNamesOfTwo) {
  fs::create_directories(folder_ / "out");
  fs::create_directory_symlink(folder_ / "out", folder_ / "link");
  const auto same = [&](const fs::path& a, const fs::path& b) {
    try {
      require_distinct({{"--one", a}, {"--two", b}});
      return false;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return true;
    }
  };
  EXPECT_TRUE(same(folder_ / "out" / "a", folder_ / "link" / "a"));
  EXPECT_TRUE(same(folder_ / "out" / "a", folder_ / "out" / "." / ".." / "out" / "a"));
  EXPECT_FALSE(same(folder_ / "out" / "a", folder_ / "out" / "b"));
  write_file(folder_ / "out" / "scan", "points");
  fs::create_hard_link(folder_ / "out" / "scan", folder_ / "out" / "hard");
  write_file(folder_ / "out" / "twin", "points");
  EXPECT_TRUE(same(folder_ / "out" / "scan", folder_ / "link" / "hard"));
  EXPECT_FALSE(same(folder_ / "out" / "scan", folder_ / "out" / "twin"));
  EXPECT_FALSE(same({}, {}));
  EXPECT_FALSE(same("/dev/null", "/dev/null"));
  EXPECT_THROW(require_distinct({{"--out", folder_ / "link" / "a"}}, {{"--hip", folder_ / "out" / "a"}}), Error);
  EXPECT_TRUE(lies_within(folder_ / "link" / "a", folder_ / "out"));
  EXPECT_TRUE(lies_within(folder_ / "out", folder_ / "out"));
  EXPECT_FALSE(lies_within(folder_ / "outer", folder_ / "out"));
}

TEST_F(Files, AWriteProtectedTargetIsToldBeforeTheWork) {
  if (::geteuid() == 0) GTEST_SKIP() << "nothing is protected from this user";
  write_file(folder_ / "a", "kept");
  fs::permissions(folder_ / "a", fs::perms::owner_read);
  EXPECT_THROW(AtomicPath(folder_ / "a"), Error);
  fs::create_directories(folder_ / "locked");
  fs::permissions(folder_ / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THROW(require_writable(folder_ / "locked" / "b"), Error);
  fs::permissions(folder_ / "locked", fs::perms::owner_all);
}

TEST_F(Files, ErrorsOfWhatIsWrittenToATemporaryPathNameTheTarget) {
  const AtomicPath target(folder_ / "scene", AtomicPath::Kind::folder);
  const fs::path inner = target.temporary() / "level-0" / "height.tif";
  const auto thrown = [&](const auto& write) -> std::string {
    try {
      target.naming_target(write);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::failure);
      return error.what();
    }
    return "nothing";
  };
  EXPECT_EQ(thrown([&] {
              throw Error(ErrorKind::failure, {inner.string(), 3, 4}, "no room in " + inner.string(), "room");
            }),
            (folder_ / "scene/level-0/height.tif").string() + ":3:4: error: no room in " +
                (folder_ / "scene/level-0/height.tif").string() + "; room");
  EXPECT_EQ(thrown([&] { fs::create_directory(inner); }).find((folder_ / "scene/level-0/height.tif: error: ").string()),
            0U);
  EXPECT_EQ(target.naming_target([] { return 7; }), 7);
  EXPECT_THROW(target.naming_target([] { throw Cancelled(); }), Cancelled);
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
