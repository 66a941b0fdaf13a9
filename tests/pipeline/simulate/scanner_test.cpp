// Stations see what a straight line of sight reaches, at their angular step, and nothing else.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "pipeline/simulate/simulate.h"

namespace sparsha::pipeline {
namespace {

SimulationConfig one_station(const Form& form, const Eigen::Vector3d& position, double step_rad) {
  SimulationConfig config;
  config.surface.form = form;
  config.noise_m = 0.0;
  StationConfig station;
  station.position_m = position;
  station.target_m = {0.5, 0.5, 0.0};
  station.step_rad = step_rad;
  config.scan = ScannerConfig{{station}};
  return config;
}

/// Marches from the point towards the station in steps of 0.1 mm: a brute force that shares nothing with the pyramid.
bool sees(const Surface& surface, const Eigen::Vector3d& point, const Eigen::Vector3d& station) {
  const Eigen::Vector3d direction = (station - point).normalized();
  for (double t = 1e-4;; t += 1e-4) {
    const Eigen::Vector3d p = point + t * direction;
    if (p.z() > surface.z_range()[1] || std::min(p.x(), p.y()) < 0.0 || std::max(p.x(), p.y()) > 1.0) return true;
    if (surface.z(p.x(), p.y()) > p.z() + 1e-6) return false;
  }
}

TEST(Scanner, EveryPointLiesOnTheSurfaceAndIsInSight) {
  for (const Form& form : {Form{AccuracyForm{}}, Form{SinusoidForm{0.08, 0.3}}}) {
    const Eigen::Vector3d position(-0.8, 0.7, 0.55);
    const SimulationConfig config = one_station(form, position, 0.012);
    const SimulatedScan scan = generate(config);
    const Surface surface(config.surface);
    ASSERT_GT(scan.points_m.size(), 1000U);
    std::size_t walls = 0;
    for (const Eigen::Vector3d& p : scan.points_m) {
      ASSERT_TRUE(sees(surface, p, position)) << p.transpose();
      if (surface.step_distance_m(p.x(), p.y()) < 1e-7) {
        ++walls;  // on the flank of the step
        continue;
      }
      ASSERT_NEAR(p.z(), surface.z(p.x(), p.y()), 1e-8);
    }
    EXPECT_LT(walls, scan.points_m.size() / 20);
  }
}

TEST(Scanner, NoBeamThatWouldMeetTheSurfaceIsLost) {
  const Eigen::Vector3d position(-0.8, 0.7, 0.55);
  const SimulationConfig config = one_station(SinusoidForm{0.08, 0.3}, position, 0.008);
  const SimulatedScan scan = generate(config);
  // Independent count: beams of the same fan, marched in steps of 0.2 mm.
  const Surface surface(config.surface);
  const Eigen::Vector3d forward = Eigen::Vector3d(1.3, 0.0, -0.55).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitY());
  std::size_t met = 0;
  for (int a = -100; a <= 100; ++a) {
    for (int e = -150; e <= 150; ++e) {
      const double azimuth = a * 0.008, elevation = e * 0.008;
      const Eigen::Vector3d d = std::cos(elevation) * (std::cos(azimuth) * forward + std::sin(azimuth) * right) +
                                std::sin(elevation) * Eigen::Vector3d::UnitY();
      if (d.z() >= 0.0) continue;
      bool entered = false;
      for (double t = (0.081 - position.z()) / d.z(); t < 6.0; t += 2e-4) {
        const Eigen::Vector3d p = position + t * d;
        const bool over = std::min(p.x(), p.y()) >= 0.0 && std::max(p.x(), p.y()) <= 1.0;
        const bool below = over && p.z() < surface.z(p.x(), p.y());
        if (over && below) {
          met += entered ? 1 : 0;  // the first sample inside the domain is below: the flank, which has no solid here
          break;
        }
        entered = entered || over;
        if (p.z() < -0.081) break;
      }
    }
  }
  // Beams that graze a crest or enter within a step of the border may be counted on one side only.
  EXPECT_NEAR(static_cast<double>(met), static_cast<double>(scan.points_m.size()), 0.004 * static_cast<double>(met));
}

TEST(Scanner, AnglesAreMultiplesOfTheStep) {
  const Eigen::Vector3d position(0.2, 0.3, 1.5);
  const double step = 0.005;
  const SimulationConfig config = one_station(AccuracyForm{}, position, step);
  const Eigen::Vector3d forward = Eigen::Vector3d(0.3, 0.0, -1.5).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitY());
  for (const Eigen::Vector3d& p : generate(config).points_m) {
    const Eigen::Vector3d ray = (p - position).normalized();
    const double azimuth = std::atan2(ray.dot(right), ray.dot(forward)) / step;
    const double elevation = std::asin(ray.y()) / step;
    ASSERT_NEAR(azimuth, std::round(azimuth), 1e-8 / step);
    ASSERT_NEAR(elevation, std::round(elevation), 1e-8 / step);
  }
}

