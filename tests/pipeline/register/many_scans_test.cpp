// Many stations, stations of very different densities, one that sees another object, and the same one several times.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "tests/support/stations.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline::testing {
namespace {

using ::testing::HasSubstr;

constexpr double kNoise_m = 1e-4;

int few(int /*station*/) { return 3000; }

TEST(RegisterMany, TwelveAndTwentyStationsInACircleComeBackToAThirdOfTheNoise) {
  for (const int stations : {12, 20}) {
    const test::TestFolder folder;
    const std::vector<ScanConfig> truth = ring(folder.path(), stations, few, kNoise_m, 1);
    const Registration found = registered(disturbed(truth, 1, 4.0, 0.006));
    EXPECT_LT(rms_error(truth, found.poses), kNoise_m / 3.0) << stations << " stations";
  }
}

TEST(RegisterMany, OfTwelveStationsTheOneThatSeesSomethingElseIsNamed) {
  const test::TestFolder folder;
  std::vector<ScanConfig> scans = ring(folder.path(), 12, few, kNoise_m, 1);
  scans[7].pose.topRightCorner<3, 1>() += Eigen::Vector3d(0.0, 0.0, 5.0);
  try {
    (void)registered(disturbed(scans, 2, 2.0, 0.003));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), HasSubstr("station-7.ply"));
  }
}

TEST(RegisterMany, StationsOfDensitiesOneToAHundredComeBack) {
  const test::TestFolder folder;
  const auto points = [](int station) { return station % 2 == 0 ? 200000 : 2000; };
  const std::vector<ScanConfig> truth = ring(folder.path(), 6, points, kNoise_m, 3);
  const Registration found = registered(disturbed(truth, 3, 4.0, 0.006));
  // The sparse stations' points lie 4.7 mm apart: a tenth of that.
  EXPECT_LT(rms_error(truth, found.poses), 0.47e-3);
}

TEST(RegisterMany, TheSameStationFiveTimesBecomesOne) {
  const test::TestFolder folder;
  const std::vector<ScanConfig> one = ring(folder.path(), 1, few, kNoise_m, 4);
  const std::vector<ScanConfig> truth(5, one.front());
  const Registration found = registered(disturbed(truth, 4, 4.0, 0.006));
  EXPECT_LT(rms_error(truth, found.poses), 1e-6);
}

}  // namespace
}  // namespace sparsha::pipeline::testing
