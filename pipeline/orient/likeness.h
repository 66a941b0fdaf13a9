// How much an object looks like a face from all around: carving that is like its own mirror image.
#pragma once

#include <array>
#include <cstddef>
#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "pipeline/orient/side_picture.h"

namespace sparsha::pipeline {

/// How much a picture is like a face, row by row from the bottom.
struct Likeness {
  std::vector<double> mirrored;  ///< carving times its mirror image
  std::vector<double> profile;   ///< squared changes of the carving from row to row, along the mirror axis
  double area = 0.0;             ///< pixels that the object covers
};

/// The views of an object around an axis.
class FaceRing {
 public:
  static constexpr std::size_t kTurns = 24;
  static constexpr double kTurn = 2.0 * std::numbers::pi / static_cast<double>(kTurns);

  /// `up` is of length 1. Views start at the axis of the scan that is nearest to the horizon, as custom has it.
  FaceRing(const EvenPoints& object, const Eigen::Vector3d& up);

  /// Of length 1, at right angles to `up`; any number of turns of kTurn.
  [[nodiscard]] Eigen::Vector3d direction(double turns) const;
  /// A view's worth as a front, any number of turns. What is alike from all sides, as a round plinth, counts for none.
  [[nodiscard]] double worth_at(double turns) const;
  /// Of the views at whole turns.
  [[nodiscard]] const std::array<double, kTurns>& worth() const { return worth_; }
  [[nodiscard]] const Eigen::Vector3d& ahead() const { return ahead_; }

 private:
  [[nodiscard]] double worth_of(const Likeness& likeness) const;
  [[nodiscard]] Likeness likeness_at(double turns) const;

  const EvenPoints& object_;
  Eigen::Vector3d up_, ahead_;
  std::vector<double> mirrored_, profile_;  // the least of each row over all views
  std::array<double, kTurns> worth_{};
};

}  // namespace sparsha::pipeline
