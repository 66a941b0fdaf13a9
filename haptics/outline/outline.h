// The lines of a depth grid that a hand is led along: steps, ridges and grooves, the border of the stone, the border of
// a part.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/depth_grid.h"
#include "scene/ground/contours.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// A line across the stone, grid frame, metres; closed where the last point is the first once more.
using Line = std::vector<Eigen::Vector2d>;

/// What is found in the heights, longest first:
/// * the border between known nodes (measured or filled) and unknown ones. The rim of the grid counts only as a short
///   part of a border (a quarter at most): where a stone goes on beyond its scan nothing is known of its border.
/// * steps: where the slope of the smoothed heights is largest along itself (zeros of the Laplacian, Marr & Hildreth
///   1980) and exceeds that on both sides by what a step of `least_step_m` makes.
/// * ridges and grooves: where the slope across a line turns by more than 0.5 within some nodes (Eberly 1996).
/// Lines run along the nodes within half a node of where the heights say, and corners are rounded by a node or two.
/// `noise_m`: standard deviation of the heights. Any thread; some 0.3 us per node.
[[nodiscard]] std::vector<Line> find_outlines(const scene::DepthGrid& grid, double noise_m);

/// The steps, and where the surface bends sharply, whichever way it leans: places of the strongest curvature across a
/// line, of at least half a radian within some nodes and twice as strong as beside it (crest lines, Monga, Armande &
/// Montesinos 1997). None within some nodes of the border between known and unknown nodes.
[[nodiscard]] std::vector<Line> find_creases(const scene::DepthGrid& grid, double noise_m);

/// The borders of the nodes for which `inside` holds, longest first; the grid's rim counts as border.
[[nodiscard]] std::vector<Line> find_borders(const scene::Lattice& lattice,
                                             const std::function<bool(int i, int j)>& inside);

/// Half-way between nodes that are inside and others; on the rim where those inside reach it. In node units.
[[nodiscard]] std::vector<scene::Contour> trace_border(int nx, int ny, const std::function<bool(int i, int j)>& inside);

}  // namespace sparsha::haptics
