// Clusters and neighbours within a radius against brute force and PCL.
#include "pipeline/filter/clusters.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "pipeline/filter/filter.h"
#include "pipeline/filter/outliers.h"
#include "pipeline/filter/thin.h"
#include "tests/pipeline/filter/labelled.h"

namespace sparsha::pipeline {
namespace {

using testing::HasSubstr;

/// Groups, strings, a lattice with equal distances, duplicates and density from one to a million in a volume.
LabelledCloud uneven(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  LabelledCloud cloud;
  while (cloud.points_m.size() < count) {
    const double kind = uniform(random);
    const double x = uniform(random);
    const double y = uniform(random);
    const double z = uniform(random);
    if (kind < 0.3) cloud.add({x, y, z}, Part::dirt);
    if (kind >= 0.3 && kind < 0.6) cloud.add({0.01 * x * x, 0.01 * y, 0.01 * z * z * z}, Part::object);
    if (kind >= 0.6 && kind < 0.9) {
      cloud.add({std::floor(20 * x) / 16, std::floor(20 * y) / 16, std::floor(20 * z) / 16 - 3}, Part::table);
    }
    if (kind >= 0.9 && !cloud.points_m.empty()) cloud.add(cloud.points_m.back(), Part::dirt);
  }
  return cloud;
}

float squared(const Cloud& cloud, std::size_t a, std::size_t b) {
  const float* p = cloud.xyz1() + 4 * a;
  const float* q = cloud.xyz1() + 4 * b;
  float sum = 0.0F;
  for (std::size_t k = 0; k < 3; ++k) sum += (p[k] - q[k]) * (p[k] - q[k]);
  return sum;
}

/// By looking at every pair.
std::vector<std::uint32_t> clusters_by_brute_force(const Cloud& cloud, double tolerance) {
  const auto limit = static_cast<float>(tolerance * tolerance);
  std::vector<std::uint32_t> label(cloud.size(), ~0U);
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (label[i] != ~0U) continue;
    std::vector<std::size_t> open{i};
    label[i] = next;
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      for (std::size_t j = 0; j < cloud.size(); ++j) {
        if (label[j] != ~0U || !(squared(cloud, at, j) < limit)) continue;
        label[j] = next;
        open.push_back(j);
      }
    }
    ++next;
  }
  return label;
}

TEST(Clusters, AreThoseOfBruteForceAndOfPcl) {
  Work work;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Cloud cloud = uneven(2500, seed).cloud();
    for (const double tolerance : {0.0005, 0.004, 0.0625, 0.07, 0.3, 10.0}) {
      const auto expected = clusters_by_brute_force(cloud, tolerance);
      EXPECT_EQ(euclidean_clusters(cloud, tolerance, work.context()), expected) << seed << ", " << tolerance;
      EXPECT_EQ(euclidean_clusters_by_pcl(cloud, tolerance, work.progress), expected) << seed << ", " << tolerance;
    }
  }
}

TEST(Clusters, TwoDenseGroupsJustOutOfReachTakeNoLongerThanTheirPoints) {
  // Two faces of 200 000 points each, 1.001 tolerances apart: pair by pair 4e10 distances.
  LabelledCloud cloud;
  std::mt19937 random(3);
  add_square(cloud, 0.0005, 0.0, 200000, 0.0, Part::object, random);
  add_square(cloud, 0.0005, 0.001001, 200000, 0.0, Part::table, random);
  Work work;
  const auto labels = euclidean_clusters(cloud.cloud(), 0.001, work.context());
  EXPECT_EQ(*std::max_element(labels.begin(), labels.end()), 1U);
}

TEST(Clusters, APointAtTheEndOfFloat32DoesNoHarm) {
  LabelledCloud cloud;
  for (int i = 0; i < 100; ++i) cloud.add({0.001 * i, 0, 0}, Part::object);
  cloud.add({1e30, -1e30, 3e37}, Part::dirt);
  Work work;
  const auto labels = euclidean_clusters(cloud.cloud(), 0.002, work.context());
  EXPECT_EQ(*std::max_element(labels.begin(), labels.end()), 1U);
}

TEST(Keep, LeavesTheLargestClusterWithItsColours) {
  std::mt19937 random(4);
  LabelledCloud scene;
  add_sphere(scene, {1, 0}, 0.1, 0.0, 2000, 0.0, Part::dirt, random);
  add_sphere(scene, {0, 0}, 0.1, 0.0, 4000, 0.0, Part::object, random);
  Cloud cloud = scene.cloud();
  Work work;
  const FilterSteps steps = apply_filters(cloud, {scene::KeepConfig{{}, 0.05, {}}}, work.context());
  EXPECT_EQ(cloud.size(), 4000U);
  EXPECT_EQ(left_of(scene, cloud)[Part::object], 4000U);
  EXPECT_EQ(steps.filtered(), 2000U);
  EXPECT_THAT(steps.steps.at(0).found, HasSubstr("2 clusters"));
}

