// Filters against brute force and PCL: the same decisions, whatever the order of points or the number of threads.
#include "pipeline/filter/filter.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>

#include "base/error.h"
#include "pipeline/filter/neighbour_tree.h"
#include "pipeline/filter/outliers.h"

namespace sparsha::pipeline {
namespace {

using Points = std::vector<std::array<float, 3>>;

Cloud cloud_of(const Points& points, bool attributes = false) {
  Cloud cloud;
  cloud.resize_points(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) cloud.xyz1()[4 * i + k] = points[i][k];
    if (attributes) {
      cloud.rgba.push_back(static_cast<std::uint32_t>(i));
      cloud.intensity.push_back(static_cast<float>(i));
    }
  }
  return cloud;
}

Points points_of(const Cloud& cloud) {
  Points points(cloud.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) points[i][k] = cloud.xyz1()[4 * i + k];
  }
  return points;
}

/// A noisy relief with outliers, density varying 1:100 and some duplicates.
Points relief(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::normal_distribution<float> normal(0.0F, 2e-4F);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const float u = uniform(random);
    const float x = u * u * u;
    const float y = uniform(random);
    float z = 0.05F * std::sin(6.0F * x) * std::cos(7.0F * y) + normal(random);
    if (i % 150 == 0) z += uniform(random);
    if (i % 97 == 1) {
      points.push_back(points.back());
    } else {
      points.push_back({x, y, z});
    }
  }
  points.push_back({1e4F, -1e4F, 3e3F});
  return points;
}

/// Mean distance to the k nearest others, by looking at all of them.
float brute_force_mean(const Points& points, std::size_t i, std::size_t k) {
  std::vector<double> distances;
  for (std::size_t j = 0; j < points.size(); ++j) {
    if (j == i) continue;
    double sum = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double d = static_cast<double>(points[j][axis]) - static_cast<double>(points[i][axis]);
      sum += d * d;
    }
    distances.push_back(std::sqrt(sum));
  }
  std::sort(distances.begin(), distances.end());
  k = std::min(k, distances.size());
  return static_cast<float>(
      std::accumulate(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(k), 0.0) /
      static_cast<double>(k));
}

TEST(NeighbourTree, AgreesWithBruteForceOnEveryPoint) {
  ThreadPool pool(2);
  Progress progress;
  for (const std::size_t count : {1U, 2U, 5U, 17U, 300U, 3000U}) {
    const Points points = relief(count, 5);
    for (const int k : {1, 8, 20}) {
      const Cloud cloud = cloud_of(points);
      const std::vector<float> mean =
          NeighbourTree(cloud.xyz1(), cloud.size(), {pool, progress}).mean_distances(k, {pool, progress});
      for (std::size_t i = 0; i < points.size(); i += 1 + count / 200) {
        const float expected = brute_force_mean(points, i, static_cast<std::size_t>(k));
        // Squares of float32 differences: a few roundings of the largest coordinate's last place.
        EXPECT_NEAR(mean[i], expected, 4e-7F * expected + 1e-9F) << "point " << i << " of " << points.size();
      }
    }
  }
}

TEST(OutlierFilter, DecidesAsPclDoesOnAllButOneInAThousandPoints) {
  ThreadPool pool(2);
  Progress progress;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Cloud cloud = cloud_of(relief(20000, seed));
    for (const int neighbours : {4, 8, 30}) {
      scene::OutlierConfig config;
      config.neighbours = neighbours;
      config.sigma = 0.1 * seed;
      const std::vector<std::uint8_t> own = statistical_inliers(cloud, config, {pool, progress});
      const std::vector<std::uint8_t> theirs = statistical_inliers_by_pcl(cloud, config, progress);
      std::size_t different = 0;
      for (std::size_t i = 0; i < own.size(); ++i) different += own[i] != theirs[i] ? 1 : 0;
      EXPECT_LE(different, own.size() / 1000) << "seed " << seed << ", " << neighbours << " neighbours";
    }
  }
}

