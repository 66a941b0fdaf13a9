// Sets of scans that nobody has placed, beside those of tests/support/stations.h.
#pragma once

#include <cstdio>

#include "tests/support/scan_files.h"
#include "tests/support/stations.h"

namespace sparsha::pipeline::testing {

/// A set of scans that nobody has placed, and the poses that would place them.
struct Scattered {
  std::vector<scene::ScanConfig> scans;  ///< without poses
  std::vector<scene::ScanConfig> truth;
};
/// Copies of the scans as text files of `folder`, the points of each turned by any rotation, all equally likely, and
/// shifted by up to `most_m`.
inline Scattered scattered(const ScanFolder& folder, const std::vector<scene::ScanConfig>& scans, std::uint64_t seed,
                           double most_m) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  Scattered result;
  for (const scene::ScanConfig& scan : scans) {
    Eigen::Vector4d q;  // uniform in the ball, so that its direction is uniform on the sphere
    do {
      for (int k = 0; k < 4; ++k) q[k] = 2.0 * uniform() - 1.0;
    } while (q.norm() > 1.0 || q.norm() < 0.1);
    const Eigen::Matrix4d moved =
        rigid(Eigen::Quaterniond(q.normalized()).toRotationMatrix(), most_m * uniform() * direction(random));
    std::string text;
    char line[128];
    for (const Eigen::Vector3d& point : read_scan(scan.file).points) {
      const Eigen::Vector4d p = moved * point.homogeneous();
      std::snprintf(line, sizeof line, "%.9f %.9f %.9f\n", p.x(), p.y(), p.z());
      text += line;
    }
    scene::ScanConfig copy;
    copy.file = folder.write("seed-" + std::to_string(seed) + "-" + std::to_string(result.scans.size()) + ".xyz", text);
    copy.units.unit = scene::LengthUnit::m;
    result.scans.push_back(copy);
    copy.pose = scan.pose * moved.inverse();
    result.truth.push_back(copy);
  }
  return result;
}

}  // namespace sparsha::pipeline::testing
