#include "haptics/servo/recorder.h"

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

#include "haptics/device/devices.h"
#include "haptics/device/playback/recording.h"
#include "pipeline/base/error.h"

namespace sparsha::haptics {
namespace {

class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() / ("sparsha-recorder-" + std::to_string(std::random_device{}()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  [[nodiscard]] std::filesystem::path operator/(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

Record record_at(std::uint64_t tick) {
  Record record;
  record.state.tick = tick;
  record.state.time_s = 0.001 * static_cast<double>(tick);
  record.state.flags = kFlagHomed;
  record.period_s = 0.001;
  record.nominal_period_s = 0.001;
  record.state.window = {0, 0, 10, 10};
  return record;
}

TEST(Recorder, WritesEveryRowOfAFastServo) {
  const Folder folder;
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

TEST(Recorder, AnyDoubleSurvivesTheFileToTheLastBit) {
  const Folder folder;
  std::mt19937_64 random(3);
  std::vector<Record> records;
  for (std::uint64_t tick = 1; tick <= 2000; ++tick) {
    Record record = record_at(tick);
    for (double& value : record.raw_device_m) {
      do value = std::bit_cast<double>(random());
      while (!std::isfinite(value));
    }
    for (double& value : record.state.centre_m) value = std::generate_canonical<double, 53>(random) * 5.4e6;
    record.state.scale = std::generate_canonical<double, 53>(random);
    record.state.stiffness_n_per_m = std::generate_canonical<double, 53>(random) * 1000.0;
    records.push_back(record);
  }
  records[7].raw_device_m[1] = std::numeric_limits<double>::quiet_NaN();
  records[8].raw_device_m[2] = -std::numeric_limits<double>::infinity();
  DeviceInfo device;
  device.limits.max_force_n = 7.25;
  device.workspace_width_m = 0.08;
  Recorder recorder(folder / "run.csv", device, 1000.0);
  recorder.start();
  for (const Record& record : records) ASSERT_TRUE(recorder.push(record));
  static_cast<void>(recorder.finish());

  const Recording recording(folder / "run.csv");
  ASSERT_EQ(recording.rows().size(), records.size());
  EXPECT_TRUE(recording.has_replay());
  EXPECT_EQ(recording.info().limits.max_force_n, 7.25);
  EXPECT_EQ(recording.info().workspace_width_m, 0.08);
  EXPECT_NEAR(recording.period_s(), 0.001, 1e-9);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const RecordedRow& row = recording.rows()[i];
    ASSERT_EQ(row.time_s, records[i].state.time_s);
    for (int axis = 0; axis < 3; ++axis) {
      const double written = records[i].raw_device_m[static_cast<std::size_t>(axis)];
      if (std::isnan(written))
        ASSERT_TRUE(std::isnan(row.position_m[axis]));
      else
        ASSERT_EQ(std::bit_cast<std::uint64_t>(row.position_m[axis]), std::bit_cast<std::uint64_t>(written));
      ASSERT_EQ(row.replay.centre_m[axis], records[i].state.centre_m[static_cast<std::size_t>(axis)]);
    }
    ASSERT_EQ(row.replay.stiffness_n_per_m, records[i].state.stiffness_n_per_m);
  }
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
  const Folder folder;
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

TEST(Recording, SaysWhatIsWrongWithAFileAndWhere) {
  const Folder folder;
  const auto message = [&](const std::string& text) -> std::string {
    std::ofstream(folder / "run.csv") << text;
    try {
      const Recording recording(folder / "run.csv");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message("t_s,device_x_m,device_y_m\n0,0,0\n").find("device_z_m"), std::string::npos);
  EXPECT_NE(message("t_s,device_x_m,device_y_m,device_z_m\n0,0,0,0\n1,x,0,0\n").find(":3"), std::string::npos);
  EXPECT_NE(message("t_s,device_x_m,device_y_m,device_z_m\n0,0,0,0,0\n").find(":2"), std::string::npos);
  EXPECT_NE(message("t_s,device_x_m,device_y_m,device_z_m\n1,0,0,0\n1,0,0,0\n").find("increase"), std::string::npos);
  EXPECT_NE(message("t_s,device_x_m,device_y_m,device_z_m\n").find("no rows"), std::string::npos);
  EXPECT_EQ(message("t_s,device_x_m,device_y_m,device_z_m\r\n0,0,0,0\r\n"), "");
  const std::string columns = "t_s,device_x_m,device_y_m,device_z_m,buttons,level,period_s\n";
  EXPECT_EQ(message(columns + "0,nan,-inf,0,0,0,0.001\n"), "") << "what a broken device gave is played again";
  EXPECT_EQ(message("\xEF\xBB\xBF" + columns + "0,0,0,0,0,0,0.001\n"), "");
  EXPECT_NE(message(columns + "0,0,0,0,1e300,0,0.001\n").find(":2: error: an impossible buttons"), std::string::npos);
  EXPECT_NE(message(columns + "0,0,0,0,0,-1e12,0.001\n").find("level"), std::string::npos);
  EXPECT_NE(message(columns + "0,0,0,0,0,0,0\n").find("period_s"), std::string::npos);
  EXPECT_NE(message(columns + "nan,0,0,0,0,0,0.001\n").find("t_s"), std::string::npos);
  EXPECT_THROW(Recording("/nonexistent.csv"), Error);
}

TEST(Recording, OfARunThatWasKilledIsReadableUpToItsLastWholeRow) {
  const Folder folder;
  const std::string rows = "t_s,device_x_m,device_y_m,device_z_m\n0,1,2,3\n0.001,4,5,6\n";
  for (const std::string cut : {"", "0.0", "0.002,7", "0.002,7,8,", "0.002,7,8,-"}) {
    std::ofstream(folder / "run.csv") << rows << cut;
    const Recording recording(folder / "run.csv");
    EXPECT_EQ(recording.rows().size(), 2U) << cut;
    EXPECT_EQ(recording.cut_short(), !cut.empty()) << cut;
  }
}

TEST(PlaybackDevice, PlaysRowByRowAndFinishes) {
  const Folder folder;
  std::ofstream(folder / "run.csv") << "t_s,device_x_m,device_y_m,device_z_m\n0,1,2,3\n0.001,4,5,6\n";
  const auto device = make_playback_device(folder / "run.csv");
  EXPECT_EQ(device->read(17.0, 0.001).position_m, Eigen::Vector3d(1.0, 2.0, 3.0));
  const DeviceSample second = device->read(0.0, 0.001);
  EXPECT_EQ(second.position_m, Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_EQ(second.time_s, 0.001);
  EXPECT_TRUE(second.fresh);
  EXPECT_TRUE(device->read(0.0, 0.001).finished);
}

}  // namespace
}  // namespace sparsha::haptics
