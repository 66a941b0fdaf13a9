// Many stations, stations of very different densities, one that sees another object, and the same one several times.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>
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
    const std::vector<scene::ScanConfig> truth = ring(folder.path(), stations, few, kNoise_m, 1);
    const Registration found = registered(disturbed(truth, 1, 4.0, 0.006));
    EXPECT_LT(rms_error(truth, found.poses), kNoise_m / 3.0) << stations << " stations";
  }
}

TEST(RegisterMany, OfTwelveStationsTheOneThatSeesSomethingElseIsNamed) {
  const test::TestFolder folder;
  std::vector<scene::ScanConfig> scans = ring(folder.path(), 12, few, kNoise_m, 1);
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
  const std::vector<scene::ScanConfig> truth = ring(folder.path(), 6, points, kNoise_m, 3);
  const Registration found = registered(disturbed(truth, 3, 4.0, 0.006));
  // The sparse stations' points lie 4.7 mm apart: a tenth of that.
  EXPECT_LT(rms_error(truth, found.poses), 0.47e-3);
}

TEST(RegisterMany, TheSameStationFiveTimesBecomesOne) {
  const test::TestFolder folder;
  const std::vector<scene::ScanConfig> one = ring(folder.path(), 1, few, kNoise_m, 4);
  const std::vector<scene::ScanConfig> truth(5, one.front());
  const Registration found = registered(disturbed(truth, 4, 4.0, 0.006));
  EXPECT_LT(rms_error(truth, found.poses), 1e-6);
}

/// Five stations about a chain of seven rings 2.2 m long, 40 mm thick, every other one standing; each sees what faces
/// it.
std::vector<scene::ScanConfig> chain(const std::filesystem::path& folder, std::uint64_t seed) {
  const double pi = std::acos(-1.0);
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  std::vector<scene::ScanConfig> scans;
  for (int s = 0; s < 5; ++s) {
    const double angle = 2.0 * pi * s / 5.0;
    const Eigen::Vector3d station(0.84 + 6.0 * std::sin(angle), 2.0, 6.0 * std::cos(angle));
    std::ofstream file(folder / ("station-" + std::to_string(s) + ".xyz"));
    file.precision(9);
    for (int seen = 0; seen < 6000;) {
      const auto ring = static_cast<int>(7.0 * uniform());
      const double along = 2.0 * pi * uniform();
      const double about = 2.0 * pi * uniform();
      if (uniform() > (0.2 + 0.04 * std::cos(about)) / 0.24) continue;
      Eigen::Vector3d normal(std::cos(about) * std::cos(along), std::cos(about) * std::sin(along), std::sin(about));
      Eigen::Vector3d place = 0.2 * Eigen::Vector3d(std::cos(along), std::sin(along), 0.0) + 0.04 * normal;
      if (ring % 2 == 1) {
        normal = Eigen::Vector3d(normal.x(), -normal.z(), normal.y());
        place = Eigen::Vector3d(place.x(), -place.z(), place.y());
      }
      place += Eigen::Vector3d(0.28 * ring, 0.0, 0.03 * std::sin(ring));
      if (normal.dot(station - place) <= 0.0) continue;
      double sum = -6.0;  // of twelve uniform numbers: nearly Gaussian
      for (int n = 0; n < 12; ++n) sum += uniform();
      place += 5.0 * kNoise_m * sum * normal;
      file << place.x() << ' ' << place.y() << ' ' << place.z() << '\n';
      ++seen;
    }
    scene::ScanConfig scan;
    scan.file = folder / ("station-" + std::to_string(s) + ".xyz");
    scan.units.unit = scene::LengthUnit::m;
    scans.push_back(scan);
  }
  return scans;
}

TEST(RegisterMany, RingsOfAChainAreNotTakenForEachOtherInSilence) {
  const test::TestFolder folder;
  const std::vector<scene::ScanConfig> truth = chain(folder.path(), 5);
  int right = 0;
  const auto look_at = [&](std::uint64_t seed, double degrees, double shift_m) {
    try {
      const Registration found = registered(disturbed(truth, seed, degrees, shift_m));
      EXPECT_LT(rms_error(truth, found.poses), 10.0 * kNoise_m) << "seed " << seed;
      ++right;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    }
  };
  const bool nightly = std::getenv("SPARSHA_NIGHTLY") != nullptr;
  // Seeds 14 to 41 are those of the first 128 at which wrong links are nearest to right ones.
  for (const std::uint64_t seed : {14U, 20U, 21U, 41U}) look_at(seed, 10.0, 0.108);
  for (std::uint64_t seed = 1; seed <= 8 && nightly; ++seed) look_at(seed, 10.0, 0.108);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) look_at(seed, 2.0, 0.03);
  EXPECT_GE(right, 2) << "of poses that are nearer to the truth than to the next ring";
}

}  // namespace
}  // namespace sparsha::pipeline::testing
