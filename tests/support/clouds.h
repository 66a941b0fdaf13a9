// Clouds for the projection's tests; the only test file that sees PCL is clouds.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/projection/projection.h"
#include "pipeline/scan/cloud.h"
#include "tests/support/relief_scene.h"

namespace sparsha::test {

/// Rounds the points to float relative to `origin_m`.
[[nodiscard]] pipeline::Cloud make_cloud(const Points& points,
                                         const Eigen::Vector3d& origin_m = Eigen::Vector3d::Zero());

/// Projects as seen from +z unless told otherwise, with `threads` threads.
[[nodiscard]] pipeline::Projection project_cloud(const pipeline::Cloud& cloud, const scene::GridConfig& config,
                                                 const Eigen::Matrix4d& scan_to_grid = Eigen::Matrix4d::Identity(),
                                                 unsigned threads = 2);

/// Errors of measured nodes against the truth; `counts` says which nodes are judged.
struct Errors {
  double measured = 0.0;  ///< share of the judged nodes
  double rms_m = 0.0, p99_m = 0.0, worst_m = 0.0;
  double over_2mm = 0.0, over_5mm = 0.0;  ///< shares of the judged nodes
};
[[nodiscard]] Errors judge(const scene::DepthGrid& grid, const HeightFunction& truth,
                           const std::function<bool(double, double)>& counts);

}  // namespace sparsha::test
