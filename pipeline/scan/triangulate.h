// Polygons of mesh files to triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace sparsha::pipeline {

/// Appends the triangles of one polygon: a fan when it is convex, else ears cut off in the plane of its area vector.
/// Beyond 64 corners always a fan, so that a hostile file cannot make this slow. All corners must exist in `points`.
void triangulate(std::span<const std::uint32_t> corners, std::span<const Eigen::Vector3d> points,
                 std::vector<std::array<std::uint32_t, 3>>& triangles);

/// A fan without a look at the corners.
void triangulate_as_fan(std::span<const std::uint32_t> corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace sparsha::pipeline
