// What a raw cloud is painted with.
#include "app/raw_scans/point_reader.h"

#include <cstdint>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "base/files/files.h"
#include "tests/support/test_folder.h"

namespace sparsha::app {
namespace {

// 40 points; colour and intensity of the points but the first are `grey` and `intensity`, those of the first `first`.
std::string cloud(int grey, int intensity, int first) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 40\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
      "red\nproperty uchar green\nproperty uchar blue\nproperty float intensity\nend_header\n";
  for (int n = 0; n < 40; ++n) {
    const std::string shade = std::to_string(n == 0 ? first : grey);
    text += std::to_string(n % 8) + " " + std::to_string(n / 8) + " 0 " + shade + " " + shade + " " + shade + " " +
            std::to_string(n == 0 ? first : intensity) + "\n";
  }
  return text;
}

TEST(PointReader, ColoursAndIntensitiesThatAllPointsHaveInCommonPaintNoBlackPatch) {
  const test::TestFolder folder;
  for (const auto& [grey, intensity, first, colours, intensities] :
       {std::tuple(0, 0, 0, false, false), std::tuple(90, 0, 0, true, false), std::tuple(0, 5, 0, false, true),
        std::tuple(255, 7, 0, true, true), std::tuple(200, 200, 200, false, false)}) {
    scene::ScanConfig scan;
    scan.file = folder.path() / "cloud.ply";
    write_file(scan.file, cloud(grey, intensity, first));
    Progress progress;
    const ReadPoints read = read_points({scan}, "cloud", progress);
    EXPECT_EQ(!read.view->rgba.empty(), colours) << grey << " " << intensity << " " << first;
    EXPECT_EQ(!read.view->intensity.empty(), intensities) << grey << " " << intensity << " " << first;
  }
}

}  // namespace
}  // namespace sparsha::app
