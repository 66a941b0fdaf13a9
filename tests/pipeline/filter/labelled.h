// Clouds whose parts are known: an object on a floor, with a label for every point.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include "base/threads/context.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

enum class Part : std::uint8_t { floor, table, object, dirt };

struct LabelledCloud {
  std::vector<Eigen::Vector3d> points_m;  ///< scan frame
  std::vector<Part> parts;

  void add(const Eigen::Vector3d& p, Part part) {
    points_m.push_back(p);
    parts.push_back(part);
  }
  void transform(const Eigen::Affine3d& affine) {
    for (Eigen::Vector3d& p : points_m) p = affine * p;
  }
  /// As a scan is read: float32 relative to `origin_m`; the colour is the point's number.
  [[nodiscard]] Cloud cloud(const Eigen::Vector3d& origin_m = Eigen::Vector3d::Zero()) const {
    Cloud result;
    result.origin_m = origin_m;
    result.resize_points(points_m.size());
    for (std::size_t i = 0; i < points_m.size(); ++i) {
      const Eigen::Vector3f p = (points_m[i] - origin_m).cast<float>();
      for (Eigen::Index k = 0; k < 3; ++k) result.xyz1()[4 * i + static_cast<std::size_t>(k)] = p[k];
      result.rgba.push_back(static_cast<std::uint32_t>(i));
    }
    return result;
  }
};

/// Points of a square of the plane z = `height`, with noise along z.
inline void add_square(LabelledCloud& cloud, double half_m, double height_m, std::size_t count, double noise_m,
                       Part part, std::mt19937& random) {
  std::uniform_real_distribution<double> place(-half_m, half_m);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place(random);
    const double y = place(random);
    cloud.add({x, y, height_m + noise_m * noise(random)}, part);
  }
}

/// Points of a sphere of radius `r`, resting at the height `bottom_m`.
inline void add_sphere(LabelledCloud& cloud, const Eigen::Vector2d& at, double r, double bottom_m, std::size_t count,
                       double noise_m, Part part, std::mt19937& random) {
  std::normal_distribution<double> normal(0.0, 1.0);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = normal(random);
    const double y = normal(random);
    const double z = normal(random);
    const Eigen::Vector3d direction = Eigen::Vector3d(x, y, z).normalized();
    const Eigen::Vector3d centre(at.x(), at.y(), bottom_m + r);
    cloud.add(centre + (r + noise_m * normal(random)) * direction, part);
  }
}

/// What is left after filters, by the colours that say which points they are.
struct Left {
  std::array<std::size_t, 4> of{};  ///< points left of each part
  [[nodiscard]] std::size_t operator[](Part part) const { return of[static_cast<std::size_t>(part)]; }
};
inline Left left_of(const LabelledCloud& truth, const Cloud& cloud) {
  Left left;
  for (const std::uint32_t index : cloud.rgba) ++left.of[static_cast<std::size_t>(truth.parts[index])];
  return left;
}

/// Threads and progress for one test.
struct Work {
  explicit Work(unsigned threads = 2) : pool(threads) {}
  [[nodiscard]] Context context() { return {pool, progress}; }
  ThreadPool pool;
  Progress progress;
};

}  // namespace sparsha::pipeline