TEST(Keep, LeavesTheClusterNearestToAPlaceOfAGeoreferencedScan) {
  std::mt19937 random(5);
  LabelledCloud scene;
  add_sphere(scene, {1, 0}, 0.1, 0.0, 2000, 0.0, Part::dirt, random);
  add_sphere(scene, {0, 0}, 0.1, 0.0, 4000, 0.0, Part::object, random);
  const Eigen::Vector3d utm(450000, 5412000, 100);
  scene.transform(Eigen::Affine3d(Eigen::Translation3d(utm)));
  Cloud cloud = scene.cloud(utm);
  Work work;
  scene::KeepConfig config{utm + Eigen::Vector3d(0.8, 0, 0.1), 0.05, {}};
  const FilterSteps steps = apply_filters(cloud, {config}, work.context());
  EXPECT_EQ(left_of(scene, cloud)[Part::dirt], 2000U);
  EXPECT_EQ(cloud.size(), 2000U);
  // The sphere's surface is 0.1 m nearer than its centre; 2000 points leave gaps of some mm.
  EXPECT_THAT(work.progress.warnings(), testing::Contains(HasSubstr("from nearest_to")));
  EXPECT_THAT(steps.steps.at(0).found, HasSubstr("10 cm from nearest_to"));
}

TEST(Keep, OfEqualClustersTakesTheSameInAnyOrder) {
  LabelledCloud scene;
  for (int i = 0; i < 10; ++i) {
    scene.add({5 + 0.001 * i, 0, 0}, Part::dirt);
    scene.add({-5 + 0.001 * i, 0, 0}, Part::object);
  }
  Work work;
  Cloud cloud = scene.cloud();
  apply_filters(cloud, {scene::KeepConfig{}}, work.context());
  EXPECT_EQ(left_of(scene, cloud)[Part::object], 10U);
  std::reverse(scene.points_m.begin(), scene.points_m.end());
  std::reverse(scene.parts.begin(), scene.parts.end());
  Cloud reversed = scene.cloud();
  apply_filters(reversed, {scene::KeepConfig{}}, work.context());
  EXPECT_EQ(left_of(scene, reversed)[Part::object], 10U);
}

TEST(Keep, RefusesAToleranceBelowTheSpacingAndAPlaceFarAway) {
  std::mt19937 random(6);
  LabelledCloud scene;
  add_square(scene, 0.5, 0.0, 10000, 0.0, Part::object, random);
  const auto error_of = [&](const scene::KeepConfig& config) {
    Cloud cloud = scene.cloud();
    Work work;
    try {
      apply_filters(cloud, {config}, work.context());
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error_of({{}, 1e-5, {}}),
              testing::AllOf(HasSubstr("nearest one within"), HasSubstr("larger tolerance_mm")));
  EXPECT_THAT(error_of({Eigen::Vector3d(0, 0, 450), 0.05, {}}), HasSubstr("450 m from nearest_to"));
}

TEST(RadiusOutliers, AreThoseOfBruteForceAndOfPcl) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Cloud cloud = uneven(2500, seed).cloud();
    for (const double radius : {0.0005, 0.004, 0.0625, 0.3}) {
      for (const int neighbours : {1, 4, 30}) {
        const scene::RadiusOutlierConfig config{radius, neighbours, {}};
        std::vector<std::uint8_t> expected(cloud.size());
        for (std::size_t i = 0; i < cloud.size(); ++i) {
          int found = 0;
          for (std::size_t j = 0; j < cloud.size(); ++j) {
            if (j != i && static_cast<double>(squared(cloud, i, j)) <= radius * radius) ++found;
          }
          expected[i] = found >= neighbours ? 1 : 0;
        }
        Work one(1);
        Work four(4);
        EXPECT_EQ(radius_inliers(cloud, config, one.context()), expected) << radius << ", " << neighbours;
        EXPECT_EQ(radius_inliers(cloud, config, four.context()), expected) << radius << ", " << neighbours;
        EXPECT_EQ(radius_inliers_by_pcl(cloud, config, one.progress), expected) << radius << ", " << neighbours;
      }
    }
  }
}

