// Sets of scans with known poses, disturbed by seeded motions, and how far found poses are from the truth.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "pipeline/register/register.h"
#include "pipeline/scan/reader.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline::testing {

inline Eigen::Matrix4d rigid(const Eigen::Matrix3d& turn, const Eigen::Vector3d& shift) {
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topLeftCorner<3, 3>() = turn;
  pose.topRightCorner<3, 1>() = shift;
  return pose;
}

/// A unit vector from a seeded generator; standard distributions differ between libraries, so none is used.
inline Eigen::Vector3d direction(std::mt19937_64& random) {
  const auto uniform = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53 * 2.0 - 1.0; };
  while (true) {
    const Eigen::Vector3d v(uniform(), uniform(), uniform());
    if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
  }
}

/// The middle of a scan's points, in the scan frame.
inline Eigen::Vector3d middle_of(const ScanConfig& scan) {
  const RawScan raw = read_scan(scan.file);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : raw.points) sum += p;
  return scan.pose.topLeftCorner<3, 3>() * (sum / static_cast<double>(raw.points.size())) +
         scan.pose.topRightCorner<3, 1>();
}

/// Turns every scan about its own middle by `degrees` and shifts it by `shift_m`, each in a direction of the seed.
inline std::vector<ScanConfig> disturbed(const std::vector<ScanConfig>& scans, std::uint64_t seed, double degrees,
                                         double shift_m) {
  std::mt19937_64 random(seed);
  std::vector<ScanConfig> result = scans;
  for (ScanConfig& scan : result) {
    const Eigen::Vector3d middle = middle_of(scan);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(degrees * std::acos(-1.0) / 180.0, direction(random)).toRotationMatrix();
    scan.pose = rigid(turn, middle - turn * middle + shift_m * direction(random)) * scan.pose;
  }
  return result;
}

/// A set of scans that nobody has placed, and the poses that would place them.
struct Scattered {
  std::vector<ScanConfig> scans;  ///< without poses
  std::vector<ScanConfig> truth;
};
/// Copies of the scans as text files of `folder`, the points of each turned by any rotation, all equally likely, and
/// shifted by up to `most_m`.
inline Scattered scattered(const ScanFolder& folder, const std::vector<ScanConfig>& scans, std::uint64_t seed,
                           double most_m) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  Scattered result;
  for (const ScanConfig& scan : scans) {
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
    ScanConfig copy;
    copy.file = folder.write("seed-" + std::to_string(seed) + "-" + std::to_string(result.scans.size()) + ".xyz", text);
    copy.units.unit = LengthUnit::m;
    result.scans.push_back(copy);
    copy.pose = scan.pose * moved.inverse();
    result.truth.push_back(copy);
  }
  return result;
}

/// RMS over all points of all scans of the distance between where found and true poses put them, after one rigid motion
/// of the whole set that puts the first scan where it truly is (`by_first`) or that fits best (Horn's method).
inline double rms_error(const std::vector<ScanConfig>& truth, const std::vector<Eigen::Matrix4d>& found,
                        bool by_first = false) {
  std::vector<Eigen::Vector3d> is;
  std::vector<Eigen::Vector3d> ought;
  for (std::size_t s = 0; s < truth.size(); ++s) {
    const RawScan raw = read_scan(truth[s].file);
    for (std::size_t i = 0; i < raw.points.size(); i += 7) {
      is.emplace_back((found[s] * raw.points[i].homogeneous()).head<3>());
      ought.emplace_back((truth[s].pose * raw.points[i].homogeneous()).head<3>());
    }
  }
  Eigen::Matrix4d back = truth.front().pose * found.front().inverse();
  if (!by_first) {
    Eigen::Matrix3Xd a(3, static_cast<Eigen::Index>(is.size()));
    Eigen::Matrix3Xd b(3, static_cast<Eigen::Index>(is.size()));
    for (std::size_t i = 0; i < is.size(); ++i) {
      a.col(static_cast<Eigen::Index>(i)) = is[i];
      b.col(static_cast<Eigen::Index>(i)) = ought[i];
    }
    back = Eigen::umeyama(a, b, false);
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < is.size(); ++i) sum += ((back * is[i].homogeneous()).head<3>() - ought[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(is.size()));
}

inline Registration registered(const std::vector<ScanConfig>& scans, const RegisterConfig& config = {},
                               unsigned threads = 2) {
  Progress progress;
  ThreadPool pool(threads);
  return register_scans(scans, config, {pool, progress});
}

/// The Stanford bunny's range scans with the poses of bun.conf, whose quaternions turn the other way.
inline std::vector<ScanConfig> bunny(const std::filesystem::path& folder) {
  std::vector<ScanConfig> scans;
  std::ifstream file(folder / "bun.conf");
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string kind;
    std::string name;
    std::array<double, 7> v{};
    words >> kind >> name;
    if (kind != "bmesh" || !std::filesystem::exists(folder / name)) continue;
    for (double& value : v) words >> value;
    ScanConfig scan;
    scan.file = folder / name;
    scan.units.unit = LengthUnit::m;
    scan.pose = rigid(Eigen::Quaterniond(v[6], v[3], v[4], v[5]).conjugate().normalized().toRotationMatrix(),
                      {v[0], v[1], v[2]});
    scans.push_back(scan);
  }
  return scans;
}

}  // namespace sparsha::pipeline::testing
