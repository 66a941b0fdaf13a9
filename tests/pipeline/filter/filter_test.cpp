// Filters against brute force and PCL: the same decisions, whatever the order of points or the number of threads.
#include "pipeline/filter/filter.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "pipeline/filter/neighbour_tree.h"
#include "pipeline/filter/outliers.h"
#include "tests/pipeline/filter/filtered_clouds.h"

namespace sparsha::pipeline {
namespace {

using testing::cloud_of;
using testing::Points;
using testing::points_of;
using testing::relief;

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
  EXPECT_THAT(keep, ::testing::Each(1));
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
    EXPECT_THAT(error.what(), ::testing::HasSubstr("crop"));
  }
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
              ::testing::HasSubstr("no scan has the field 'intensity'"));
  EXPECT_THAT(error_of(scene::FieldConfig{"confidence", 0.0, 1.0}),
              ::testing::HasSubstr("no scan has the field 'confidence'"));
  EXPECT_THAT(error_of(scene::ClassesConfig{{}, {7}}), ::testing::HasSubstr("no scan has the field 'classification'"));
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
