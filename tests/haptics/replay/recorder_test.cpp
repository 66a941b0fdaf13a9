#include "haptics/replay/recorder.h"

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"
#include "tests/support/records.h"
#include "tests/support/soft_stone.h"
#include "tests/support/test_folder.h"

namespace sparsha::haptics {
namespace {

using test::TestFolder;

TEST(Recorder, WritesEveryRowOfAFastServo) {
  const TestFolder folder;
  constexpr std::uint64_t kRows = 40'000;
  Recorder recorder(folder / "run.csv", DeviceInfo{}, 10'000.0);
  recorder.start();
  for (std::uint64_t tick = 1; tick <= kRows; ++tick) {
    ASSERT_TRUE(recorder.push(record_at(tick)));
    if (tick % 1000 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const RunFigures figures = recorder.finish();
  EXPECT_EQ(figures.rows, kRows);
  EXPECT_EQ(recorder.dropped(), 0U);
  std::ifstream stream(folder / "run.csv");
  std::uint64_t lines = 0;
  for (std::string line; std::getline(stream, line);) ++lines;
  EXPECT_EQ(lines, kRows + 1);
}

TEST(Recorder, ItsFiguresAreOfTheForceThatTheHandGets) {
  test::SoftStone stone(window_on(test::flat_scene()));
  Recorder recorder({}, DeviceInfo{}, 1000.0);
  recorder.start();
  for (int k = 0; k < 200; ++k) {
    EXPECT_GT(stone.stroke(1e-5 * k).force_n[2], stone.kRaw_n);
    ASSERT_TRUE(recorder.push(stone.renderer().record()));
  }
  const RunFigures figures = recorder.finish();
  EXPECT_EQ(figures.rows, 200U);
  EXPECT_EQ(figures.peak_force_n, 0.0);
  EXPECT_EQ(figures.mean_force_n, 0.0);
}

TEST(Recorder, CountsTheRowsItCouldNotTake) {
  Recorder recorder({}, DeviceInfo{}, 100.0);
  std::uint64_t lost = 0;
  for (std::uint64_t tick = 1; tick <= 5000; ++tick)  // nobody reads: the queue fills
    if (!recorder.push(record_at(tick))) ++lost;
  EXPECT_GT(lost, 0U);
  EXPECT_EQ(recorder.dropped(), lost);
  recorder.start();
  EXPECT_EQ(recorder.finish().rows, 5000 - lost);
}

/// Files of this process cannot grow beyond some bytes, as on a full disk.
class ShortDisk {
 public:
  explicit ShortDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~ShortDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  ShortDisk(const ShortDisk&) = delete;
  ShortDisk& operator=(const ShortDisk&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST(Recorder, SaysWhenTheDiskIsFullAndLeavesNothingHalfWritten) {
  const TestFolder folder;
  const std::filesystem::path file = folder / "run.csv";
  {
    Recorder recorder(file, DeviceInfo{}, 1000.0);
    recorder.start();
    for (std::uint64_t tick = 1; tick <= 1000; ++tick) ASSERT_TRUE(recorder.push(record_at(tick)));
    const ShortDisk disk(4096);
    EXPECT_THROW(static_cast<void>(recorder.finish()), Error);
  }
  EXPECT_TRUE(std::filesystem::is_empty(file.parent_path()));
}

TEST(Recorder, CountsContactTimePathForceAndArea) {
  Recorder recorder({}, DeviceInfo{}, 1000.0);
  recorder.start();
  // Two strokes of 100 ticks in contact at 2 N over 0.1 m of device, 10 fine cells each; one more on a coarser level.
  std::uint64_t tick = 0;
  const auto stroke = [&](bool contact, std::uint64_t level, double x0) {
    for (int i = 0; i < 100; ++i) {
      Record record = record_at(++tick);
      record.state.contact = contact ? 1 : 0;
      record.state.level = level;
      record.state.device_m = {0.001 * i, 0.0, 0.0};
      record.cell_m = std::ldexp(0.001, static_cast<int>(level));
      record.cell_i = static_cast<std::int32_t>((x0 + 0.0001 * i + 0.00005) / record.cell_m);
      record.state.commanded_force_n = {0.0, 0.0, contact ? 2.0 : 0.0};
      ASSERT_TRUE(recorder.push(record));
    }
  };
  stroke(true, 0, 0.0);
  stroke(false, 0, 0.0);
  stroke(true, 0, 0.1);
  stroke(false, 0, 0.0);
  stroke(true, 2, 0.0);  // cells of 4 mm: 0 to 10 mm is three of them, which hold the first stroke's ten
  const RunFigures figures = recorder.finish();
  EXPECT_EQ(figures.contacts, 3U);
  EXPECT_NEAR(figures.contact_s, 0.3, 1e-9);
  EXPECT_NEAR(figures.mean_force_n, 2.0, 1e-9);
  EXPECT_EQ(figures.peak_force_n, 2.0);
  EXPECT_NEAR(figures.path_m, 5 * 0.099 + 4 * 0.099, 1e-9);
  EXPECT_NEAR(figures.area_m2, 10 * 1e-6 + 3 * 16e-6, 1e-12);
  EXPECT_EQ(figures.levels, (std::vector<int>{0, 2}));
  EXPECT_NEAR(figures.duration_s, 0.5, 1e-9);
}

TEST(Recorder, AreaIsThatOfTheScenesOwnCellsAndEachSceneHasItsOwn) {
  Recorder recorder({}, DeviceInfo{}, 1000.0);
  recorder.start();
  std::uint64_t tick = 0;
  const auto touch = [&](std::int32_t cell, double cell_m, std::uint64_t flags) {
    Record record = record_at(++tick);
    record.state.contact = 1;
    record.state.flags |= flags;
    record.cell_i = cell;
    record.cell_m = cell_m;
    ASSERT_TRUE(recorder.push(record));
  };
  for (const std::int32_t cell : {0, 1, 1, 0}) touch(cell, 0.001, 0);
  touch(-1, 0.001, kFlagOutside);
  for (const std::int32_t cell : {0, 1, 2}) touch(cell, 0.002, 0);  // a new depth scan
  EXPECT_NEAR(recorder.finish().area_m2, 2 * 1e-6 + 3 * 4e-6, 1e-15);
}

}  // namespace
}  // namespace sparsha::haptics
