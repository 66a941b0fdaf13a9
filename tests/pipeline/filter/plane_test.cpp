// Planes of known place and direction are found and taken away; where there is none, that is said.
#include "pipeline/filter/plane.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "pipeline/filter/filter.h"
#include "tests/pipeline/filter/labelled.h"

namespace sparsha::pipeline {
namespace {

using testing::HasSubstr;

constexpr double kNoise = 0.001;
constexpr double kDegree = std::numbers::pi / 180.0;

/// A sphere of 0.2 m on a floor of 2 m x 2 m.
LabelledCloud sphere_on_floor(unsigned seed, std::size_t floor = 20000, std::size_t object = 10000) {
  std::mt19937 random(seed);
  LabelledCloud scene;
  add_square(scene, 1.0, 0.0, floor, kNoise, Part::floor, random);
  add_sphere(scene, {0.1, -0.2}, 0.2, 0.0, object, kNoise, Part::object, random);
  return scene;
}

std::string error_of(Cloud cloud, const scene::RemovePlaneConfig& config) {
  Work work;
  try {
    apply_filters(cloud, {config}, work.context());
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_FALSE(error.expected().empty());
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return {};
}

TEST(RemovePlane, TakesTheFloorAndLeavesTheObjectInAnyPose) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    LabelledCloud scene = sphere_on_floor(seed);
    // Up to 12 degrees off, somewhere in a national grid.
    const Eigen::Vector3d tilt_about(std::cos(seed), std::sin(seed), 0.0);
    const Eigen::Vector3d place(5e5 + seed, 4e6, 312.7);
    const Eigen::AngleAxisd tilt(1.5 * seed * kDegree, tilt_about);
    scene.transform(Eigen::Affine3d(Eigen::Translation3d(place) * tilt));
    Cloud cloud = scene.cloud({5e5, 4e6, 312.0});
    Work work;
    scene::RemovePlaneConfig config;
    config.distance_m = 5 * kNoise;
    const FilterSteps steps = apply_filters(cloud, {config}, work.context());
    const Left left = left_of(scene, cloud);
    // The noise leaves 6e-7 of the floor beyond 5 sigma, the plane's own error less than 1.
    EXPECT_LE(left[Part::floor], 2U) << "seed " << seed;
    // Of the sphere, the cap below 5 mm goes: 2.5 % of its height and so of its area; twice that for chance and noise.
    EXPECT_GE(left[Part::object], 9500U) << "seed " << seed;
    EXPECT_THAT(steps.steps.at(0).found, HasSubstr("degrees from the one given"));
    EXPECT_EQ(steps.filtered() + cloud.size(), scene.points_m.size());
  }
}

TEST(RemovePlane, FindsThePlaneToAFractionOfTheNoise) {
  LabelledCloud scene = sphere_on_floor(3);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.1, -0.05, 1.0).normalized();
  scene.transform(Eigen::Affine3d(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal)));
  scene::RemovePlaneConfig config;
  config.distance_m = 4 * kNoise;
  PlaneSample sample(config.distance_m);
  for (const Eigen::Vector3d& p : scene.points_m) sample.add(p.cast<float>());
  Work work;
  const FoundPlane plane = find_plane(sample, config, work.context());
  // About 14 000 points over 2 m: direction to noise / (extent * sqrt(points)), five times that allowed.
  EXPECT_LT((plane.cut.normal - normal).norm(), 5 * kNoise / (0.58 * 118));
  EXPECT_NEAR(plane.cut.offset_m, 0.0, 5 * kNoise / 118 + kNoise / 10);
  EXPECT_NEAR(plane.rms_m, kNoise, 0.1 * kNoise);
}

TEST(RemovePlane, EachSideTakesItsOwnHalfSpace) {
  std::mt19937 random(5);
  LabelledCloud scene;
  add_square(scene, 1.0, 0.0, 20000, kNoise, Part::floor, random);
  add_sphere(scene, {0.2, 0.2}, 0.1, 0.1, 3000, 0.0, Part::object, random);  // above
  add_sphere(scene, {0.2, 0.2}, 0.1, -0.4, 2000, 0.0, Part::dirt, random);   // below
  const auto left = [&](scene::RemovePlaneConfig::Side side, const Eigen::Vector3d& normal) {
    Cloud cloud = scene.cloud();
    Work work;
    scene::RemovePlaneConfig config;
    config.side = side;
    config.normal = normal;
    apply_filters(cloud, {config}, work.context());
    return left_of(scene, cloud).of;
  };
  using Side = scene::RemovePlaneConfig::Side;
  EXPECT_EQ(left(Side::below, {0, 0, 1}), (std::array<std::size_t, 4>{0, 0, 3000, 0}));
  EXPECT_EQ(left(Side::above, {0, 0, 1}), (std::array<std::size_t, 4>{0, 0, 0, 2000}));
  EXPECT_EQ(left(Side::both, {0, 0, 1}), (std::array<std::size_t, 4>{0, 0, 3000, 2000}));
  EXPECT_EQ(left(Side::below, {0, 0, -7}), (std::array<std::size_t, 4>{0, 0, 0, 2000})) << "the normal says what is up";
}