TEST(OutlierFilter, DependsNeitherOnThreadsNorOnTheOrderOfPoints) {
  Progress progress;
  ThreadPool one(1);
  ThreadPool four(4);
  Points points = relief(5000, 7);
  points.resize(points.size() - 1);
  scene::OutlierConfig config;
  config.sigma = 1.0;
  const std::vector<std::uint8_t> expected = statistical_inliers(cloud_of(points), config, {one, progress});
  EXPECT_EQ(expected, statistical_inliers(cloud_of(points), config, {four, progress}));
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  Points shuffled;
  for (const std::size_t i : order) shuffled.push_back(points[i]);
  const std::vector<std::uint8_t> keep = statistical_inliers(cloud_of(shuffled), config, {four, progress});
  for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(keep[i], expected[order[i]]);
}

TEST(OutlierFilter, KeepsARegularLatticeWhole) {
  ThreadPool pool(1);
  Progress progress;
  Points ring;  // every point has the same distances to its neighbours
  for (int i = 0; i < 64; ++i) ring.push_back({static_cast<float>(i), 0.0F, 0.0F});
  scene::OutlierConfig config;
  config.neighbours = 1;
  config.sigma = 0.0;
  const std::vector<std::uint8_t> keep = statistical_inliers(cloud_of(ring), config, {pool, progress});
  EXPECT_THAT(keep, testing::Each(1));
}

TEST(OutlierFilter, TakesAwayThePointsFarFromAllOthersAndTheirAttributes) {
  ThreadPool pool(2);
  Progress progress;
  Points points;
  for (int i = 0; i < 400; ++i)
    points.push_back({0.01F * static_cast<float>(i % 20), 0.01F * static_cast<float>(i / 20), 0});
  points.insert(points.begin() + 7, {5.0F, 5.0F, 5.0F});
  Cloud cloud = cloud_of(points, true);
  cloud.faces.push_back({0, 1, 2});
  const FilterSteps counts = apply_filters(cloud, {scene::OutlierConfig{}}, {pool, progress});
  EXPECT_EQ(counts.outliers(), 1U);
  EXPECT_EQ(counts.filtered(), 0U);
  ASSERT_EQ(cloud.size(), 400U);
  EXPECT_EQ(cloud.rgba[6], 6U);
  EXPECT_EQ(cloud.rgba[7], 8U);
  EXPECT_EQ(cloud.intensity.back(), 400.0F);
  EXPECT_EQ(cloud.faces.size(), 1U);
}

TEST(CropFilter, KeepsWhatLiesInTheBoxOfTheScanFrameBordersIncluded) {
  ThreadPool pool(1);
  Progress progress;
  Cloud cloud = cloud_of({{0, 0, 0}, {1, 1, 1}, {1.001F, 0, 0}, {0, -0.5F, 0}}, true);
  cloud.origin_m = {450000, 5412000, 100};
  const scene::CropConfig crop{{450000, 5412000, 100}, {450001, 5412001, 101}};
  const FilterSteps counts = apply_filters(cloud, {crop}, {pool, progress});
  EXPECT_EQ(counts.filtered(), 2U);
  EXPECT_EQ(points_of(cloud), (Points{{0, 0, 0}, {1, 1, 1}}));
}

TEST(CropFilter, OfAMeshKeepsTheTrianglesWhoseCornersStayAndNoCornerWithoutOne) {
  ThreadPool pool(1);
  Progress progress;
  // Two squares of two triangles, joined along x = 1; the corner at x = 3 has a triangle that loses the others.
  Cloud cloud =
      cloud_of({{-5, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 0}, {2, 1, 0}, {3, 0, 0}, {9, 9, 9}});
  cloud.faces = {{1, 3, 2}, {3, 4, 2}, {3, 5, 4}, {5, 6, 4}, {7, 8, 0}};
  apply_filters(cloud, {scene::CropConfig{{-9, -9, -9}, {4, 4, 4}}}, {pool, progress});
  EXPECT_EQ(points_of(cloud), (Points{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 0}, {2, 1, 0}}));
  using Face = std::array<std::uint32_t, 3>;
  EXPECT_EQ(cloud.faces, (std::vector<Face>{{0, 2, 1}, {2, 3, 1}, {2, 4, 3}, {4, 5, 3}}));
  const FilterSteps steps = apply_filters(cloud, {scene::CropConfig{{-1, -1, -1}, {1, 4, 4}}}, {pool, progress});
  EXPECT_EQ(points_of(cloud).size(), 4U);
  EXPECT_EQ(cloud.faces, (std::vector<Face>{{0, 2, 1}, {2, 3, 1}}));
  EXPECT_EQ(steps.steps[0].found, "2 of 4 triangles go with their corners");
  const FilterSteps none = apply_filters(cloud, {scene::CropConfig{{-1, -1, -1}, {4, 4, 4}}}, {pool, progress});
  EXPECT_EQ(cloud.faces.size(), 2U);
  EXPECT_TRUE(none.steps[0].found.empty());
}