TEST(RadiusOutliers, CountAsOutliersThatTheCrossCheckSeesAndWarnBelowTheSpacing) {
  LabelledCloud scene;
  for (int i = 0; i < 400; ++i) scene.add({0.01 * (i % 20), 0.01 * (i / 20), 0}, Part::object);
  scene.add({0.1, 0.1, 1}, Part::dirt);
  Cloud cloud = scene.cloud();
  Work work;
  Cloud removed;
  FilterNeeds needs;
  needs.removed_outliers = &removed;
  const FilterSteps steps = apply_filters(cloud, {scene::RadiusOutlierConfig{0.02, 3, {}}}, work.context(), needs);
  EXPECT_EQ(steps.outliers(), 1U);
  EXPECT_EQ(steps.filtered(), 0U);
  ASSERT_EQ(removed.size(), 1U);
  EXPECT_EQ(removed.xyz1()[2], 1.0F);
  EXPECT_TRUE(work.progress.warnings().empty());

  Cloud sparse = scene.cloud();
  EXPECT_THROW(apply_filters(sparse, {scene::RadiusOutlierConfig{0.005, 1, {}}}, work.context()), Error);
  Cloud pairs = scene.cloud();
  apply_filters(pairs, {scene::RadiusOutlierConfig{0.0101, 4, {}}}, work.context());
  EXPECT_TRUE(work.progress.warnings().empty()) << "most have four";
  apply_filters(pairs, {scene::RadiusOutlierConfig{0.0101, 4, {}}, scene::RadiusOutlierConfig{0.0101, 4, {}}},
                work.context());
}

TEST(Pass, KeepsAnAxisRangeOfTheScanFrameBordersIncluded) {
  LabelledCloud scene;
  for (int i = 0; i <= 10; ++i) scene.add({450000, 5412000.0 + i, 7}, Part::object);
  Cloud cloud = scene.cloud({450000, 5412000, 0});
  Work work;
  const FilterSteps steps = apply_filters(cloud, {scene::PassConfig{1, 5412002, 5412004}}, work.context());
  EXPECT_EQ(cloud.size(), 3U);
  EXPECT_EQ(steps.filtered(), 8U);
  apply_filters(cloud, {scene::PassConfig{1, 5412003, std::numeric_limits<double>::infinity()}}, work.context());
  EXPECT_EQ(cloud.size(), 2U);
}

TEST(Thin, LeavesAtMostSoManyPointsInEveryCubeAndNeverAnEmptyOne) {
  const LabelledCloud scene = uneven(5000, 8);
  Work work(3);
  const Cloud cloud = scene.cloud();
  for (const int most : {1, 3, 50}) {
    const double side = 0.05;
    const std::vector<std::uint8_t> keep = thinned(cloud, side, most, work.context());
    std::map<std::array<int, 3>, std::array<int, 2>> cubes;  // all, kept
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      std::array<int, 3> cube{};
      for (std::size_t k = 0; k < 3; ++k) {
        // Cubes are wider than the side by a millionth.
        cube[k] = static_cast<int>(std::floor(static_cast<double>(cloud.xyz1()[4 * i + k]) / side * (1 + 1e-6)));
      }
      auto& count = cubes[cube];
      ++count[0];
      count[1] += keep[i];
    }
    for (const auto& [cube, count] : cubes) EXPECT_EQ(count[1], std::min(count[0], most));
    Work one(1);
    EXPECT_EQ(keep, thinned(cloud, side, most, one.context()));
  }
}

TEST(Thin, KeepsTheMeanHeightOfANoisySurface) {
  std::mt19937 random(9);
  LabelledCloud scene;
  const double noise = 0.01;
  add_square(scene, 0.5, 0.0123, 200000, noise, Part::object, random);
  Cloud cloud = scene.cloud();
  Work work;
  FilterNeeds needs;
  needs.spacing_m = [](const Cloud&) { return 0.01; };
  apply_filters(cloud, {scene::ThinConfig{4}}, work.context(), needs);
  double sum = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) sum += static_cast<double>(cloud.xyz1()[4 * i + 2]);
  // Cubes border on the surface at z = 0 and 0.01, where noise alone fills them: the tails count more, on both sides.
  EXPECT_NEAR(sum / static_cast<double>(cloud.size()), 0.0123, 0.1 * noise);
  EXPECT_LT(cloud.size(), 6U * 4U * 10000U);
}

TEST(KeepFilter, CornersOfATriangleAreOneClusterHoweverFarApart) {
  ThreadPool pool(1);
  Progress progress;
  Cloud cloud;
  cloud.resize_points(7);
  // Two wide triangles that share an edge, and a small one above them.
  const std::array<Eigen::Vector3f, 7> corners = {
      Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(9, 0, 0),    Eigen::Vector3f(0, 9, 0),   Eigen::Vector3f(9, 9, 0),
      Eigen::Vector3f(4, 4, 1), Eigen::Vector3f(4.2F, 4, 1), Eigen::Vector3f(4, 4.2F, 1)};
  for (std::size_t k = 0; k < corners.size(); ++k) std::copy_n(corners[k].data(), 3, cloud.xyz1() + 4 * k);
  cloud.faces = {{0, 1, 2}, {1, 3, 2}, {4, 5, 6}};
  const FilterSteps steps = apply_filters(cloud, {scene::KeepConfig{{}, 0.5}}, {pool, progress});
  EXPECT_EQ(cloud.size(), 4U);
  EXPECT_EQ(cloud.faces.size(), 2U);
  EXPECT_THAT(steps.steps[0].found, HasSubstr("2 clusters"));
}

}  // namespace
}  // namespace sparsha::pipeline
