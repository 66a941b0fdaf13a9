// A hall of pillars, scanned from many stations whose rough poses drift: what repeats, slides and closes in a loop.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "pipeline/register/graph.h"
#include "tests/support/stations.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline::testing {
namespace {

constexpr double kNoise_m = 3e-3;
constexpr double kRange_m = 25.0;

/// Numbers from a seeded generator, the same with every library.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : random_(seed) {}
  double uniform(double from, double to) {
    return from + (to - from) * static_cast<double>(random_() >> 11U) * 0x1p-53;
  }
  double normal(double deviation) {
    double sum = -6.0;  // of twelve uniform numbers: nearly Gaussian
    for (int n = 0; n < 12; ++n) sum += uniform(0.0, 1.0);
    return deviation * sum;
  }
  Eigen::Vector3d vector(double deviation) { return {normal(deviation), normal(deviation), normal(deviation)}; }

 private:
  std::mt19937_64 random_;
};

/// Metres, z up: a floor with walls and a roof, two rows of pillars on square bases, and blocks along the walls.
class Hall {
 public:
  Hall(double length_m, Numbers& numbers) : length_m_(length_m) {
    for (const double y : {8.0, 16.0}) {
      for (double x = 4.0; x < length_m - 2.0; x += 5.0) {
        const Eigen::Vector2d middle(x + numbers.normal(0.03), y + numbers.normal(0.03));
        pillars_.push_back({middle, 0.45 + numbers.normal(0.02)});
        blocks_.push_back({{middle.x() - 0.7, middle.y() - 0.7, 0.0},
                           {middle.x() + 0.7, middle.y() + 0.7, 0.6 + numbers.normal(0.02)}});
      }
    }
    const int blocks = static_cast<int>(0.8 * length_m);
    for (int k = 0; k < blocks; ++k) {
      const Eigen::Vector3d size(numbers.uniform(0.3, 2.0), numbers.uniform(0.3, 1.5), numbers.uniform(0.3, 2.0));
      const double y = k % 2 == 0 ? 0.0 : kWidth_m - size.y();
      const Eigen::Vector3d low(numbers.uniform(0.0, length_m - size.x()), y, numbers.uniform(0.0, 5.0));
      blocks_.push_back({low, low + size});
    }
  }

  /// To what a ray meets from within the hall.
  [[nodiscard]] double distance(const Eigen::Vector3d& from, const Eigen::Vector3d& along) const {
    double nearest = std::numeric_limits<double>::infinity();
    const Eigen::Vector3d size(length_m_, kWidth_m, 10.0);
    for (int axis = 0; axis < 3; ++axis)
      nearest = std::min(nearest, ((along[axis] > 0.0 ? size[axis] : 0.0) - from[axis]) / along[axis]);
    for (const Pillar& pillar : pillars_) {
      const Eigen::Vector2d apart = from.head<2>() - pillar.middle;
      const double a = along.head<2>().squaredNorm();
      const double b = apart.dot(along.head<2>());
      const double root = b * b - a * (apart.squaredNorm() - pillar.radius_m * pillar.radius_m);
      if (root <= 0.0) continue;
      if (const double t = (-b - std::sqrt(root)) / a; t > 0.0) nearest = std::min(nearest, t);
    }
    for (const Block& block : blocks_) {
      const Eigen::Array3d low = (block.low - from).array() / along.array();
      const Eigen::Array3d high = (block.high - from).array() / along.array();
      const double enter = low.min(high).maxCoeff();
      if (enter > 0.0 && enter < low.max(high).minCoeff()) nearest = std::min(nearest, enter);
    }
    return nearest;
  }

  static constexpr double kWidth_m = 24.0;

 private:
  struct Pillar {
    Eigen::Vector2d middle;
    double radius_m;
  };
  struct Block {
    Eigen::Vector3d low;
    Eigen::Vector3d high;
  };
  double length_m_;
  std::vector<Pillar> pillars_;
  std::vector<Block> blocks_;
};

struct Stations {
  std::vector<scene::ScanConfig> truth;
  std::vector<scene::ScanConfig> drifted;  ///< each one's error is that of the one before and a little more
  double drift_m = 0.0;                    ///< of the worst station
};

