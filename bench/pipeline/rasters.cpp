#include "bench/pipeline/rasters.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/numbers/statistics.h"

namespace sparsha::bench {
namespace {

using scene::DepthGrid;
using scene::Lattice;
using Point = std::array<double, 3>;

/// Cell of a coordinate; may lie outside.
int cell_of(double value, double first, double spacing) {
  return static_cast<int>(std::floor((value - first) / spacing + 0.5));
}

void set(DepthGrid& grid, std::size_t node, double z) {
  grid.height_m[node] = static_cast<float>(z - grid.lattice.origin_m.z());
  grid.state[node] = scene::NodeState::measured;
}

/// Heights of each cell, one after the other.
struct Cells {
  std::vector<std::uint32_t> start;  ///< one more than nodes
  std::vector<double> z;
};

Cells sorted(std::span<const Point> points, const Lattice& lattice) {
  std::vector<std::int64_t> cell(points.size(), -1);
  Cells cells;
  cells.start.assign(lattice.count() + 1, 0);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const int i = cell_of(points[k][0], lattice.x_m(0), lattice.spacing_m);
    const int j = cell_of(points[k][1], lattice.y_m(0), lattice.spacing_m);
    if (i < 0 || j < 0 || i >= lattice.nx || j >= lattice.ny) continue;
    const std::size_t node = lattice.index(i, j);
    cell[k] = static_cast<std::int64_t>(node);
    ++cells.start[node + 1];
  }
  for (std::size_t n = 0; n < lattice.count(); ++n) cells.start[n + 1] += cells.start[n];
  cells.z.resize(cells.start.back());
  std::vector<std::uint32_t> next(cells.start.begin(), cells.start.end() - 1);
  for (std::size_t k = 0; k < points.size(); ++k)
    if (cell[k] >= 0) cells.z[next[static_cast<std::size_t>(cell[k])]++] = points[k][2];
  return cells;
}

DepthGrid by_cells(std::span<const Point> points, const Lattice& lattice, RasterRule rule) {
  const Cells cells = sorted(points, lattice);
  DepthGrid grid(lattice);
  std::vector<double> heights;
  for (std::size_t node = 0; node < lattice.count(); ++node) {
    if (cells.start[node] == cells.start[node + 1]) continue;
    heights.assign(cells.z.begin() + cells.start[node], cells.z.begin() + cells.start[node + 1]);
    if (rule == RasterRule::max) {
      set(grid, node, *std::max_element(heights.begin(), heights.end()));
    } else if (rule == RasterRule::median) {
      set(grid, node, median(heights));
    } else {
      double sum = 0.0;
      for (const double z : heights) sum += z;
      set(grid, node, sum / static_cast<double>(heights.size()));
    }
  }
  return grid;
}

DepthGrid by_distance(std::span<const Point> points, const Lattice& lattice) {
  constexpr double kReach = 1.5;     // cells
  constexpr double kNearest = 1e-6;  // cells: a point on the node
  std::vector<double> weight(lattice.count()), sum(lattice.count());
  for (const Point& p : points) {
    const double u = (p[0] - lattice.x_m(0)) / lattice.spacing_m, v = (p[1] - lattice.y_m(0)) / lattice.spacing_m;
    const int i0 = std::max(0, static_cast<int>(std::ceil(u - kReach)));
    const int j0 = std::max(0, static_cast<int>(std::ceil(v - kReach)));
    const int i1 = std::min(lattice.nx - 1, static_cast<int>(std::floor(u + kReach)));
    const int j1 = std::min(lattice.ny - 1, static_cast<int>(std::floor(v + kReach)));
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) {
        const double squared = (u - i) * (u - i) + (v - j) * (v - j);
        if (squared > kReach * kReach) continue;
        const double w = 1.0 / std::max(squared, kNearest * kNearest);
        weight[lattice.index(i, j)] += w;
        sum[lattice.index(i, j)] += w * p[2];
      }
  }
  DepthGrid grid(lattice);
  for (std::size_t node = 0; node < lattice.count(); ++node)
    if (weight[node] > 0.0) set(grid, node, sum[node] / weight[node]);
  return grid;
}

}  // namespace

const char* name_of(RasterRule rule) {
  switch (rule) {
    case RasterRule::max:
      return "z-buffer max";
    case RasterRule::mean:
      return "mean";
    case RasterRule::median:
      return "median";
    default:
      return "inverse distance";
  }
}

DepthGrid raster(std::span<const Point> points, const Lattice& lattice, RasterRule rule) {
  return rule == RasterRule::inverse_distance ? by_distance(points, lattice) : by_cells(points, lattice, rule);
}

}  // namespace sparsha::bench