TEST(RemovePlane, ATableGoesWithTheFloorBelowItWhenItIsTheLarger) {
  std::mt19937 random(6);
  LabelledCloud scene;
  add_square(scene, 0.5, 0.0, 3000, kNoise, Part::floor, random);
  add_square(scene, 0.6, 0.7, 9000, kNoise, Part::table, random);
  add_sphere(scene, {0, 0}, 0.1, 0.7, 4000, kNoise, Part::object, random);
  Cloud cloud = scene.cloud();
  Work work;
  apply_filters(cloud, {scene::RemovePlaneConfig{}}, work.context());
  const Left left = left_of(scene, cloud);
  EXPECT_EQ(left[Part::floor], 0U);
  EXPECT_LE(left[Part::table], 2U);
  EXPECT_GE(left[Part::object], 3700U);
}

TEST(RemovePlane, CountsAreaSoThatADenseObjectDoesNotOutweighASparseFloor) {
  // 400 points of floor, half a million of a statue's horizontal steps.
  std::mt19937 random(7);
  LabelledCloud scene;
  add_square(scene, 2.0, 0.0, 4000, kNoise, Part::floor, random);
  add_square(scene, 0.1, 0.5, 300000, kNoise, Part::object, random);
  Cloud cloud = scene.cloud();
  Work work;
  apply_filters(cloud, {scene::RemovePlaneConfig{}}, work.context());
  const Left left = left_of(scene, cloud);
  EXPECT_EQ(left[Part::floor], 0U);
  EXPECT_EQ(left[Part::object], 300000U);
}

TEST(RemovePlane, AWallGoesByItsNormalAndNotTheLargerFloor) {
  std::mt19937 random(8);
  LabelledCloud scene;
  add_square(scene, 0.5, 0.0, 6000, kNoise, Part::table, random);  // becomes the wall
  scene.transform(Eigen::Affine3d(Eigen::Translation3d(0, 1, 0.5) *
                                  Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX())));
  add_square(scene, 1.0, 0.0, 20000, kNoise, Part::floor, random);
  Cloud cloud = scene.cloud();
  Work work;
  scene::RemovePlaneConfig config;
  config.normal = {0, -1, 0};
  apply_filters(cloud, {config}, work.context());
  const Left left = left_of(scene, cloud);
  EXPECT_LE(left[Part::table], 1U);
  EXPECT_GE(left[Part::floor], 19800U);
}

TEST(RemovePlane, TheSameCloudInAnotherOrderOrWithOtherThreadsLosesTheSamePoints) {
  const LabelledCloud scene = sphere_on_floor(4);
  const auto kept = [&](const LabelledCloud& given, unsigned threads, const Eigen::Vector3d& origin_m) {
    Cloud cloud = given.cloud(origin_m);
    Work work(threads);
    apply_filters(cloud, {scene::RemovePlaneConfig{}}, work.context());
    std::vector<std::array<float, 3>> points;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const float* p = cloud.xyz1() + 4 * i;
      points.push_back({p[0], p[1], p[2]});
    }
    std::sort(points.begin(), points.end());
    return points;
  };
  const auto expected = kept(scene, 1, Eigen::Vector3d::Zero());
  EXPECT_EQ(expected, kept(scene, 4, Eigen::Vector3d::Zero()));
  LabelledCloud shuffled = scene;
  std::shuffle(shuffled.points_m.begin(), shuffled.points_m.end(), std::mt19937(9));
  EXPECT_EQ(expected, kept(shuffled, 3, Eigen::Vector3d::Zero()));
  // A cloud of the same float32 points about another origin, which the plane must not see.
  LabelledCloud far = scene;
  for (Eigen::Vector3d& p : far.points_m) p = p.cast<float>().cast<double>() + Eigen::Vector3d(5e5, 4e6, 100);
  Cloud moved = far.cloud({5e5, 4e6, 100});
  Work work;
  apply_filters(moved, {scene::RemovePlaneConfig{}}, work.context());
  EXPECT_EQ(moved.size(), expected.size());
}

