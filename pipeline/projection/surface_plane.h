// The plane through a point's nearest neighbours in space: the local surface, whichever side it is looked at from.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace sparsha::pipeline {

/// A point in metres, relative to some origin near it.
struct SpacePoint {
  float x, y, z;
};

/// Least-squares plane (Hoppe et al. 1992, section 3.2) and what is left of the points across it.
struct SurfacePlane {
  std::array<double, 3> normal{0.0, 0.0, 1.0};  ///< unit length, z >= 0
  std::array<double, 3> variance_m2{};          ///< along the principal axes, ascending
  double radius_m = 0.0;                        ///< distance to the farthest of the neighbours

  /// False for a ball or a line of points, whose normal means nothing.
  [[nodiscard]] bool planar() const {
    return variance_m2[0] < 0.4 * variance_m2[1] && variance_m2[1] > 0.02 * variance_m2[2];
  }
  /// True for a strip of points, as one line of a scanner whose lines are farther apart than the points on them: more
  /// neighbours are needed.
  [[nodiscard]] bool narrow() const { return variance_m2[1] < kNarrow * variance_m2[2]; }

  static constexpr double kNarrow = 0.1;  ///< of points in a disc one neighbourhood of 14 in a thousand is so narrow
};

/// What is left of a neighbourhood where a gap across its plane tells two faces of a thin sheet apart: the face that
/// the centre lies on, between two planes.
struct Sheet {
  std::array<double, 3> normal{0.0, 0.0, 1.0};
  double below_m = 0.0, above_m = 0.0;  ///< along the normal, from the centre
};

/// Finds neighbours by going through all points; for samples of at most some thousand. One a thread.
class Neighbourhood {
 public:
  explicit Neighbourhood(std::span<const SpacePoint> points) : points_(points) {}

  /// Takes the `count` points nearest to point `index`, itself among them, or as many as are within `most_m` and of the
  /// `sheet`, if one is given, and returns how many these are. Equal distances are taken in the order of the points.
  std::size_t take(std::size_t index, std::size_t count, double most_m, const Sheet* sheet = nullptr);

  /// Distance of the `count`th nearest of those taken.
  [[nodiscard]] double radius_m(std::size_t count) const;

  [[nodiscard]] SurfacePlane plane() const;
  /// The centre's face of a thin sheet, where those taken lie on both. Absent when no gap across their plane exceeds
  /// 0.3 of their distance from each other and what scatters on both sides of it.
  [[nodiscard]] std::optional<Sheet> sheet(const SurfacePlane& plane) const;
  /// Whether the nearest `count` of those taken are a strip (SurfacePlane::narrow).
  [[nodiscard]] bool narrow(std::size_t count) const;
  /// Standard deviation of the points taken about a quadric over their plane, six degrees of freedom taken off. Absent
  /// when they do not determine one. Requires more than seven of them.
  [[nodiscard]] std::optional<double> residual_m(const SurfacePlane& plane) const;

 private:
  struct Near {
    float distance2;
    std::size_t index;
  };
  [[nodiscard]] std::array<double, 3> relative(std::size_t k) const;

  std::span<const SpacePoint> points_;
  std::size_t centre_ = 0;
  std::vector<Near> near_;
};

}  // namespace sparsha::pipeline
