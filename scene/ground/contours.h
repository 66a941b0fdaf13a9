// Lines through a lattice that are told by where they cross the edges between neighbouring nodes (marching squares,
// Lorensen & Cline 1987, in the plane).
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace sparsha::scene {

/// In node units: node (i, j) lies at (i, j).
struct Contour {
  std::vector<Eigen::Vector2d> points;  ///< of a closed one the last is the first once more
  [[nodiscard]] bool closed() const { return points.size() > 3 && points.front() == points.back(); }
  [[nodiscard]] double length() const;
};

/// Where a line crosses the edge from node (i, j) to (i + 1, j), or, `up`, to (i, j + 1): a share of it, 0 to 1; not a
/// number where none does.
using Crossing = std::function<double(int i, int j, bool up)>;

/// Such a share where two values of unlike sign lie on either side.
[[nodiscard]] double zero_between(double a, double b);

/// All lines of nx x ny nodes, each once. Where four crossings meet in a cell, lines do not cross each other: they turn
/// round its lower left and upper right corners.
[[nodiscard]] std::vector<Contour> trace_contours(int nx, int ny, const Crossing& crossing);

/// Takes the steps of single nodes out of a line: every point moves to the weighted mean of itself and its neighbours
/// (1 2 1), `passes` times. Ends stay.
void smooth(Contour& contour, int passes);

/// Leaves out points whose absence moves the line by at most `tolerance` nodes (Douglas & Peucker 1973).
void simplify(Contour& contour, double tolerance);

}  // namespace sparsha::scene
