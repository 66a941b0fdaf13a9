// Pillars in clouds that are known.
#include "pipeline/filter/pillars.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"

namespace sparsha::pipeline {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// The half of a pillar that a scanner at -y sees.
void add_pillar(Points& points, const Pillar& pillar, int count, double noise_m, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, noise_m);
  const Eigen::Vector3d axis = (pillar.to_m - pillar.from_m).normalized();
  const Eigen::Vector3d side = axis.cross(Eigen::Vector3d::UnitY()).normalized();
  const Eigen::Vector3d front = axis.cross(side);
  const Eigen::Vector3d towards = front.y() < 0.0 ? front : Eigen::Vector3d(-front);
  for (int i = 0; i < count; ++i) {
    const double angle = std::numbers::pi * unit(random);
    const double radius = pillar.radius_m + noise(random);
    points.push_back(pillar.from_m + unit(random) * (pillar.to_m - pillar.from_m) +
                     radius * (std::cos(angle) * side + std::sin(angle) * towards));
  }
}

void add_wall(Points& points, double y_m, int count, std::mt19937& random) {
  std::uniform_real_distribution<double> x(-1.0, 3.0), z(0.0, 2.0);
  for (int i = 0; i < count; ++i) points.emplace_back(x(random), y_m, z(random));
}

const Pillar* nearest(const std::vector<Pillar>& found, const Pillar& truth) {
  const Pillar* best = nullptr;
  const auto middle = [](const Pillar& p) { return Eigen::Vector3d(0.5 * (p.from_m + p.to_m)); };
  for (const Pillar& pillar : found)
    if (best == nullptr || (middle(pillar) - middle(truth)).norm() < (middle(*best) - middle(truth)).norm())
      best = &pillar;
  return best;
}

std::vector<Pillar> find(const Points& points) {
  Progress progress;
  return find_pillars(points, progress);
}

TEST(Pillars, StraightAndLeaningOnesAreFoundBeforeAWallAndFarFromTheOrigin) {
  const Eigen::Vector3d far(450000.0, 5412000.0, 120.0);
  const std::vector<Pillar> truth = {{{0.0, 0.0, 0.0}, {0.0, 0.0, 1.8}, 0.10},
                                     {{0.8, 0.0, 0.0}, {0.8, 0.0, 1.8}, 0.05},
                                     {{1.6, 0.0, 0.0}, {1.9, 0.0, 1.7}, 0.07}};
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    Points points;
    for (const Pillar& pillar : truth) add_pillar(points, pillar, 3000, 0.001, random);
    add_wall(points, 0.5, 9000, random);
    for (Eigen::Vector3d& p : points) p += far;
    const std::vector<Pillar> found = find(points);
    ASSERT_EQ(found.size(), truth.size()) << seed;
    for (Pillar pillar : truth) {
      pillar.from_m += far;
      pillar.to_m += far;
      const Pillar& match = *nearest(found, pillar);
      EXPECT_NEAR(match.radius_m, pillar.radius_m, 0.1 * pillar.radius_m) << seed;
      const Eigen::Vector3d axis = (pillar.to_m - pillar.from_m).normalized();
      EXPECT_GT(std::abs((match.to_m - match.from_m).normalized().dot(axis)), std::cos(0.03)) << seed;
      for (const Eigen::Vector3d& end : {match.from_m, match.to_m})
        EXPECT_LT(axis.cross(end - pillar.from_m).norm(), 0.1 * pillar.radius_m + 0.005) << seed;
      EXPECT_NEAR((match.to_m - match.from_m).norm(), (pillar.to_m - pillar.from_m).norm(), 0.1) << seed;
    }
  }
}

TEST(Pillars, WallsBallsAndNoiseAreNone) {
  std::mt19937 random(7);
  Points wall;
  add_wall(wall, 0.0, 8000, random);
  EXPECT_TRUE(find(wall).empty());
  std::normal_distribution<double> gauss(0.0, 1.0);
  Points ball, noise;
  for (int i = 0; i < 6000; ++i) {
    const Eigen::Vector3d direction(gauss(random), gauss(random), gauss(random));
    ball.push_back(0.3 * direction.normalized());
    noise.push_back(direction);
  }
  EXPECT_TRUE(find(ball).empty());
  EXPECT_TRUE(find(noise).empty());
  EXPECT_TRUE(find({}).empty());
  EXPECT_TRUE(find(Points(500, Eigen::Vector3d(1.0, 2.0, 3.0))).empty());
}

TEST(Pillars, TheSearchEndsWhenItIsCancelled) {
  std::mt19937 random(3);
  Points points;
  add_wall(points, 0.5, 9000, random);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(static_cast<void>(find_pillars(points, progress)), Cancelled);
}

}  // namespace
}  // namespace sparsha::pipeline
