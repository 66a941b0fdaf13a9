// What a recording's file gives back, and what is wrong with it.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "haptics/replay/path_device.h"
#include "haptics/replay/recorder.h"
#include "haptics/replay/recording.h"
#include "tests/support/records.h"
#include "tests/support/test_folder.h"

namespace sparsha::haptics {
namespace {

using test::TestFolder;

TEST(Recording, AnyDoubleSurvivesTheFileToTheLastBit) {
  const TestFolder folder;
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
  EXPECT_EQ(recording.windows().size(), 1U);
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
      ASSERT_EQ(row.tick.centre_m[axis], records[i].state.centre_m[static_cast<std::size_t>(axis)]);
    }
    ASSERT_EQ(row.tick.stiffness_n_per_m, records[i].state.stiffness_n_per_m);
  }
}

TEST(Recording, SaysWhatIsWrongWithAFileAndWhere) {
  const TestFolder folder;
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
  const TestFolder folder;
  const std::string rows = "t_s,device_x_m,device_y_m,device_z_m\n0,1,2,3\n0.001,4,5,6\n";
  for (const std::string cut : {"", "0.0", "0.002,7", "0.002,7,8,", "0.002,7,8,-"}) {
    std::ofstream(folder / "run.csv") << rows << cut;
    const Recording recording(folder / "run.csv");
    EXPECT_EQ(recording.rows().size(), 2U) << cut;
    EXPECT_EQ(recording.cut_short(), !cut.empty()) << cut;
  }
}

TEST(PathDevice, GivesRowByRowAndFinishes) {
  const TestFolder folder;
  std::ofstream(folder / "run.csv") << "t_s,device_x_m,device_y_m,device_z_m\n0,1,2,3\n0.001,4,5,6\n";
  const auto device = make_path_device(std::make_shared<const Recording>(folder / "run.csv"));
  EXPECT_NEAR(device->info().rate_hz, 1000.0, 1e-6);
  EXPECT_EQ(device->read(17.0, 0.001).position_m, Eigen::Vector3d(1.0, 2.0, 3.0));
  const DeviceSample second = device->read(0.0, 0.001);
  EXPECT_EQ(second.position_m, Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_EQ(second.time_s, 0.001);
  EXPECT_TRUE(second.fresh);
  EXPECT_FALSE(second.finished);
  EXPECT_TRUE(device->read(0.0, 0.001).finished);
}

}  // namespace
}  // namespace sparsha::haptics
