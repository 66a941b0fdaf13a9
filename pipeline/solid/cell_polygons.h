// Where a surface passes through a cube whose corners are inside or outside of it: closed polygons on the cube's edges
// (marching cubes; a face whose corners alternate keeps those that are inside apart, in both cubes that have it, so
// that the polygons of all cubes close).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace sparsha::pipeline {

/// Corner c is at (c & 1, c >> 1 & 1, c >> 2). Edge e is along axis e / 4, from its lower corner.
struct CubeEdge {
  int low, high;
};
[[nodiscard]] const std::array<CubeEdge, 12>& cube_edges();

/// Edges of one polygon in order, counter-clockwise as seen from outside of the surface.
using CubeLoop = std::vector<std::uint8_t>;

/// `inside`: bit c for corner c.
[[nodiscard]] const std::vector<CubeLoop>& cube_loops(unsigned inside);

/// Whether a line between two edges of the cube lies in one of its faces.
[[nodiscard]] bool share_face(std::uint8_t edge, std::uint8_t other);

/// Three places each in a loop.
using LoopTriangles = std::vector<std::array<std::uint8_t, 3>>;
/// The triangles of a polygon with the shortest lines between them, none of which lies in a face of the cube: the next
/// cube might draw the same. Empty when there are none such; the polygon then needs a place in its middle.
[[nodiscard]] LoopTriangles cut_loop(const CubeLoop& loop, const std::array<std::array<float, 3>, 12>& places);

}  // namespace sparsha::pipeline
