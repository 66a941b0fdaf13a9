// Moving least squares on surfaces of known form: the noise shrinks, the form stays, and the points as measured are
// kept.
#include "pipeline/filter/smooth.h"

#include <algorithm>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "pipeline/filter/filter.h"
#include "tests/pipeline/filter/labelled.h"

namespace sparsha::pipeline {
namespace {

using testing::HasSubstr;

constexpr double kNoise = 0.0005;

/// A sphere of 0.1 m about the origin, 1.1 mm between points.
LabelledCloud noisy_sphere(unsigned seed, std::size_t count = 100000) {
  std::mt19937 random(seed);
  LabelledCloud scene;
  add_sphere(scene, {0, 0}, 0.1, -0.1, count, kNoise, Part::object, random);
  return scene;
}

double rms_from_sphere(const Cloud& cloud, const Eigen::Vector3d& centre) {
  double sum = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3f> p(cloud.xyz1() + 4 * i);
    const double away = (cloud.origin_m - centre + p.cast<double>()).norm() - 0.1;
    sum += away * away;
  }
  return std::sqrt(sum / static_cast<double>(cloud.size()));
}

TEST(Smooth, BringsANoisySphereNearerToItsTrueForm) {
  const Eigen::Vector3d utm(5e5, 4e6, 100);
  LabelledCloud scene = noisy_sphere(1);
  scene.transform(Eigen::Affine3d(Eigen::Translation3d(utm)));
  Cloud cloud = scene.cloud(utm);
  ASSERT_NEAR(rms_from_sphere(cloud, utm), kNoise, 0.02 * kNoise);
  const Cloud before = scene.cloud(utm);
  Work work;
  const FilterSteps steps = apply_filters(cloud, {scene::SmoothConfig{0.006, 2, {}}}, work.context());
  // 90 neighbours, weights exp(-d^2/r^2), a quadric: the variance at its centre is about 6 of 90 parts, a little more
  // for the weights.
  EXPECT_LT(rms_from_sphere(cloud, utm), 0.35 * kNoise);
  ASSERT_EQ(cloud.measured.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_EQ(cloud.measured[i], Eigen::Vector3f(Eigen::Map<const Eigen::Vector3f>(before.xyz1() + 4 * i)));
  }
  EXPECT_EQ(cloud.rgba, before.rgba);
  EXPECT_NEAR(steps.moved_rms_m, kNoise, 0.1 * kNoise);
  EXPECT_TRUE(work.progress.warnings().empty());
}

TEST(Smooth, GivesWhatPclGives) {
  for (const int order : {1, 2, 3}) {
    for (const double radius : {0.0015, 0.004, 0.012}) {
      const LabelledCloud scene = noisy_sphere(2, 20000);
      Cloud own = scene.cloud();
      Cloud theirs = scene.cloud();
      Work work;
      const Smoothing a = smooth_points(own, {radius, order, scene::SmoothConfig::Method::fast}, work.context());
      const Smoothing b = smooth_points(theirs, {radius, order, scene::SmoothConfig::Method::pcl}, work.context());
      EXPECT_EQ(a.unmoved, b.unmoved);
      double most = 0.0;
      for (std::size_t i = 0; i < own.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          most = std::max(most, std::abs(static_cast<double>(own.xyz1()[4 * i + k] - theirs.xyz1()[4 * i + k])));
        }
      }
      // Sums of the same neighbours in another order: PCL's fit loses digits where few points carry many coefficients.
      EXPECT_LT(most, radius < 0.002 ? 1e-6 : 2e-8) << "order " << order << ", radius " << radius;
    }
  }
}

TEST(Smooth, DependsNeitherOnThreadsNorOnTheOrderOfPoints) {
  const LabelledCloud scene = noisy_sphere(3, 20000);
  const auto smoothed = [](const LabelledCloud& given, unsigned threads) {
    Cloud cloud = given.cloud();
    Work work(threads);
    apply_filters(cloud, {scene::SmoothConfig{0.005, 2, {}}}, work.context());
    std::vector<std::array<float, 3>> points;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const float* p = cloud.xyz1() + 4 * i;
      points.push_back({p[0], p[1], p[2]});
    }
    std::sort(points.begin(), points.end());
    return points;
  };
  const auto expected = smoothed(scene, 1);
  EXPECT_EQ(expected, smoothed(scene, 4));
  LabelledCloud shuffled = scene;
  std::shuffle(shuffled.points_m.begin(), shuffled.points_m.end(), std::mt19937(4));
  EXPECT_EQ(expected, smoothed(shuffled, 2));
}

