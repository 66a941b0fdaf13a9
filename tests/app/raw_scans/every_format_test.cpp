// A file of every format, dropped into the window, is shown, and gets a configuration as `sparsha new` makes it.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "app/raw_scans/depth_scans.h"
#include "base/files/files.h"
#include "pipeline/scan/formats/formats.h"
#include "tests/support/test_folder.h"
#include "tests/support/wait.h"
#include "tests/support/wave_files.h"

namespace sparsha::app {
namespace {

using pipeline::testing::WaveFile;

TEST(EveryFormat, GetsAConfigurationAndIsShownWhenItIsDropped) {
  const test::TestFolder folder;
  std::set<std::string_view> seen;
  for (const WaveFile& wave : pipeline::testing::wave_files()) {
    if (!seen.insert(wave.format).second) continue;
    const std::filesystem::path file = folder / std::string(wave.name);
    write_file(file, wave.bytes({24}));
    DepthScans scans(std::vector<std::filesystem::path>{file});  // as a drop opens it
    EXPECT_EQ(scans.unavailable(), "") << wave.format;
    scans.open();
    test::wait_until([&] { return !scans.status().busy; });
    ASSERT_TRUE(scans.status().points) << wave.format << ": " << scans.status().note;
    EXPECT_GE(scans.status().points->points.size(), 575U) << wave.format;  // PTX has none in the scanner's place
    ASSERT_GT(scans.status().proposals, 0U) << wave.format << ": " << scans.status().note;
    EXPECT_GT(scans.config_of(scans.status().proposal).grid.spacing_m, 0.0) << wave.format;
  }
  for (const pipeline::Format& format : pipeline::formats())
    EXPECT_TRUE(seen.contains(format.name)) << format.name << " has no file in tests/support/wave_files.cpp";
}

}  // namespace
}  // namespace sparsha::app
