// Polygons of mesh files to triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace sparsha::pipeline {

/// Corners of a polygon that is not convex up to which it is cut right: more would take too long.
inline constexpr std::size_t kMostCornersCut = 10'000;

/// Appends the triangles of one polygon: a fan when it is convex, else ears cut off in the plane of its area vector.
/// Corners may share a place, as where a bridge leads to a hole and back. False where the triangles may cover notches
/// and holes: the polygon crosses itself, or a fan stands in since it has more than kMostCornersCut corners or crosses
/// itself so often that ears take too long. Costs n log n for n corners as a rule, n^2 at worst. All corners must exist
/// in `points`.
[[nodiscard]] bool triangulate(std::span<const std::uint32_t> corners, std::span<const Eigen::Vector3d> points,
                               std::vector<std::array<std::uint32_t, 3>>& triangles);

/// A fan without a look at the corners.
void triangulate_as_fan(std::span<const std::uint32_t> corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace sparsha::pipeline
