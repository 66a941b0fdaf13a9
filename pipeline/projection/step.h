// Two layers of points in one window: a step that the node stands on one side of, or a front that hides a back.
#pragma once

#include <span>

#include "pipeline/projection/local_fit.h"

namespace sparsha::pipeline {

/// Widest empty band between two sets in u, v (the closest points of their convex hulls).
struct Separation {
  bool separable = false;
  double margin = 0.0;      ///< width of the band, spacings
  double node_side = 0.0;   ///< of the origin from the middle of the band, spacings; positive on `a`'s side
  double u = 0.0, v = 0.0;  ///< unit vector across the band, towards `a`
};
[[nodiscard]] Separation separate(std::span<const NodePoint> a, std::span<const NodePoint> b);

}  // namespace sparsha::pipeline
