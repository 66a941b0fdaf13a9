// Made scans, and what is said of them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/doubts.h"
#include "pipeline/scan/set.h"
#include "scene/config/config.h"

namespace sparsha::pipeline::testing {

using Points = std::vector<Eigen::Vector3d>;
using Face = std::array<std::uint32_t, 3>;

inline const Eigen::Vector3d kUtm(412345.0, 5654321.0, 100.0);

inline double relief(double x, double y) { return 0.02 * std::sin(9.0 * x) * std::cos(8.0 * y); }

/// `count` points at random over 1 m x 0.8 m.
inline Points random_relief(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Points points;
  for (int k = 0; k < count; ++k) {
    const double x = unit(random);
    const double y = 0.8 * unit(random);
    points.emplace_back(x, y, relief(x, y));
  }
  return points;
}

inline Points moved(Points points, const Eigen::Vector3d& shift) {
  for (Eigen::Vector3d& p : points) p += shift;
  return points;
}

inline RawScan scan_of(Points points, std::vector<Face> faces = {}) {
  RawScan scan;
  scan.format = "XYZ text";
  scan.records = points.size();
  scan.points = std::move(points);
  scan.faces = std::move(faces);
  return scan;
}

inline std::vector<std::string> doubts_of(Points points, std::vector<Face> faces = {}) {
  RawScan scan = scan_of(std::move(points), std::move(faces));
  add_doubts(scan);
  if (!scan.pieces.empty()) scan.warnings.push_back(scan.pieces);
  return scan.warnings;
}

inline std::string text_of(const Points& points) {
  std::ostringstream text;
  text.precision(12);
  for (const Eigen::Vector3d& p : points) text << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  return text.str();
}

inline scene::ScanConfig config_of(const std::filesystem::path& file,
                                   scene::LengthUnit unit = scene::LengthUnit::automatic) {
  scene::ScanConfig config;
  config.file = file;
  config.units.unit = unit;
  return config;
}

/// A square of 21 x 21 vertices, 0.02 apart, at z = -0.6.
inline RawScan square_mesh() {
  Points corners;
  std::vector<Face> faces;
  for (std::uint32_t j = 0; j < 21; ++j)
    for (std::uint32_t i = 0; i < 21; ++i) {
      corners.emplace_back(0.02 * i - 0.2, 0.02 * j - 0.2, -0.6);
      const std::uint32_t n = 21 * j + i;
      if (i < 20 && j < 20) faces.insert(faces.end(), {{n, n + 1, n + 21}, {n + 1, n + 22, n + 21}});
    }
  return scan_of(std::move(corners), std::move(faces));
}

}  // namespace sparsha::pipeline::testing
