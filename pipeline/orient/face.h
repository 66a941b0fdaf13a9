// How an object is turned so that its face is to the viewer and it stands upright, found from its points.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/cloud.h"
#include "scene/config/orientation.h"

namespace sparsha::pipeline {

/// What the face is looked for in. Scan frame, metres.
struct FacePoints {
  std::vector<Eigen::Vector3d> sample_m{};  ///< of all points, evenly chosen; 20 000 are enough
  std::vector<Station> stations{};          ///< a face that stations saw looks at them
  bool z_up = false;                        ///< by the custom of the scans' format; else y
};

struct FoundFace {
  Eigen::Matrix4d scan_to_grid;  ///< a rotation about the scan frame's origin, times the scale
  std::string reason;            ///< for the user: what was found
};

/// Turns the largest plane (plane), the broad side (principal), or the first of both that is there (automatic) to the
/// viewer. Up is, of the two principal axes across the view, the one nearest to `up`, or to the format's own up where
/// it is absent; where both are as long, that direction itself. Depends on the set of points alone, not on their order.
/// Throws Error{input} when no plane holds a twentieth of the points, or the points have no extent; Error{usage} when
/// `up` is parallel to the view.
[[nodiscard]] FoundFace find_face(const FacePoints& points, scene::OrientationConfig::Face face,
                                  const std::optional<Eigen::Vector3d>& up, double scale);

/// The side of a flat thing that is seen: towards the scan's origin where that is near enough to be a scanner's place,
/// else towards the positive axes. `size_m` is the thing's.
[[nodiscard]] bool origin_is_a_scanner(const Eigen::Vector3d& direction, const Eigen::Vector3d& centre_m,
                                       double size_m);
[[nodiscard]] Eigen::Vector3d seen_side(const Eigen::Vector3d& direction, const Eigen::Vector3d& centre_m,
                                        double size_m);

/// The upward direction that custom has for a view: z (z_up) or y. The other one where the view is along it, and where
/// a wall seen in that view is turned about the other axis and hardly leans along it.
[[nodiscard]] Eigen::Vector3d customary_up(const Eigen::Vector3d& look_from, bool z_up);

}  // namespace sparsha::pipeline
