// Lines are told from strips and reliefs, wherever they lie and however their coordinates were rounded.
#include "pipeline/scan/straight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sparsha::pipeline {
namespace {

using Points = std::vector<Eigen::Vector3d>;

class StraightLines : public ::testing::Test {
 protected:
  /// From `begin` along `way`, with noise in all directions, rounded to `step` where it is not zero.
  Points line(std::size_t count, const Eigen::Vector3d& begin, const Eigen::Vector3d& way, double noise = 0.0,
              double step = 0.0) {
    Points points;
    for (std::size_t k = 0; k < count; ++k) {
      Eigen::Vector3d p = begin + way * (static_cast<double>(k) / static_cast<double>(count - 1));
      for (double& value : p) {
        value += noise * normal_(random_);
        if (step > 0.0) value = std::round(value / step) * step;
      }
      points.push_back(p);
    }
    return points;
  }
  std::mt19937 random_{5};
  std::normal_distribution<double> normal_{0.0, 1.0};
};

TEST_F(StraightLines, AreFoundWhereverTheyLie) {
  for (const Eigen::Vector3d& begin :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(443000.0, 5512000.0, 120.0), Eigen::Vector3d(-7, 3, 1e6)}) {
    for (const Eigen::Vector3d& way : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(7, 4, 0.3),
                                       Eigen::Vector3d(0.01, 0.02, 0.03), Eigen::Vector3d(300, -200, 5)}) {
      for (const double noise : {0.0, 1e-6}) {
        const auto found = straight_line(line(546, begin, way, noise * way.norm()), 546);
        ASSERT_TRUE(found) << begin.transpose() << " / " << way.transpose() << " / " << noise;
        EXPECT_NEAR(found->length, way.norm(), 1e-4 * way.norm());
      }
    }
  }
}

TEST_F(StraightLines, MayBeRoundedToMillimetres) {
  EXPECT_TRUE(straight_line(line(546, {443000.0, 5512000.0, 120.0}, {8, 6, 1}, 0.0, 1e-3), 546));
  EXPECT_TRUE(straight_line(line(100, {1, 2, 3}, {1, 1, 1}, 0.0, 1e-3), 100));
}

TEST_F(StraightLines, MayBeRoundedToFloat32FarFromZero) {
  for (const std::size_t count : {50U, 1000U}) {
    Points points = line(count, {-80423.1, 47555.3, 364367.7}, {0.3, 0.7, -0.6});
    for (Eigen::Vector3d& p : points) p = p.cast<float>().cast<double>();
    EXPECT_TRUE(straight_line(points, count)) << count;
    // Two rows that are four steps apart are a strip.
    for (std::size_t k = 0; k < count; k += 2) points[k].z() += 0.125;
    EXPECT_FALSE(straight_line(points, count)) << count;
  }
}

TEST_F(StraightLines, AReliefFarFromZeroIsNoneThoughFloat32LeavesItOneStepOfY) {
  Points points;
  for (int k = 0; k < 546; ++k) {
    const Eigen::Vector3d p(412345.0 + 0.02 * (k % 26), 5654321.0 + 0.02 * (k / 26), 100.0 + 0.01 * std::sin(0.3 * k));
    points.push_back(p.cast<float>().cast<double>());
  }
  EXPECT_FALSE(straight_line(points, points.size()));
}

TEST_F(StraightLines, OnePlaceIsOneToo) {
  for (const std::size_t count : {1U, 2U, 500U}) {
    const auto found = straight_line(Points(count, {443000.125, 5512000.25, 120.5}), count);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->length, 0.0);
  }
  EXPECT_FALSE(straight_line({}, 0));
}

TEST_F(StraightLines, StripsAndReliefsAreNone) {
  for (const int length : {2, 3, 10, 450, 2000, 5000}) {
    Points strip;
    for (int k = 0; k < length; ++k) {
      for (const double y : {0.0, 0.01}) strip.emplace_back(0.01 * k, y, 0.0);
    }
    EXPECT_FALSE(straight_line(strip, strip.size())) << length;
  }
  Points profile, relief;
  for (int k = 0; k < 500; ++k) {
    profile.emplace_back(0.01 * k, 0.0, 0.001 * std::sin(0.1 * k));
    relief.emplace_back(0.01 * (k % 25), 0.01 * (k / 25), 0.0);
  }
  EXPECT_FALSE(straight_line(profile, profile.size()));
  EXPECT_FALSE(straight_line(relief, relief.size()));
}

TEST_F(StraightLines, AFewPointsThatBendAreNone) {
  EXPECT_FALSE(straight_line(line(10, {0, 0, 0}, {4, 2, 1}, 0.015), 10));
}

TEST_F(StraightLines, AFewStraysDoNotHideThem) {
  Points points = line(4000, {5, 5, 5}, {1, 2, 3});
  for (int k = 0; k < 4; ++k) points.emplace_back(100.0 * k, -50.0, 20.0);
  EXPECT_TRUE(straight_line(points, points.size()));
}

}  // namespace
}  // namespace sparsha::pipeline
