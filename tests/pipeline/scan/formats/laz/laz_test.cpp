// LAZ through a library that stands for LASzip: this proves how LASzip is called and what is made of its points. It
// proves nothing of LASzip itself.
#include <gmock/gmock.h>

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "laszip_double.h"
#include "tests/support/sanitized.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::las_point;
using testing::LasFile;
using testing::laszip_books;
using testing::laszip_faults;
using testing::packed;
using testing::set;

std::size_t colour_place(int format) {
  return format == 2 ? 20 : format == 3 || format == 5 ? 28 : format == 7 || format == 8 || format == 10 ? 30 : 0;
}

/// Numbers of all sizes, every seventh point withheld; colours of 16 bits only from point 900 on.
LasFile some_points(int minor, int format, int count) {
  LasFile file;
  file.minor = minor;
  file.format = format;
  file.scale = 0.0005;
  file.offset = 450000.25;
  for (int i = 0; i < count; ++i) {
    std::string point =
        las_point(format, i % 2000 * 1000003, -i * 77, 2147483647 - i, static_cast<std::uint16_t>(i * 31));
    if (i % 7 == 3) point[15] = static_cast<char>(format >= 6 ? 4 : 128);
    if (const std::size_t at = colour_place(format); at != 0) {
      const int unit = i < 900 ? 1 : 257;
      for (int k = 0; k < 3; ++k) {
        set(point, at + 2 * static_cast<std::size_t>(k), static_cast<std::uint16_t>(unit * ((i + 85 * k) % 256)));
      }
    }
    file.points.push_back(point);
  }
  return file;
}

/// After each test all that was made is destroyed, all that was opened closed, and no call was out of order.
class LazReader : public ::testing::Test {
 protected:
  void SetUp() override {
    laszip_faults = {};
    laszip_books = {};
  }
  void TearDown() override {
    EXPECT_EQ(laszip_books.created, laszip_books.destroyed);
    EXPECT_EQ(laszip_books.opened, laszip_books.closed);
    EXPECT_STREQ(laszip_books.misuses, "");
    expect_no_child();
  }
  /// Neither one that runs nor one that nobody has waited for.
  static void expect_no_child() {
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
  }
  /// The error of a file whose point 700 of 1500 ends LASzip like this.
  [[nodiscard]] std::string message_when(std::function<void()> instead) {
    laszip_faults.read = 699;
    laszip_faults.instead = std::move(instead);
    const auto error = error_of(folder_.write("a.laz", packed(some_points(4, 7, 1500))));
    laszip_books = {};  // nothing was closed
    if (!error) return "no error";
    EXPECT_EQ(error->kind(), ErrorKind::input);
    EXPECT_THAT(error->place().file, HasSubstr("a.laz"));
    return error->wrong();
  }
  testing::ScanFolder folder_;
};

TEST_F(LazReader, GivesWhatTheSameFileUnpackedGives) {
  for (int minor = 0; minor <= 4; ++minor) {
    for (int format = 0; format <= 10; ++format) {
      for (const int count : {1, 850, 1500}) {
        const LasFile file = some_points(minor, format, count);
        const RawScan plain = folder_.read("a.las", file.bytes());
        const RawScan unpacked = folder_.read("a.laz", packed(file));
        EXPECT_EQ(unpacked.format, "LAZ 1." + std::to_string(minor) + " pf" + std::to_string(format));
        EXPECT_EQ(unpacked.records, static_cast<std::uint64_t>(count));
        EXPECT_EQ(unpacked.invalid, plain.invalid);
        EXPECT_EQ(unpacked.points, plain.points);
        EXPECT_EQ(unpacked.intensity, plain.intensity);
        EXPECT_EQ(unpacked.rgba, plain.rgba);
        EXPECT_EQ(unpacked.fields, plain.fields);
      }
    }
  }
}

TEST_F(LazReader, ReadsEachPointOnceInAProcessOfItsOwn) {
  const RawScan scan = folder_.read("a.laz", packed(some_points(2, 3, 1500)));
  EXPECT_EQ(laszip_books.created, 1);
  EXPECT_EQ(laszip_books.reads, 1500);
  EXPECT_NE(laszip_books.process, ::getpid());
  EXPECT_EQ(scan.points[0], Eigen::Vector3d(450000.25, 450000.25, 2147483647 * 0.0005 + 450000.25));
}

TEST_F(LazReader, ReadsAFileWithoutPoints) {
  EXPECT_EQ(folder_.read("none.laz", packed(some_points(2, 0, 0))).records, 0U);
}

TEST_F(LazReader, EveryFailureOfLaszipIsAnErrorThatRepeatsItsMessageAndLeavesNothingOpen) {
  const auto file = folder_.write("a.laz", packed(some_points(4, 7, 1500)));
  const std::vector<std::function<void()>> faults = {
      [] { laszip_faults.open = true; }, [] { laszip_faults.point_pointer = true; }, [] { laszip_faults.read = 0; },
      [] { laszip_faults.read = 700; },  [] { laszip_faults.read = 1200; },          [] { laszip_faults.read = 1499; },
  };
  for (const auto& fault : faults) {
    laszip_faults = {};
    fault();
    const auto error = error_of(file);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->kind(), ErrorKind::input);
    EXPECT_THAT(error->what(), HasSubstr("a.laz"));
    EXPECT_THAT(error->what(), HasSubstr("LASzip: as the test wants it"));
    TearDown();
  }
  laszip_faults = {};
  laszip_faults.read = 3;
  laszip_faults.message.clear();
  EXPECT_THAT(error_of(file)->what(), HasSubstr("unknown failure"));
  laszip_faults = {};
  laszip_faults.create = true;
  EXPECT_THAT(error_of(file)->what(), HasSubstr("LASzip: it could not start"));
}

