// Scans of made-up places by a scanner that turns, column by column, as files in scan order keep them.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <fmt/format.h>

namespace sparsha::test {

/// Metres that lie free about a place, or a lower bound of them; below zero in the stone.
using Free = std::function<double(const Eigen::Vector3d&)>;

struct RasterScan {
  Eigen::Vector3d place;
  int columns = 0, rows = 0;
  std::vector<Eigen::Vector3d> seen;  ///< relative to the place, column by column; zero where nothing was hit
};

/// All around and from 60 degrees below to 80 above the horizon, with steps of `step_rad` and noise along the ray.
inline RasterScan scan_from(const Eigen::Vector3d& place, const Free& free, double step_rad, double noise_m = 0.002) {
  constexpr double kReach_m = 15.0, kLow = -1.05, kHigh = 1.4;
  RasterScan scan{place, static_cast<int>(2.0 * M_PI / step_rad), static_cast<int>((kHigh - kLow) / step_rad), {}};
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0.0, noise_m);
  for (int i = 0; i < scan.columns; ++i)
    for (int j = 0; j < scan.rows; ++j) {
      const double turn = step_rad * i, up = kLow + step_rad * j;
      const Eigen::Vector3d ray(std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up));
      double range = 0.0;
      for (double left = 1.0; left > 1e-5 && range < kReach_m; range += left) left = 0.7 * free(place + range * ray);
      const double offset = noise(random);
      scan.seen.push_back(range < kReach_m ? Eigen::Vector3d((range + offset) * ray) : Eigen::Vector3d::Zero());
    }
  return scan;
}

inline std::string ptx_of(const std::vector<RasterScan>& scans) {
  std::string text;
  for (const RasterScan& scan : scans) {
    const std::string at = fmt::format("{} {} {}", scan.place.x(), scan.place.y(), scan.place.z());
    text += fmt::format("{}\n{}\n{}\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n{} 1\n", scan.columns, scan.rows,
                        at, at);
    for (const Eigen::Vector3d& p : scan.seen) text += fmt::format("{:.4f} {:.4f} {:.4f} 0.5\n", p.x(), p.y(), p.z());
  }
  return text;
}

/// A cave, 10 m long: an uneven ellipsoid with a flat floor.
inline double free_in_cave(const Eigen::Vector3d& p) {
  const double bumps = 0.12 * std::sin(1.7 * p.x()) * std::cos(2.1 * p.y() + 0.4) * std::sin(1.3 * p.z() + 1.0);
  const double wall = (1.0 + bumps - Eigen::Vector3d(p.x() / 5.0, p.y() / 3.0, p.z() / 2.2).norm()) * 2.0;
  return std::min(wall, p.z() + 1.2);
}

/// A tunnel, 24 m long, with an arched roof and walls at its ends.
inline double free_in_tunnel(const Eigen::Vector3d& p) {
  const double arch =
      1.5 - std::hypot(p.y(), std::max(p.z(), 0.0)) + 0.03 * std::sin(2.0 * p.x()) * std::cos(3.0 * p.z());
  return std::min({arch, p.z() + 1.2, 12.0 - std::abs(p.x())});
}

/// A niche of 2 m in a wall across y, with a quarter of a dome above and a floor before it.
inline double free_before_apse(const Eigen::Vector3d& p) {
  const double round = std::hypot(p.x(), p.y());
  const double niche = 2.0 - (p.z() < 1.5 ? round : std::hypot(round, p.z() - 1.5));
  const double room = std::min({-p.y(), 3.0 - std::abs(p.x()), 4.0 - p.z(), p.y() + 5.0});
  return std::min(std::max(niche, room), p.z() + 1.0);
}

}  // namespace sparsha::test
