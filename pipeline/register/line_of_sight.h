// What a scanner saw tells where nothing is: no surface lies between it and its points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include <Eigen/Geometry>

#include "pipeline/register/surface.h"

namespace sparsha::pipeline {

/// Depths of a surface as seen from one place.
class LineOfSight {
 public:
  /// `place` in the surface's coordinates. Sees nothing when the surface lies around the place.
  LineOfSight(const StationSurface& surface, const Eigen::Vector3d& place, const Eigen::Vector3d& middle);

  /// The share of the other's elements that stand in the way: nearer than what was seen by more than `clearance_m`.
  [[nodiscard]] double in_the_way(const StationSurface& other, const Eigen::Isometry3d& other_to_this,
                                  double clearance_m) const;

 private:
  struct Pixel {
    std::int64_t x = 0;
    std::int64_t y = 0;
    double depth_m = 0.0;
  };
  [[nodiscard]] bool project(const Eigen::Vector3d& point, Pixel& pixel) const;
  [[nodiscard]] static std::uint64_t key(std::int64_t x, std::int64_t y);

  Eigen::Vector3d place_;
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();  ///< rows: right, up, depth
  double distance_m_ = 0.0;
  double cell_m_ = 0.0;
  std::unordered_map<std::uint64_t, double> nearest_m_;
};

}  // namespace sparsha::pipeline
