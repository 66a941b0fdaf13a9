// Walls so thin that the two faces of each are taken for one surface: told by the points, since discs no longer are
// two.
#pragma once

#include "base/threads/thread_pool.h"
#include "pipeline/projection/points.h"
#include "pipeline/projection/tangent_discs.h"

namespace sparsha::pipeline {

/// Shares of the discs, 0 to 1, about which two faces lie in each other.
struct MixedFaces {
  double together = 0.0;  ///< one plane between both: its points lie in two heaps, before and behind it
  double apart = 0.0;     ///< planes of one face or none: many points have no plane of their own
  /// What noise and fine forms explain: objects of 300 to 40 000 points that are thicker than three spacings, with
  /// sharp edges and without, and statues of 1000 points have up to 0.07 and 0.14 of both; thin walls 0.25 to 1.
  static constexpr double kNone = 0.15;

  /// 0 where it may be noise.
  [[nodiscard]] double share() const { return together + apart > kNone ? together + apart : 0.0; }
};

/// Of about 5000 of `discs`, which were found of `points`, all of them; `spacing_m` is that of the points on the
/// surface. Depends neither on threads nor on the points' order.
[[nodiscard]] MixedFaces find_mixed_faces(const TangentDiscs& discs, const OrientedPoints& points, double spacing_m,
                                          ThreadPool& pool);

}  // namespace sparsha::pipeline