TEST(Smooth, LeavesLonelyPointsWhereTheyAreAndSaysHowMany) {
  LabelledCloud scene = noisy_sphere(5, 20000);
  for (int i = 0; i < 400; ++i) scene.add({1 + 0.1 * i, 0, 0}, Part::dirt);
  Cloud cloud = scene.cloud();
  Work work;
  const FilterSteps steps = apply_filters(cloud, {scene::SmoothConfig{0.006, 2, {}}}, work.context());
  EXPECT_EQ(cloud.size(), scene.points_m.size());
  EXPECT_THAT(steps.steps.at(0).found, HasSubstr("400 not moved"));
  EXPECT_THAT(work.progress.warnings(), testing::Contains(HasSubstr("larger radius_mm")));
  const float* last = cloud.xyz1() + 4 * (cloud.size() - 1);
  EXPECT_EQ(last[0], static_cast<float>(1 + 0.1 * 399));
}

TEST(Smooth, RefusesARadiusBelowTheSpacingAndPointsInOnePlace) {
  const auto error_of = [](Cloud cloud, double radius) {
    Work work;
    try {
      apply_filters(cloud, {scene::SmoothConfig{radius, 2, {}}}, work.context());
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  LabelledCloud lattice;
  for (int i = 0; i < 400; ++i) lattice.add({0.01 * (i % 20), 0.01 * (i / 20), 0}, Part::object);
  EXPECT_THAT(error_of(lattice.cloud(), 0.001), testing::AllOf(HasSubstr("moves nothing"), HasSubstr("10 mm")));
  LabelledCloud three;
  for (int i = 0; i < 2; ++i) three.add({0.001 * i, 0, 0}, Part::object);
  EXPECT_THAT(error_of(three.cloud(), 0.1), HasSubstr("moves nothing"));
}

TEST(Smooth, RefusesARadiusWithThousandsOfPointsInItAndCanBeCancelled) {
  Cloud cloud = noisy_sphere(8).cloud();
  Work work;
  EXPECT_THROW(apply_filters(cloud, {scene::SmoothConfig{0.1, 2, {}}}, work.context()), Error);
  Work cancelled;
  const auto stop = [&](double) { cancelled.progress.cancel(); };
  EXPECT_THROW(smooth_points(cloud, {0.003, 2, {}}, cancelled.context(), stop), Cancelled);
  EXPECT_TRUE(cloud.measured.empty());
}

TEST(Smooth, FiltersAfterItKeepPointsAndTheirMeasuredPlacesTogether) {
  LabelledCloud scene = noisy_sphere(6, 20000);
  Cloud cloud = scene.cloud();
  const Cloud before = scene.cloud();
  Work work;
  apply_filters(cloud, {scene::SmoothConfig{0.006, 2, {}}, scene::PassConfig{2, 0.0, 1.0}}, work.context());
  ASSERT_LT(cloud.size(), 11000U);
  ASSERT_EQ(cloud.measured.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t index = cloud.rgba[i];
    ASSERT_EQ(cloud.measured[i], Eigen::Vector3f(Eigen::Map<const Eigen::Vector3f>(before.xyz1() + 4 * index)));
  }
}

TEST(Smooth, MovesTheVerticesOfAMeshAndKeepsItsFaces) {
  LabelledCloud scene = noisy_sphere(7, 5000);
  Cloud cloud = scene.cloud();
  cloud.faces = {{0, 1, 2}};
  Work work;
  apply_filters(cloud, {scene::SmoothConfig{0.02, 1, {}}}, work.context());
  EXPECT_EQ(cloud.faces.size(), 1U);
}

}  // namespace
}  // namespace sparsha::pipeline
