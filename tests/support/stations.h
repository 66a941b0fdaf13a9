// Sets of scans with known poses, disturbed by seeded motions, and how far found poses are from the truth. For tests
// and the bench.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "pipeline/register/register.h"
#include "pipeline/scan/reader.h"

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
inline Eigen::Vector3d middle_of(const scene::ScanConfig& scan) {
  const RawScan raw = read_scan(scan.file);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : raw.points) sum += p;
  return scan.pose.topLeftCorner<3, 3>() * (sum / static_cast<double>(raw.points.size())) +
         scan.pose.topRightCorner<3, 1>();
}

/// Turns every scan about its own middle by `degrees` and shifts it by `shift_m`, each in a direction of the seed.
inline std::vector<scene::ScanConfig> disturbed(const std::vector<scene::ScanConfig>& scans, std::uint64_t seed,
                                                double degrees, double shift_m) {
  std::mt19937_64 random(seed);
  std::vector<scene::ScanConfig> result = scans;
  for (scene::ScanConfig& scan : result) {
    const Eigen::Vector3d middle = middle_of(scan);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(degrees * std::acos(-1.0) / 180.0, direction(random)).toRotationMatrix();
    scan.pose = rigid(turn, middle - turn * middle + shift_m * direction(random)) * scan.pose;
  }
  return result;
}

/// Stations in a circle about an object without repeats (a vessel of 0.25 m), each of which sees 110 degrees of it, as
/// PLY files of `folder` in the stations' own coordinates; the poses are the true ones. `points` of station k.
inline std::vector<scene::ScanConfig> ring(const std::filesystem::path& folder, int stations,
                                           const std::function<int(int)>& points, double noise_m, std::uint64_t seed) {
  const double pi = std::acos(-1.0);
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  const auto radius = [](double a, double z) {
    return 0.1 + 0.012 * std::sin(3.0 * a + 9.0 * z) + 0.008 * std::sin(5.0 * a + 40.0 * z + 1.0) +
           0.005 * std::cos(7.0 * a - 60.0 * z) + 0.003 * std::cos(13.0 * a + 75.0 * z + 2.0);
  };
  std::vector<scene::ScanConfig> scans;
  for (int k = 0; k < stations; ++k) {
    const double facing = 2.0 * pi * k / stations;
    scene::ScanConfig scan;
    scan.file = folder / ("station-" + std::to_string(k) + ".ply");
    scan.units.unit = scene::LengthUnit::m;
    // The scanner stands 1 m from the middle and looks at it along its own -z.
    Eigen::Matrix3d turn;
    turn.col(2) = Eigen::Vector3d(std::cos(facing), std::sin(facing), 0.0);
    turn.col(0) = Eigen::Vector3d(-std::sin(facing), std::cos(facing), 0.0);
    turn.col(1) = turn.col(2).cross(turn.col(0));
    scan.pose = rigid(turn, turn.col(2));
    const int count = points(k);
    std::ofstream file(scan.file, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << count
         << "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
    for (int i = 0; i < count; ++i) {
      const double a = facing + (uniform() - 0.5) * 110.0 / 180.0 * pi;
      const double z = 0.25 * (uniform() - 0.5);
      double sum = -6.0;  // of twelve uniform numbers: nearly Gaussian
      for (int n = 0; n < 12; ++n) sum += uniform();
      const double r = radius(a, z) + noise_m * sum;
      const Eigen::Vector3d p = turn.transpose() * (Eigen::Vector3d(r * std::cos(a), r * std::sin(a), z) - turn.col(2));
      file.write(reinterpret_cast<const char*>(p.data()), 3 * sizeof(double));
    }
    scans.push_back(scan);
  }
  return scans;
}

/// RMS over all points of all scans of the distance between where found and true poses put them, after one rigid motion
/// of the whole set that puts the first scan where it truly is (`by_first`) or that fits best (Horn's method).
inline double rms_error(const std::vector<scene::ScanConfig>& truth, const std::vector<Eigen::Matrix4d>& found,
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

inline Registration registered(const std::vector<scene::ScanConfig>& scans, const scene::RegisterConfig& config = {},
                               unsigned threads = 2) {
  Progress progress;
  ThreadPool pool(threads);
  return register_scans(scans, config, {pool, progress});
}

/// The Stanford bunny's range scans with the poses of bun.conf, whose quaternions turn the other way.
inline std::vector<scene::ScanConfig> bunny(const std::filesystem::path& folder) {
  std::vector<scene::ScanConfig> scans;
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
    scene::ScanConfig scan;
    scan.file = folder / name;
    scan.units.unit = scene::LengthUnit::m;
    scan.pose = rigid(Eigen::Quaterniond(v[6], v[3], v[4], v[5]).conjugate().normalized().toRotationMatrix(),
                      {v[0], v[1], v[2]});
    scans.push_back(scan);
  }
  return scans;
}

}  // namespace sparsha::pipeline::testing