/// A fine boss of 20 x 20 squares in the middle of a plate of eight triangles: most corners lie close together, those
/// of the plate do not. A speck of one triangle floats above, with a corner that is stored twice.
struct PlateWithBoss {
  static constexpr std::uint32_t kSide = 21;
  Points points;
  std::vector<std::array<std::uint32_t, 3>> faces;

  PlateWithBoss() {
    for (std::uint32_t y = 0; y < kSide; ++y) {
      for (std::uint32_t x = 0; x < kSide; ++x) points.push_back({static_cast<float>(x), static_cast<float>(y), 0.0F});
    }
    for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
      for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
        const std::uint32_t a = y * kSide + x;
        faces.push_back({a, a + 1, a + kSide + 1});
        faces.push_back({a, a + kSide + 1, a + kSide});
      }
    }
    // The boss' corners again, as files do that store each triangle's own: the plate joins them by place.
    const auto plate = static_cast<std::uint32_t>(points.size());
    const float far = kSide - 1;
    points.insert(points.end(), {{0, 0, 0}, {far, 0, 0}, {far, far, 0}, {0, far, 0}});
    points.insert(points.end(), {{-90, -90, 0}, {110, -90, 0}, {110, 110, 0}, {-90, 110, 0}});
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t next = (k + 1) % 4;
      faces.push_back({plate + k, plate + 4 + k, plate + 4 + next});
      faces.push_back({plate + k, plate + 4 + next, plate + next});
    }
    const auto speck = static_cast<std::uint32_t>(points.size());
    points.insert(points.end(), {{0, 0, 300}, {3, 0, 300}, {0, 3, 300}});
    faces.push_back({speck, speck + 1, speck + 2});
  }
};

TEST(OutlierFilter, OfAMeshTakesSpecksAwayAndNoCornersOfALargeSurface) {
  ThreadPool pool(1);
  Progress progress;
  const PlateWithBoss plate;
  for (const scene::FilterConfig& filter : std::vector<scene::FilterConfig>{
           scene::OutlierConfig{8, 1.0, scene::OutlierConfig::Method::fast}, scene::RadiusOutlierConfig{2.0, 3, {}}}) {
    Cloud cloud = cloud_of(plate.points);
    cloud.faces = plate.faces;
    const FilterSteps steps = apply_filters(cloud, {filter}, {pool, progress});
    EXPECT_EQ(steps.steps[0].removed, 3U) << steps.steps[0].name;
    EXPECT_EQ(cloud.faces.size(), plate.faces.size() - 1);
    EXPECT_THAT(steps.steps[0].found, ::testing::HasSubstr("corners of triangles far from others stay"));
    // The same points without faces are a cloud: the plate's corners go.
    Cloud points = cloud_of(plate.points);
    apply_filters(points, {filter}, {pool, progress});
    EXPECT_EQ(points.size(), plate.points.size() - 7);
  }
  EXPECT_THAT(progress.warnings(), ::testing::IsEmpty());
}

