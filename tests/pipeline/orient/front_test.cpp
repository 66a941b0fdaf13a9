// Fronts of a made bust and of real statues, whatever way they were turned when they were scanned.
#include "pipeline/orient/front.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "pipeline/scan/reader.h"
#include "tests/support/turned_points.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

using test::angle_deg;
using test::kDegree;
using test::Points;
using test::turned;

// Height over a ball of what lies around `at` in the direction `d`.
double bump(const Eigen::Vector3d& d, const Eigen::Vector3d& at, double height, double width) {
  return height * std::exp(-0.5 * (d - at.normalized()).squaredNorm() / (width * width));
}

// A head with a face to +z, shallow locks of hair all over its back, a neck and a square plinth; y up, 2.6 m tall.
Points bust(std::size_t count = 60'000, double noise_m = 0.004, bool plinth = true) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Points locks;
  while (locks.size() < 60) {
    const Eigen::Vector3d d = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    if (d.z() < 0.2) locks.push_back(d);
  }
  const auto radius = [&](const Eigen::Vector3d& d) {
    double r = 1.0 + bump(d, {0, 0.25, 1}, 0.08, 0.07) + bump(d, {0, 0.1, 1}, 0.12, 0.07) +
               bump(d, {0, -0.05, 1}, 0.16, 0.08) + bump(d, {0, -0.28, 0.95}, 0.04, 0.05) +
               bump(d, {0, -0.5, 0.9}, 0.05, 0.06) + bump(d, {0, -0.8, 0.8}, 0.1, 0.1);
    for (const double side : {-1.0, 1.0}) {
      r += bump(d, {0.33 * side, 0.22, 0.9}, -0.1, 0.1) + bump(d, {0.33 * side, 0.5, 0.85}, 0.06, 0.1) +
           bump(d, {0.1 * side, -0.4, 0.9}, -0.08, 0.05) + bump(d, {side, 0, 0}, 0.12, 0.12);
    }
    for (const Eigen::Vector3d& lock : locks) r += bump(d, lock, 0.015, 0.07);
    return r;
  };
  Points points;
  while (points.size() < count) {
    const Eigen::Vector3d noise = noise_m * Eigen::Vector3d(normal(random), normal(random), normal(random));
    const double part = (plinth ? 1.0 : 0.75) * (0.5 + 0.5 * unit(random));
    const double angle = std::numbers::pi * unit(random);
    const Eigen::Vector3d around(std::sin(angle), 0.0, std::cos(angle));
    const Eigen::Vector3d down = -Eigen::Vector3d::UnitY();
    if (part < 0.65) {
      const Eigen::Vector3d d = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      const Eigen::Vector3d p = radius(d) * d.cwiseProduct(Eigen::Vector3d(0.75, 1.0, 0.9));
      if (p.y() > -0.7 || p.z() > 0.5) points.push_back(p + noise);
    } else if (part < 0.75) {
      points.push_back(0.45 * around + (1.0 + 0.3 * unit(random)) * down + noise);
    } else {
      Eigen::Vector3d p(unit(random), unit(random), unit(random));
      const int axis = static_cast<int>(points.size() % 4);
      if (axis < 3) p[axis] = p[axis] < 0.0 ? -1.0 : 1.0;
      if (axis == 3) p.y() = -1.0;
      points.push_back(Eigen::Vector3d(0.7, 0.15, 0.7).cwiseProduct(p) + 1.45 * down + noise);
    }
  }
  return points;
}

FrontView front_of(const Points& points, bool z_up = false) {
  const EvenPoints even = even_points(points);
  const std::optional<Standing> standing = standing_of(even, z_up);
  EXPECT_TRUE(standing.has_value());
  const std::optional<FrontView> front = find_front(even, *standing);
  EXPECT_TRUE(front.has_value());
  return *front;
}

TEST(Front, OfABustIsItsFaceHoweverItWasTurnedAboutItsUprightAxis) {
  const Points points = bust();
  for (const double turn_deg : {0.0, 37.0, 90.0, 141.0, 180.0, 263.0}) {
    SCOPED_TRACE(turn_deg);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(turn_deg * kDegree, Eigen::Vector3d::UnitY()).toRotationMatrix();
    const FrontView front = front_of(turned(points, turn));
    EXPECT_EQ(front.up, Eigen::Vector3d::UnitY());
    // 7.5 degrees between the views that are tried, and the axis of the scan within 12.
    EXPECT_LT(angle_deg(front.look_from, turn * Eigen::Vector3d::UnitZ()), 12.0);
    EXPECT_FALSE(front.open()) << front.rival;
  }
}