TEST(Scanner, ABarCastsTheShadowThatGeometrySays) {
  // Bars of 20 mm height seen from the left at a slope: the shadow on the plane is height / slope of the beam long.
  const Eigen::Vector3d position(-4.0, 0.5, 1.0);
  const SimulationConfig config = one_station(BarsForm{0.02, 0.1, 0.5, false}, position, 0.0008);
  const double edge = 0.30;  // right flank of the first bar, its middle at 0.25
  double nearest = 1.0;
  for (const Eigen::Vector3d& p : generate(config).points_m) {
    if (p.x() > edge + 1e-9 && p.x() < 0.69 && p.z() < 0.01 && std::fabs(p.y() - 0.5) < 0.02) {
      nearest = std::min(nearest, p.x());
    }
  }
  const double shadow_end = position.x() + (edge - position.x()) * 1.0 / (1.0 - 0.02);
  EXPECT_GE(nearest, shadow_end - 1e-6);
  EXPECT_LT(nearest, shadow_end + 0.02);  // one elevation row of beams: 5 m * 0.0008 over the slope 0.23
}

TEST(Scanner, NoiseActsAlongTheBeam) {
  SimulationConfig config = one_station(PlaneForm{}, {-1.5, 0.4, 0.8}, 0.004);
  const SimulatedScan clean = generate(config);
  config.noise_m = 0.001;
  const SimulatedScan noisy = generate(config);
  ASSERT_EQ(clean.points_m.size(), noisy.points_m.size());
  double squares = 0.0;
  for (std::size_t k = 0; k < clean.points_m.size(); ++k) {
    const Eigen::Vector3d ray = (clean.points_m[k] - Eigen::Vector3d(-1.5, 0.4, 0.8)).normalized();
    const Eigen::Vector3d error = noisy.points_m[k] - clean.points_m[k];
    ASSERT_NEAR(error.cross(ray).norm(), 0.0, 1e-12);
    squares += error.squaredNorm();
  }
  const auto n = static_cast<double>(clean.points_m.size());
  EXPECT_NEAR(std::sqrt(squares / n) / 0.001, 1.0, 5.0 / std::sqrt(2.0 * n));
}

TEST(Scanner, AStationBehindRecordsTheBackAndOneInFrontTheFlankToo) {
  SimulationConfig config = one_station(PlaneForm{}, {0.5, 0.5, -2.0}, 0.01);
  config.surface.back = {BackConfig::Kind::parallel, 0.1, 0.0, 0.0};
  const SimulatedScan behind = generate(config);
  ASSERT_GT(behind.points_m.size(), 1000U);
  for (std::size_t k = 0; k < behind.points_m.size(); ++k) {
    ASSERT_EQ(behind.is_front[k], 0);
    ASSERT_NEAR(behind.points_m[k].z(), -0.1, 1e-8);
  }
  std::get<ScannerConfig>(config.scan).stations[0].position_m = {-2.0, 0.5, 0.5};
  const SimulatedScan beside = generate(config);
  std::size_t flank = 0;
  for (const Eigen::Vector3d& p : beside.points_m) {
    if (p.z() < -1e-6) {
      ++flank;
      ASSERT_NEAR(p.x(), 0.0, 1e-8);
      ASSERT_GE(p.z(), -0.1 - 1e-8);
    }
  }
  EXPECT_GT(flank, 100U);
}

TEST(Scanner, GivesTheSameBitsOnAnyNumberOfThreads) {
  SimulationConfig config = one_station(AccuracyForm{}, {0.2, 0.3, 1.5}, 0.004);
  config.noise_m = 0.0002;
  config.outlier_fraction = 0.01;
  config.surface.back = {BackConfig::Kind::rough, 0.2, 0.003, 0.3};
  ThreadPool one(1), four(4);
  const SimulatedScan a = generate(config, one);
  const SimulatedScan b = generate(config, four);
  EXPECT_EQ(a.points_m, b.points_m);
  EXPECT_EQ(a.is_front, b.is_front);
}

TEST(Scanner, AStationInsideTheSolidIsRefused) {
  const SimulationConfig config = one_station(SinusoidForm{0.08, 0.3}, {-1.0, 0.5, 0.05}, 0.01);
  EXPECT_THROW((void)generate(config), Error);
}

TEST(Scanner, AStationVeryFarAwayIsScannedInTimeAndToThePrecisionOfItsDistance) {
  for (const double distance_m : {1e6, 1e7, 1e9}) {
    const SimulationConfig config =
        one_station(SinusoidForm{0.08, 0.3}, {0.5, 0.5, distance_m}, 1.0 / distance_m / 20.0);
    const SimulatedScan scan = generate(config);
    const Surface surface(config.surface);
    ASSERT_GT(scan.points_m.size(), 200U) << distance_m;
    constexpr double kSlope = 2.0;  // of this sinusoid at most: 2 pi 0.08 / 0.3
    const double tolerance_m = 16.0 * (1.0 + kSlope) * 2.3e-16 * distance_m;
    for (const Eigen::Vector3d& p : scan.points_m) {
      ASSERT_NEAR(p.z(), surface.z(p.x(), p.y()), tolerance_m) << distance_m;
    }
  }
}

}  // namespace
}  // namespace sparsha::pipeline