TEST(OutlierFilter, WarnsWhereMuchOfAMeshGoesSinceNothingJoinsIt) {
  ThreadPool pool(1);
  Progress progress;
  // 400 triangles that touch none of the others, of which every fourth is large.
  Cloud cloud;
  Points points;
  for (std::uint32_t k = 0; k < 400; ++k) {
    const float x = 4.0F * static_cast<float>(k);
    const float side = k % 4 == 0 ? 2.0F : 0.5F;
    points.insert(points.end(), {{x, 0, 0}, {x + side, 0, 0}, {x, side, 0}});
  }
  cloud = cloud_of(points);
  for (std::uint32_t k = 0; k < 400; ++k) cloud.faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  apply_filters(cloud, {scene::RadiusOutlierConfig{1.0, 2, {}}}, {pool, progress});
  EXPECT_EQ(cloud.faces.size(), 300U);
  // Of 100 large triangles of area 2 and 300 small ones of 1/8.
  EXPECT_THAT(progress.warnings(), ::testing::ElementsAre(::testing::HasSubstr("takes 84 % of the meshes' area away")));
}

TEST(CropFilter, SaysSoWhenNothingIsLeft) {
  ThreadPool pool(1);
  Progress progress;
  Cloud cloud = cloud_of({{0, 0, 0}});
  try {
    apply_filters(cloud, {scene::CropConfig{{1, 1, 1}, {2, 2, 2}}}, {pool, progress});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), testing::HasSubstr("crop"));
  }
}

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

TEST(Filters, StopWhenCancelled) {
  ThreadPool pool(2);
  Progress progress;
  progress.cancel();
  Cloud cloud = cloud_of(relief(100, 1));
  EXPECT_THROW(apply_filters(cloud, {scene::OutlierConfig{}}, {pool, progress}), Cancelled);
}

TEST(Filters, KeepWhatAFieldOrAClassAllowsAndPointsOfScansThatSayNothing) {
  ThreadPool pool(1);
  Progress progress;
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const auto left = [&](const scene::FilterConfig& filter) {
    Cloud cloud = cloud_of(Points(6, {0.0F, 0.0F, 0.0F}));
    for (std::size_t i = 0; i < cloud.size(); ++i) cloud.xyz1()[4 * i] = static_cast<float>(i);
    cloud.fields = {{"confidence", {0.0F, 0.5F, 1.0F, 1.5F, kNone, 2.0F}},
                    {PointField::kClass, {2.0F, 7.0F, 18.0F, 2.0F, kNone, 6.0F}}};
    apply_filters(cloud, {filter}, {pool, progress});
    std::string names;
    for (std::size_t i = 0; i < cloud.size(); ++i) names += std::to_string(std::lround(cloud.xyz1()[4 * i]));
    for (const PointField& field : cloud.fields) EXPECT_EQ(field.values.size(), cloud.size());
    return names;
  };
  EXPECT_EQ(left(scene::FieldConfig{"confidence", 0.5, 1.5}), "1234");
  EXPECT_EQ(left(scene::ClassesConfig{{}, {7, 18}}), "0345");
  EXPECT_EQ(left(scene::ClassesConfig{{2}, {}}), "034");
  EXPECT_THROW((void)left(scene::FieldConfig{"quality", 0.0, 1.0}), Error);
}