TEST_F(LazReader, RefusesAFileThatIsCutShort) {
  const std::string bytes = packed(some_points(2, 0, 1500));
  const auto error = error_of(folder_.write("cut.laz", bytes.substr(0, bytes.size() - 1)));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind(), ErrorKind::input);
}

TEST_F(LazReader, StopsUnpackingWhenThePointsAreNotWanted) {
  const auto file = folder_.write("a.laz", packed(some_points(2, 0, 200'000)));
  EXPECT_THROW((void)stream_scan(file, [](const PointBlock&) { throw std::runtime_error("no more"); }),
               std::runtime_error);
  expect_no_child();
  EXPECT_EQ(laszip_books.opened, 1);
  laszip_books = {};
}

TEST_F(LazReader, ACrashOfLaszipIsAnErrorOfTheFileThatTellsThePointReached) {
  const auto crash = [](int number) { return [number] { ::raise(number); }; };
  EXPECT_EQ(message_when(crash(SIGSEGV)), "LASzip was ended by signal 11 (Segmentation fault) at point 700 of 1500");
  EXPECT_THAT(message_when(crash(SIGABRT)), HasSubstr("was ended by signal 6 "));
  EXPECT_THAT(message_when(crash(SIGFPE)), HasSubstr("at point 700 of 1500"));
  EXPECT_THAT(message_when([] { throw 1; }), HasSubstr("at point 700 of 1500"));
}

TEST_F(LazReader, LaszipThatEndsTheProgramEndsItsProcessOnly) {
  for (const int code : {0, 3}) {
    EXPECT_EQ(message_when([code] { std::exit(code); }),  // NOLINT(concurrency-mt-unsafe): what a library may do
              "LASzip ended the process with code " + std::to_string(code) + " at point 700 of 1500");
  }
}

TEST_F(LazReader, ACrashWhileClosingIsAnErrorAlthoughAllPointsHaveCome) {
  const auto file = folder_.write("a.laz", packed(some_points(2, 0, 1500)));
  laszip_faults.close = true;
  EXPECT_THAT(error_of(file)->what(), HasSubstr("signal 11 (Segmentation fault) at point 1500 of 1500"));
  laszip_faults.read = 9;  // the first failure is the one that tells
  EXPECT_THAT(error_of(file)->what(), HasSubstr("LASzip: as the test wants it at point 10 of 1500"));
  laszip_books = {};
}

TEST_F(LazReader, GreedForMemoryIsAnErrorOfTheFile) {
#if SPARSHA_SANITIZED
  GTEST_SKIP() << "sanitizers bring their own malloc";
#endif
  EXPECT_THAT(message_when([] { const std::vector<char> memory(std::size_t{4} << 30U); }),
              HasSubstr("MB of memory at point 700 of 1500"));
}

TEST_F(LazReader, LaszipThatHangsIsStoppedByCancelling) {
  laszip_faults.read = 699;
  laszip_faults.instead = [] {
    for (;;) ::pause();
  };
  const auto file = folder_.write("a.laz", packed(some_points(4, 7, 1500)));
  Progress progress;
  std::thread person([&] {
    while (laszip_books.reads < 699) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    progress.cancel();
  });
  EXPECT_THROW((void)read_scan(file, &progress), Cancelled);
  person.join();
  expect_no_child();
  ScanConfig config;
  config.file = file;
  EXPECT_THROW((void)load_scan(config, progress), Cancelled);
  laszip_books = {};
}

TEST_F(LazReader, RefusesATruncationAtEveryByteBeforeTheLibrarySeesTheFile) {
  const std::string bytes = packed(some_points(2, 3, 60));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const auto error = error_of(folder_.write("cut.laz", bytes.substr(0, length)));
    ASSERT_TRUE(error) << length;
    EXPECT_EQ(error->kind(), ErrorKind::input) << length;
  }
  EXPECT_EQ(laszip_books.created, 0);
}

TEST_F(LazReader, RefusesAChunkTableThatDoesNotFitTheFileOrThePoints) {
  const std::string whole = packed(some_points(2, 0, 60));
  std::uint32_t first = 0;
  std::memcpy(&first, whole.data() + 96, 4);
  const auto refused = [&](const std::string& bytes, const char* message) {
    const auto error = error_of(folder_.write("a.laz", bytes));
    ASSERT_TRUE(error) << message;
    EXPECT_THAT(error->what(), HasSubstr(message));
    EXPECT_EQ(laszip_books.created, 0);
  };
  std::string bytes = whole;
  for (const std::int64_t place :
       {std::int64_t{0}, std::int64_t{-2}, std::int64_t{1} << 62U, static_cast<std::int64_t>(whole.size() - 7)}) {
    set(bytes, first, place);
    refused(bytes, "the table of LAZ chunks should be at byte");
  }
  bytes = whole;
  set(bytes, bytes.size() - 4, std::uint32_t{0xFFFFFFF0});
  refused(bytes, "cannot be in");
  set(bytes, bytes.size() - 4, std::uint32_t{2});
  refused(bytes, "60 points are not in 2 LAZ chunks");
  bytes = whole;
  set(bytes, 107, std::uint32_t{4000000000U});
  refused(bytes, "4000000000 points are not in 1 LAZ chunks");
  // Written as a stream: the place of the table is told by the end of the file.
  bytes = whole;
  std::int64_t table = 0;
  std::memcpy(&table, whole.data() + first, 8);
  set(bytes, first, std::int64_t{-1});
  bytes += std::string(8, '\0');
  set(bytes, bytes.size() - 8, table);
  EXPECT_EQ(folder_.read("a.laz", bytes).records, 60U);
}

}  // namespace
}  // namespace sparsha::pipeline
