// Whether somebody turned about a place while the points were measured: proof that a scanner stood there.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "base/files/message.h"

namespace sparsha::pipeline {

/// The angles between points that follow each other in a file, as seen from a place. A scanner turns by even steps, so
/// that from its own place, and from there alone, most of these angles are the same, whatever the surface is like.
/// Of points in rows about the vertical it is the angles divided by the cosine of the elevation that are the same.
/// Points in another order prove nothing, nor do those whose distances in metres are as even, as a grid's are.
class RasterSteps {
 public:
  /// Consecutive points in the file's order, and the place, in one frame; where turns count, z is the scanner's axis.
  void add(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& place);
  void add(const RasterSteps& other);
  void write(MessageWriter& message) const;
  void add(MessageReader& message);

  [[nodiscard]] bool are_even() const;

 private:
  static constexpr std::size_t kBins = 1024;
  using Histogram = std::array<std::uint32_t, kBins>;  // of logarithms
  Histogram angles_{}, turns_{}, lengths_{};
};

}  // namespace sparsha::pipeline