TEST(Filters, KnowIntensityOfScansAndSayWhichFieldsTheyLack) {
  ThreadPool pool(1);
  Progress progress;
  Cloud cloud = cloud_of(Points(4, {0.0F, 0.0F, 0.0F}));
  const auto error_of = [&](const scene::FilterConfig& filter) -> std::string {
    try {
      apply_filters(cloud, {filter}, {pool, progress});
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of(scene::FieldConfig{"intensity", 0.0, 1.0}),
              testing::HasSubstr("no scan has the field 'intensity'"));
  EXPECT_THAT(error_of(scene::FieldConfig{"confidence", 0.0, 1.0}),
              testing::HasSubstr("no scan has the field 'confidence'"));
  EXPECT_THAT(error_of(scene::ClassesConfig{{}, {7}}), testing::HasSubstr("no scan has the field 'classification'"));
  cloud.intensity = {0.5F, 2.0F, kNoIntensity, 1.0F};
  EXPECT_EQ(error_of(scene::FieldConfig{"intensity", 0.0, 1.0}), "no error");
  EXPECT_EQ(cloud.size(), 3U);
}

TEST(Filters, LeaveTheSameBytesWithAnyNumberOfThreads) {
  const Points points = relief(20000, 2);
  FilterNeeds needs;
  needs.spacing_m = [](const Cloud&) { return 0.02; };
  std::vector<scene::FilterConfig> filters{scene::CropConfig{{0, 0, -1}, {0.5, 0.7, 1}}, scene::PassConfig{0, 0.1, 0.9},
                                           scene::VoxelConfig{0.02}, scene::ThinConfig{2}};
  filters.emplace_back(scene::RemovePlaneConfig{0.01, scene::RemovePlaneConfig::Side::both, {0, 0, 1}, 30.0});
  filters.emplace_back(scene::FieldConfig{"confidence", 0.25, 1.0});
  filters.emplace_back(scene::ClassesConfig{{}, {7, 18}});
  for (const int method : {0, 1}) {
    filters.emplace_back(scene::OutlierConfig{8, 2.0, static_cast<scene::OutlierConfig::Method>(method)});
    filters.emplace_back(scene::RadiusOutlierConfig{0.02, 4, static_cast<scene::RadiusOutlierConfig::Method>(method)});
    filters.emplace_back(scene::KeepConfig{{}, 0.03, static_cast<scene::KeepConfig::Method>(method)});
    filters.emplace_back(scene::SmoothConfig{0.02, 2, static_cast<scene::SmoothConfig::Method>(method)});
  }
  std::array<bool, std::variant_size_v<scene::FilterConfig::variant>> tried{};
  for (const scene::FilterConfig& filter : filters) {
    tried.at(filter.index()) = true;
    const auto left = [&](unsigned threads) {
      ThreadPool pool(threads);
      Progress progress;
      Cloud cloud = cloud_of(points, true);
      cloud.fields = {{"confidence", std::vector<float>(cloud.size())},
                      {PointField::kClass, std::vector<float>(cloud.size())}};
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        cloud.fields[0].values[i] = static_cast<float>(i % 100) / 100.0F;
        cloud.fields[1].values[i] = static_cast<float>(i % 20);
      }
      apply_filters(cloud, {filter}, {pool, progress}, needs);
      return cloud;
    };
    const Cloud one = left(1);
    EXPECT_LT(one.size(), points.size() + (std::holds_alternative<scene::SmoothConfig>(filter) ? 1 : 0));
    for (const unsigned threads : {2U, 5U}) {
      const Cloud more = left(threads);
      EXPECT_EQ(points_of(one), points_of(more)) << scene::filter_name(filter) << ", " << threads << " threads";
      EXPECT_EQ(one.rgba, more.rgba) << scene::filter_name(filter) << ", " << threads << " threads";
    }
  }
  for (std::size_t k = 0; k < tried.size(); ++k) EXPECT_TRUE(tried[k]) << "no filter of kind " << k;
}

TEST(Filters, OfPclStopWhenTheyAreCancelledInTheMiddle) {
  // Neighbourhoods of a thousand points and more, 40 000 times.
  const Points points = relief(40000, 1);
  const std::vector<scene::FilterConfig> filters{
      scene::OutlierConfig{1000, 2.0, scene::OutlierConfig::Method::pcl},
      scene::RadiusOutlierConfig{10.0, 1000, scene::RadiusOutlierConfig::Method::pcl},
      scene::KeepConfig{{}, 10.0, scene::KeepConfig::Method::pcl},
      scene::SmoothConfig{10.0, 2, scene::SmoothConfig::Method::pcl}};
  for (const scene::FilterConfig& filter : filters) {
    ThreadPool pool(1);
    Progress progress;
    std::atomic<bool> ended{false};
    std::thread user([&] {
      for (int k = 0; k < 5 && !ended; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
      progress.cancel();
    });
    Cloud cloud = cloud_of(points);
    try {
      apply_filters(cloud, {filter}, {pool, progress});
      ADD_FAILURE() << scene::filter_name(filter) << " ended before it was cancelled";
    } catch (const Cancelled&) {
      EXPECT_EQ(cloud.size(), points.size()) << scene::filter_name(filter);
    }
    ended = true;
    user.join();
  }
}

}  // namespace
}  // namespace sparsha::pipeline
