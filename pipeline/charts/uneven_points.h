// Points that are much denser at some places than at others.
#pragma once

#include "base/error.h"

namespace sparsha::pipeline {

/// Thrown where the points of an object are too uneven for discs of one size.
class UnevenPoints : public Error {
 public:
  /// `spacing_m`: of the points, median on the surface, grid frame.
  explicit UnevenPoints(double spacing_m)
      : Error(ErrorKind::input, {}, "the density of the points varies too much for a surface seen from all sides",
              "points at most places no more than twice as far apart as the median; filters: voxel makes them even"),
        spacing_m_(spacing_m) {}
  [[nodiscard]] double spacing_m() const noexcept { return spacing_m_; }

 private:
  double spacing_m_;
};

}  // namespace sparsha::pipeline