/// `count` stations along one aisle and back along the other, as PLY files; the first's pose is true in both.
Stations stations_in_hall(const std::filesystem::path& folder, double length_m, int count, int rays, double turn,
                          double shift_m, std::uint64_t seed) {
  Numbers numbers(seed);
  const Hall hall(length_m, numbers);
  Stations result;
  Eigen::Isometry3d error = Eigen::Isometry3d::Identity();
  for (int k = 0; k < count; ++k) {
    const bool back = 2 * k >= count;
    const double along = 2.0 * k / count - (back ? 1.0 : 0.0);
    const double x = back ? length_m - 3.0 - (length_m - 6.0) * along : 3.0 + (length_m - 6.0) * along;
    const Eigen::Vector3d place(x + numbers.normal(0.3), (back ? 19.5 : 4.5) + numbers.normal(0.3), 1.6);
    const Eigen::Matrix3d facing =
        Eigen::AngleAxisd(numbers.uniform(0.0, 6.28), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    scene::ScanConfig scan;
    scan.file = folder / ("station-" + std::to_string(k) + ".ply");
    scan.units.unit = scene::LengthUnit::m;
    scan.pose = rigid(facing, place);
    std::vector<Eigen::Vector3d> points;
    for (int ray = 0; ray < rays; ++ray) {
      const double azimuth = numbers.uniform(0.0, 6.283185307179586);
      const double height = numbers.uniform(-1.05, 1.55);
      const Eigen::Vector3d direction(std::cos(height) * std::cos(azimuth), std::cos(height) * std::sin(azimuth),
                                      std::sin(height));
      const double distance_m = hall.distance(place, direction);
      if (distance_m < kRange_m && distance_m > 0.5)
        points.emplace_back(facing.transpose() * direction * (distance_m + numbers.normal(kNoise_m)));
    }
    std::ofstream file(scan.file, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size()
         << "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
    file.write(reinterpret_cast<const char*>(points.data()),
               static_cast<std::streamsize>(points.size() * sizeof(Eigen::Vector3d)));
    result.truth.push_back(scan);
    if (k > 0) {
      const Eigen::Vector3d axis = numbers.vector(turn);
      error.translate(numbers.vector(shift_m));
      error.rotate(Eigen::AngleAxisd(axis.norm(), axis.normalized()));
    }
    const Eigen::Affine3d about(Eigen::Translation3d(place) * error * Eigen::Translation3d(-place));
    scan.pose = about.matrix() * scan.pose;
    result.drift_m = std::max(result.drift_m, (scan.pose - result.truth.back().pose).topRightCorner<3, 1>().norm());
    result.drifted.push_back(scan);
  }
  return result;
}

double worst_place_m(const Stations& stations, const std::vector<Eigen::Matrix4d>& found) {
  double worst = 0.0;
  for (std::size_t s = 0; s < found.size(); ++s)
    worst = std::max(worst, (found[s] - stations.truth[s].pose).topRightCorner<3, 1>().norm());
  return worst;
}

std::size_t tried(const Registration& found) {
  std::size_t count = 0;
  for (const PairFit& pair : found.pairs) count += pair.use != PairFit::Use::none ? 1U : 0U;
  return count;
}

TEST(RegisterHall, TenStationsWhosePosesDriftComeBackWithinTheNoise) {
  const test::TestFolder folder;
  const Stations stations = stations_in_hall(folder.path(), 40.0, 10, 30000, 0.008, 0.1, 3);
  ASSERT_GT(stations.drift_m, 0.2);
  const Registration found = registered(stations.drifted);
  EXPECT_LT(worst_place_m(stations, found.poses), 2.0 * kNoise_m);
  EXPECT_LE(tried(found), 3 * stations.truth.size());
}

TEST(RegisterHall, WhatMaySlideIsRightOrRefused) {
  // Few stations far apart: floor and walls agree wherever along the hall they lie.
  const test::TestFolder folder;
  const Stations stations = stations_in_hall(folder.path(), 60.0, 8, 15000, 0.008, 0.1, 5);
  try {
    EXPECT_LT(worst_place_m(stations, registered(stations.drifted).poses), 5.0 * kNoise_m);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
  }
}

TEST(RegisterHall, FortyStationsCloseTheirLoop) {
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) GTEST_SKIP() << "runs at night";
  for (const std::uint64_t seed : {1, 2, 3}) {
    const test::TestFolder folder;
    const Stations stations = stations_in_hall(folder.path(), 80.0, 40, 40000, 0.012, 0.15, seed);
    ASSERT_GT(stations.drift_m, 0.5);
    const Registration found = registered(stations.drifted);
    EXPECT_LT(worst_place_m(stations, found.poses), kNoise_m) << "seed " << seed;
    EXPECT_LE(tried(found), 3 * stations.truth.size());
  }
}

/// Six scans in a ring of links, each 1 m beside the last; one link is 5 m off.
TEST(RegisterGraph, ALinkThatContradictsALoopIsNotFollowed) {
  std::vector<WeighedEdge> edges;
  std::vector<Eigen::Isometry3d> b_to_a;
  const auto add = [&](std::size_t a, std::size_t b, double x, double weight) {
    edges.push_back({{a, b}, weight});
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().x() = x;
    b_to_a.push_back(pose);
  };
  for (std::size_t s = 0; s + 1 < 6; ++s) add(s, s + 1, s == 2 ? 6.0 : 1.0, s == 2 ? 2.6 : 1.0);
  add(0, 5, 5.0, 0.5);
  add(1, 3, 2.0, 0.5);
  const auto agrees = [&](std::size_t edge, const Eigen::Isometry3d& told) {
    return (told.translation() - b_to_a[edge].translation()).norm() < 0.1;
  };
  for (std::size_t s = 0; s + 4 < 6; ++s) add(s, s + 4, 4.0, 0.5);
  for (std::size_t s = 0; s + 3 < 6; ++s) add(s, s + 3, 3.0, 2.5);
  const auto place = [&](const Tree& tree) {
    return poses_along(tree, 6, edges, b_to_a, Eigen::Isometry3d::Identity())[5].translation().x();
  };
  ASSERT_GT(std::fabs(place(heaviest_tree(6, edges)) - 5.0), 4.0) << "the wrong link is the heaviest";
  EXPECT_NEAR(place(agreed_tree(6, edges, b_to_a, agrees)), 5.0, 1e-12);
}

}  // namespace
}  // namespace sparsha::pipeline::testing
