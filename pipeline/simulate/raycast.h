// Where a beam meets a height field: a pyramid of maxima skips free air, the closed form gives the exact point
// (Tevs, Ihrke & Seidel 2008, "Maximum mipmaps for fast, accurate, and scalable dynamic height field rendering").
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "base/threads/thread_pool.h"

namespace sparsha::pipeline {

/// Thread-safe after construction. The solid lies below z = height(x, y) over [0, width] x [0, length]; a beam that
/// enters it from the side meets its flank.
class HeightCaster {
 public:
  using Height = std::function<double(double x, double y)>;

  HeightCaster(Height height, double width_m, double length_m, ThreadPool& pool);

  struct Hit {
    double distance_m = 0.0;
    bool on_flank = false;
  };
  /// First meeting of the beam origin + t * direction, t >= 0, with the solid; `direction` is a unit vector whose z is
  /// negative. To 1e-9 of the size. Nothing when the beam passes.
  [[nodiscard]] std::optional<Hit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  [[nodiscard]] double highest_m() const { return levels_.back().maximum.front(); }

 private:
  /// Maxima of the height over squares of 2^level cells, with a margin for what lies between samples.
  struct Level {
    int nx = 0, ny = 0;
    std::vector<float> maximum;
  };
  [[nodiscard]] std::optional<double> meet_in_cell(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                                   double begin, double end) const;

  Height height_;
  double width_m_, length_m_;
  double cell_m_ = 0.0;
  double lowest_m_ = 0.0;      // surely below the surface
  std::vector<Level> levels_;  // the last has one square
};

}  // namespace sparsha::pipeline
