// Two scans alone: from a rough pose to the one at which the most of all directions of their surfaces meets.
#pragma once

#include <Eigen/Geometry>

#include "base/threads/context.h"
#include "pipeline/register/match.h"
#include "pipeline/register/posed_scan.h"
#include "scene/config/registration.h"

namespace sparsha::pipeline {

constexpr double kTouch = 3.0;  ///< spacings within which aligned surfaces are one

struct PairSearch {
  double reach_m = 0.0;  ///< how far the rough poses may put one place apart
  scene::RegisterConfig::Method method = scene::RegisterConfig::Method::gicp;
  bool any_sign = false;  ///< of normals (MatchLimits)
};

struct PairAlignment {
  Eigen::Isometry3d second_to_first = Eigen::Isometry3d::Identity();
  Hold hold;            ///< of the fine surfaces
  bool unsure = false;  ///< another place along what may slide holds nearly as well
};

/// The pose of `second` on `first`, coarse to fine with distances that shrink. Started at the full reach and nearer:
/// where scans share a part only, what lies far away pulls, and a good rough pose would be lost. One thread; the same
/// result every time. Throws Cancelled.
[[nodiscard]] PairAlignment align_scans(const PosedScan& first, const PosedScan& second, const Eigen::Isometry3d& guess,
                                        const PairSearch& search, const Context& context);

}  // namespace sparsha::pipeline