TEST(RemovePlane, ASphereACylinderAndABallOfPointsHaveNoPlane) {
  std::mt19937 random(10);
  LabelledCloud sphere;
  add_sphere(sphere, {0, 0}, 0.5, 0.0, 20000, kNoise, Part::object, random);
  EXPECT_THAT(error_of(sphere.cloud(), {}), HasSubstr("curved or rough"));

  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  LabelledCloud cylinder;
  LabelledCloud ball;
  for (int i = 0; i < 20000; ++i) {
    const double angle = std::numbers::pi * uniform(random);
    cylinder.add({uniform(random), 0.3 * std::cos(angle), 0.3 * std::sin(angle)}, Part::object);
    ball.add({uniform(random), uniform(random), uniform(random)}, Part::object);
  }
  EXPECT_THAT(error_of(cylinder.cloud(), {}), HasSubstr("curved or rough"));
  EXPECT_THAT(error_of(ball.cloud(), {}), HasSubstr("no plane"));
}

TEST(RemovePlane, SaysWhatItFoundWhenTheAngleOrTheNoiseDoesNotFit) {
  LabelledCloud steep = sphere_on_floor(11);
  steep.transform(Eigen::Affine3d(Eigen::AngleAxisd(40 * kDegree, Eigen::Vector3d::UnitX())));
  const std::string message = error_of(steep.cloud(), {});
  EXPECT_THAT(message, HasSubstr("within 15 degrees"));

  std::mt19937 random(12);
  LabelledCloud rough;
  add_square(rough, 1.0, 0.0, 20000, 0.01, Part::floor, random);
  EXPECT_THAT(error_of(rough.cloud(), {}), HasSubstr("larger distance_mm"));
}

TEST(RemovePlane, RefusesTwoPointsOnePlaceAndALine) {
  LabelledCloud few;
  few.add({0, 0, 0}, Part::object);
  few.add({1, 0, 0}, Part::object);
  EXPECT_THAT(error_of(few.cloud(), {}), HasSubstr("2 cubes"));
  LabelledCloud same;
  for (int i = 0; i < 100; ++i) same.add({1, 2, 3}, Part::object);
  EXPECT_THAT(error_of(same.cloud(), {}), HasSubstr("1 cube of"));
  LabelledCloud line;
  for (int i = 0; i < 100; ++i) line.add({0.1 * i, 0, 0}, Part::object);
  EXPECT_THAT(error_of(line.cloud(), {}), HasSubstr("no plane"));
}

TEST(RemovePlane, SaysThatTheDistanceIsTooLargeForTheScan) {
  scene::RemovePlaneConfig config;
  config.distance_m = 0.5;
  EXPECT_THAT(error_of(sphere_on_floor(14).cloud(), config), HasSubstr("smaller distance_mm"));
}

// A relief of +-10 mm whose ground is taken for a floor: what lies below it goes too.
TEST(RemovePlane, SaysHowMuchGoes) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  const auto relief = [&](double least, double most, std::size_t count) {
    Cloud cloud;
    cloud.resize_points(count);
    std::uniform_real_distribution<double> height(least, most);
    for (std::size_t n = 0; n < count; ++n) {
      // A third of it is ground.
      const double z = n % 3 == 0 ? 0.0 : height(random);
      const Eigen::Vector3f p(static_cast<float>(place(random)), static_cast<float>(place(random)),
                              static_cast<float>(z));
      std::copy_n(p.data(), 3, cloud.xyz1() + 4 * n);
    }
    return cloud;
  };
  scene::RemovePlaneConfig config;
  config.distance_m = 0.001;
  Cloud carved = relief(-0.01, 0.003, 30000);
  Work work;
  apply_filters(carved, {config}, work.context());
  EXPECT_THAT(work.progress.warnings(), testing::Contains(HasSubstr("of the points away (")));
  // A coin on a floor may be one point in a hundred: said, and taken away all the same.
  Cloud floor = relief(-0.01, 0.0012, 30000);
  Work again;
  apply_filters(floor, {config}, again.context());
  EXPECT_GT(floor.size(), 0U);
  EXPECT_THAT(again.progress.warnings(), testing::Contains(HasSubstr("'remove_plane' takes 9")));
}

TEST(RemovePlane, WarnsWhenTheObjectItselfMayBeThePlane) {
  std::mt19937 random(13);
  LabelledCloud relief;
  add_square(relief, 0.5, 0.0, 20000, kNoise, Part::object, random);
  add_sphere(relief, {0, 0}, 0.1, -0.1, 5000, kNoise, Part::object, random);
  Cloud cloud = relief.cloud();
  Work work;
  apply_filters(cloud, {scene::RemovePlaneConfig{}}, work.context());
  EXPECT_THAT(work.progress.warnings(), testing::Contains(HasSubstr("if that is the object itself")));
}

}  // namespace
}  // namespace sparsha::pipeline
