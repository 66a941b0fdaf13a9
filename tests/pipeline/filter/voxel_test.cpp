// The voxel filter against PCL's and in numbers: the same centroids, whatever the order of points.
#include "pipeline/filter/filter.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>

#include "base/error.h"
#include "tests/pipeline/filter/filtered_clouds.h"

namespace sparsha::pipeline {
namespace {

using testing::cloud_of;
using testing::Points;
using testing::points_of;
using testing::relief;

TEST(VoxelFilter, GivesTheCentroidsOfPclsVoxelGrid) {
  ThreadPool pool(2);
  Progress progress;
  Points points = relief(20000, 11);
  points.pop_back();  // the far one would overflow PCL's indices
  Cloud cloud = cloud_of(points);
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setInputCloud(std::make_shared<pcl::PointCloud<pcl::PointXYZ>>(*cloud.points));
  const float leaf = 0.0625F;  // a power of two, so that both find the same cell for every float
  grid.setLeafSize(leaf, leaf, leaf);
  pcl::PointCloud<pcl::PointXYZ> expected;
  grid.filter(expected);
  const FilterSteps counts = apply_filters(cloud, {scene::VoxelConfig{static_cast<double>(leaf)}}, {pool, progress});
  ASSERT_EQ(cloud.size(), expected.size());
  EXPECT_EQ(counts.filtered(), points.size() - expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    // PCL adds up to some hundred float32 numbers below 1.
    EXPECT_NEAR(cloud.xyz1()[4 * i], expected[i].x, 2e-5F);
    EXPECT_NEAR(cloud.xyz1()[4 * i + 1], expected[i].y, 2e-5F);
    EXPECT_NEAR(cloud.xyz1()[4 * i + 2], expected[i].z, 2e-5F);
  }
}

TEST(VoxelFilter, WorksWherePclsIndicesOverflow) {
  ThreadPool pool(1);
  Progress progress;
  Cloud cloud = cloud_of({{0.1F, 0.1F, 0.1F}, {0.1001F, 0.1001F, 0.1001F}, {9e3F, 0, 0}, {0, 9e3F, 9e3F}}, true);
  apply_filters(cloud, {scene::VoxelConfig{0.001}}, {pool, progress});
  EXPECT_EQ(cloud.size(), 3U);
}

TEST(VoxelFilter, DoesNotDependOnTheOrderOfPointsAndAveragesAttributes) {
  ThreadPool pool(1);
  Progress progress;
  Points points = relief(4000, 2);
  Cloud cloud = cloud_of(points);
  apply_filters(cloud, {scene::VoxelConfig{0.03}}, {pool, progress});
  std::shuffle(points.begin(), points.end(), std::mt19937(1));
  Cloud shuffled = cloud_of(points);
  apply_filters(shuffled, {scene::VoxelConfig{0.03}}, {pool, progress});
  EXPECT_EQ(points_of(cloud), points_of(shuffled));

  Cloud two = cloud_of({{0.1F, 0.1F, 0.1F}, {0.2F, 0.2F, 0.2F}}, true);
  two.rgba = {0xFF000000U, 0xFF0000FEU};
  apply_filters(two, {scene::VoxelConfig{1.0}}, {pool, progress});
  EXPECT_EQ(two.rgba, std::vector<std::uint32_t>{0xFF00007FU});
  EXPECT_EQ(two.intensity, std::vector<float>{0.5F});
}

TEST(VoxelFilter, PointsWithoutColourOrIntensityLeaveTheMeansToTheOthers) {
  ThreadPool pool(1);
  Progress progress;
  Cloud cloud = cloud_of({{0.1F, 0.1F, 0.1F}, {0.2F, 0.2F, 0.2F}, {0.3F, 0.3F, 0.3F}, {1.5F, 0.5F, 0.5F}}, true);
  cloud.rgba = {0xFF0000FEU, kNoColour, 0xFF000000U, kNoColour};
  cloud.intensity = {kNoIntensity, 3.0F, kNoIntensity, kNoIntensity};
  apply_filters(cloud, {scene::VoxelConfig{1.0}}, {pool, progress});
  EXPECT_EQ(cloud.rgba, (std::vector<std::uint32_t>{0xFF00007FU, kNoColour}));
  ASSERT_EQ(cloud.intensity.size(), 2U);
  EXPECT_EQ(cloud.intensity[0], 3.0F);
  EXPECT_TRUE(std::isnan(cloud.intensity[1]));
}

TEST(VoxelFilter, GivesTheSameBytesInAnyOrderWhateverTheIntensities) {
  ThreadPool pool(1);
  Progress progress;
  std::mt19937 random(8);
  const Points points = relief(4000, 2);
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<float> intensity;
  std::vector<std::uint32_t> rgba;
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Of 60 powers of ten: added up in double, almost every mean would depend on the order.
    const double power = std::uniform_real_distribution<>(-30.0, 30.0)(random);
    intensity.push_back(static_cast<float>((i % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, power)));
    rgba.push_back(static_cast<std::uint32_t>(random()));
  }
  const auto thinned = [&](bool plain) {
    Points p;
    for (const std::size_t i : order) p.push_back(points[i]);
    Cloud cloud = cloud_of(p, true);
    for (std::size_t i = 0; i < order.size(); ++i) {
      cloud.rgba[i] = rgba[order[i]];
      cloud.intensity[i] = plain ? static_cast<float>(order[i] % 256) : intensity[order[i]];
    }
    apply_filters(cloud, {scene::VoxelConfig{0.03}}, {pool, progress});
    return cloud;
  };
  for (const bool plain : {false, true}) {
    const Cloud first = thinned(plain);
    ASSERT_LT(first.size(), points.size() / 3);
    for (int round = 0; round < 20; ++round) {
      std::shuffle(order.begin(), order.end(), random);
      const Cloud again = thinned(plain);
      EXPECT_EQ(points_of(first), points_of(again));
      EXPECT_EQ(first.rgba, again.rgba);
      ASSERT_EQ(first.intensity.size(), again.intensity.size());
      EXPECT_EQ(std::memcmp(first.intensity.data(), again.intensity.data(), 4 * again.intensity.size()), 0);
    }
  }
}

TEST(VoxelFilter, TheMeanOfIntensitiesIsExactToTheLastPlace) {
  ThreadPool pool(1);
  Progress progress;
  Cloud three = cloud_of({{0.1F, 0.1F, 0.1F}, {0.2F, 0.2F, 0.2F}, {0.3F, 0.3F, 0.3F}}, true);
  three.intensity = {1e30F, 6.0F, -1e30F};
  apply_filters(three, {scene::VoxelConfig{1.0}}, {pool, progress});
  EXPECT_EQ(three.intensity, std::vector<float>{2.0F});
  Cloud two = cloud_of({{0.1F, 0.1F, 0.1F}, {0.2F, 0.2F, 0.2F}}, true);
  two.intensity = {std::numeric_limits<float>::infinity(), 1.0F};
  apply_filters(two, {scene::VoxelConfig{1.0}}, {pool, progress});
  EXPECT_TRUE(std::isnan(two.intensity.at(0))) << "no number";
}

TEST(VoxelFilter, RefusesALeafBelowThePrecisionOfTheCoordinates) {
  ThreadPool pool(1);
  Progress progress;
  Cloud cloud = cloud_of({{0, 0, 0}, {1, 1, 1}});
  cloud.origin_m = {5e6, 0, 0};
  EXPECT_THROW(apply_filters(cloud, {scene::VoxelConfig{1e-9}}, {pool, progress}), Error);
}

}  // namespace
}  // namespace sparsha::pipeline
