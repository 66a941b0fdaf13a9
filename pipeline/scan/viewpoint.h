// The viewpoint of a PCD file: the place and turn of its sensor, which do not move the points.
#pragma once

#include <array>
#include <string>

#include <Eigen/Core>

namespace sparsha::pipeline {

/// tx ty tz qw qx qy qz, lengths in the file's unit.
using Viewpoint = std::array<double, 7>;

/// What is to be said of a viewpoint that is not applied, with the remedy for points in the sensor's own frame; empty
/// for one that would move nothing.
[[nodiscard]] std::string viewpoint_doubt(const Viewpoint& viewpoint);

/// Whether a rigid pose, in metres, is what the viewpoint says; `metres` is the file's unit.
[[nodiscard]] bool is_viewpoint(const Viewpoint& viewpoint, const Eigen::Matrix4d& pose, double metres);

}  // namespace sparsha::pipeline
