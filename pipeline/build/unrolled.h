// A cloud laid flat from the mantle of a cylinder or cone (scene/frame/unrolling.h).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/projection/projection.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/config.h"
#include "scene/frame/unrolling.h"

namespace sparsha::pipeline {

struct UnrolledCloud {
  scene::UnrollConfig unroll;    ///< with everything that was found
  Eigen::Matrix4d scan_to_grid;  ///< touches the mantle in the middle of the picture
  scene::GridConfig grid;        ///< of a cylinder with a spacing that divides the way around, and bounds
  std::size_t points = 0;        ///< of the cloud before points beside the seam were repeated
  std::string reason;            ///< for the user: what was found
};

/// Lays a cloud out flat in place, its points as measured too. Points within a twelfth of a turn of the seam, and some
/// more, are there twice, the second time behind all others, on the other side; a vertex of a face is repeated as often
/// as its faces need it. `sample_m`: points that the axis is looked for in. Throws what find_mantle() and project()
/// throw.
[[nodiscard]] UnrolledCloud unroll_cloud(Cloud& cloud, const std::vector<Eigen::Vector3d>& sample_m,
                                         const scene::Config& config, const scene::GridConfig& grid,
                                         const Context& context);

/// Lays points that stand beside a cloud out flat.
void unroll_points(Cloud& cloud, const scene::Unrolling& unrolling);

/// Takes points that were repeated, those from `points` on, out of what was counted. They stay in the cloud: the check
/// holds both sides of the seam against the surface.
void uncount_repeated(std::size_t points, Projection& projection);

}  // namespace sparsha::pipeline