// Turns that leave no axis near where one was.
std::vector<Eigen::Matrix3d> any_turns(std::size_t count) {
  std::mt19937_64 random(20);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Matrix3d> turns;
  while (turns.size() < count)
    turns.push_back(Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                        .normalized()
                        .toRotationMatrix());
  return turns;
}

TEST(Front, OfABustIsItsFaceUprightHoweverItWasTurned) {
  for (const bool plinth : {true, false}) {
    const Points points = bust(30'000, 0.004, plinth);
    for (const Eigen::Matrix3d& turn : any_turns(3)) {
      const FrontView front = front_of(turned(points, turn));
      // Without a base a face tells it, from views 15 degrees apart.
      EXPECT_LT(angle_deg(front.up, turn * Eigen::Vector3d::UnitY()), plinth ? 5.0 : 20.0) << front.reason;
      EXPECT_LT(angle_deg(front.look_from, turn * Eigen::Vector3d::UnitZ()), plinth ? 8.0 : 20.0) << front.reason;
      EXPECT_FALSE(front.open());
    }
  }
}

TEST(Front, UpIsFromTheBaseWhereCustomSaysOtherwise) {
  const Points points = bust();
  Eigen::Matrix3d z_up;  // as programs write it whose z is up
  z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const Eigen::Matrix3d upside_down = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Matrix3d tilted =
      Eigen::AngleAxisd(50.0 * kDegree, Eigen::Vector3d(1, 0.2, 0.3).normalized()).toRotationMatrix();
  for (const Eigen::Matrix3d& turn : {z_up, upside_down}) {
    const FrontView front = front_of(turned(points, turn));
    EXPECT_LT(angle_deg(front.up, turn * Eigen::Vector3d::UnitY()), 1e-3) << front.reason;
    EXPECT_LT(angle_deg(front.look_from, turn * Eigen::Vector3d::UnitZ()), 12.0) << front.reason;
  }
  EXPECT_LT(angle_deg(front_of(turned(points, tilted)).up, tilted * Eigen::Vector3d::UnitY()), 1.5);
  EXPECT_EQ(front_of(turned(points, z_up), true).up, Eigen::Vector3d::UnitZ());
}

TEST(Standing, OfAHeadWithoutABaseIsUprightWhicheverOfYAndZIsUp) {
  const Points points = bust(30'000, 0.004, false);
  Eigen::Matrix3d z_up;
  z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  for (const double turn_deg : {0.0, 52.0}) {
    const Eigen::Matrix3d about = Eigen::AngleAxisd(turn_deg * kDegree, Eigen::Vector3d::UnitY()).toRotationMatrix();
    for (const Eigen::Matrix3d& turn : {about, Eigen::Matrix3d(z_up * about)}) {
      for (const bool custom_z : {false, true}) {
        const std::optional<Standing> standing = standing_of(even_points(turned(points, turn)), custom_z);
        ASSERT_TRUE(standing);
        EXPECT_LT(angle_deg(standing->up, turn * Eigen::Vector3d::UnitY()), 1e-3) << standing->reason;
      }
    }
  }
}

TEST(Front, IsTheSameAmongScatteredPoints) {
  Points points = bust();
  const double pixel_m = even_points(points).pixel_m;
  std::mt19937 random(23);
  std::uniform_real_distribution<double> unit(-3.0, 3.0);
  const std::size_t scattered = points.size() / 20;
  for (std::size_t n = 0; n < scattered; ++n) points.emplace_back(unit(random), unit(random), unit(random));
  const EvenPoints even = even_points(points);
  // The box that the pixels are parts of ends with the object, within the tails that it leaves out.
  EXPECT_NEAR(even.pixel_m, pixel_m, 0.03 * pixel_m);
  const FrontView front = front_of(points);
  EXPECT_EQ(front.up, Eigen::Vector3d::UnitY());
  EXPECT_LT(angle_deg(front.look_from, Eigen::Vector3d::UnitZ()), 12.0);
  EXPECT_FALSE(front.open()) << front.rival;
}

TEST(Front, StaysTheSameUnderNanometresAndInAnyOrder) {
  Points points = bust(30'000);
  const FrontView once = front_of(points);
  std::mt19937 random(5);
  std::shuffle(points.begin(), points.end(), random);
  EXPECT_EQ(front_of(points).look_from, once.look_from);
  for (int n = 1; n <= 6; ++n) {
    Points shifted;
    for (const Eigen::Vector3d& p : points) shifted.emplace_back(p + 1e-9 * n * Eigen::Vector3d(1, -1, 0.5));
    const FrontView front = front_of(shifted);
    EXPECT_EQ(front.up, once.up);
    EXPECT_LT(angle_deg(front.look_from, once.look_from), 1e-6);
  }
}

TEST(Front, OfABallIsOpenAndAsCustomHasIt) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Points points;
  while (points.size() < 20'000)
    points.push_back(Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
  const FrontView front = front_of(points);
  EXPECT_EQ(front.up, Eigen::Vector3d::UnitY());
  if (front.open()) {
    EXPECT_EQ(front.look_from.cwiseAbs().maxCoeff(), 1.0);
  }
}

TEST(SidePicture, TellsWhatWasScannedFromOneSideFromWhatIsSolid) {
  Points shell;
  for (const Eigen::Vector3d& p : bust())
    if (p.z() > 0.3) shell.push_back(p);
  const Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  const auto share = [&](const Points& points) {
    const EvenPoints even = even_points(points);
    return seen_share(even, picture_from(even, ahead, up), ahead, up);
  };
  EXPECT_GT(share(shell), 0.8);
  EXPECT_LT(share(bust()), 0.6);
}

TEST(SidePicture, OfPointsWithoutExtentThereIsNone) {
  EXPECT_TRUE(even_points({}).points.empty());
  EXPECT_TRUE(even_points(Points(100, Eigen::Vector3d(1, 2, 3))).points.empty());
  EXPECT_FALSE(standing_of(EvenPoints{}, false).has_value());
}

// Corners as points: the statues here are finely triangulated.
TEST(Front, RealScanStatuesShowTheirFaces) {
  const char* folder = std::getenv("SPARSHA_SCANS_DIR");
  if (folder == nullptr) GTEST_SKIP() << "SPARSHA_SCANS_DIR is not set: no real scans at hand";
  Eigen::Matrix3d z_up;
  z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  for (const char* name : {"nefertiti-lowres.obj", "demosthenes-low-res.obj", "laurana.ply", "igea.ply", "oni.ply"}) {
    SCOPED_TRACE(name);
    const Points points = read_scan(fs::path(folder) / "heritage" / name).points;
    for (const double turn_deg : {0.0, 37.0, 200.0}) {
      const Eigen::Matrix3d turn = Eigen::AngleAxisd(turn_deg * kDegree, Eigen::Vector3d::UnitY()).toRotationMatrix();
      const FrontView front = front_of(turned(points, turn));
      EXPECT_EQ(front.up, Eigen::Vector3d::UnitY());
      EXPECT_LT(angle_deg(front.look_from, turn * Eigen::Vector3d::UnitZ()), 16.0) << turn_deg;
      // The same in the frame of a program whose z is up. The neck of this one is as much like a face from below.
      if (std::string(name) == "igea.ply") continue;
      const FrontView of_z = front_of(turned(points, z_up * turn));
      EXPECT_EQ(of_z.up, Eigen::Vector3d::UnitZ()) << of_z.reason;
      EXPECT_LT(angle_deg(of_z.look_from, z_up * turn * Eigen::Vector3d::UnitZ()), 16.0) << turn_deg;
    }
  }
}

TEST(Front, RealScanStatuesShowTheirFacesHoweverTheyAreTurned) {
  const char* folder = std::getenv("SPARSHA_SCANS_DIR");
  if (folder == nullptr) GTEST_SKIP() << "SPARSHA_SCANS_DIR is not set: no real scans at hand";
  for (const char* name : {"nefertiti-lowres.obj", "demosthenes-low-res.obj", "laurana.ply", "igea.ply", "oni.ply"}) {
    SCOPED_TRACE(name);
    const Points points = read_scan(fs::path(folder) / "heritage" / name).points;
    for (const Eigen::Matrix3d& turn : any_turns(3)) {
      const FrontView front = front_of(turned(points, turn));
      EXPECT_LT(angle_deg(front.up, turn * Eigen::Vector3d::UnitY()), 22.5) << front.reason;
      EXPECT_LT(angle_deg(front.look_from, turn * Eigen::Vector3d::UnitZ()), 22.5) << front.reason;
    }
  }
}

}  // namespace
}  // namespace sparsha::pipeline
