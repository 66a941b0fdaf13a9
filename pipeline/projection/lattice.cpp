// Node (0, 0) stands at the corner of the bounds; sizes are checked before memory is taken.
#include "pipeline/projection/lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/system.h"
#include "base/system/disk_arrays.h"

namespace sparsha::pipeline {
namespace {

constexpr double kMostAlong = 16777216.0;  // as scene.yaml allows
constexpr double kMostNodes = 1099511627776.0;
// What a scene's description can say; a hand's scale over either would be no number of use.
constexpr double kLeastSpacing_m = 1e-12;
constexpr double kMostSpacing_m = 1e6;
constexpr double kNodesPerPoint = 16.0;  // of an automatic grid, or per corner of a triangle
// Bins, height, state and what the projection keeps beside them.
constexpr double kBytesPerNode = 16.0;

std::string shortly(double value) {
  std::string text = std::to_string(value);
  text.resize(text.find('.') + (value >= 100.0 ? 0 : 2));
  return text;
}

// What the lattice covers.
struct Cover {
  double width_m = 0.0;
  double height_m = 0.0;
  double slack = 0.0;  ///< how far the last row may stand beyond it, in spacings
};

// Bounds that are given are kept to the letter, and a size divides the longer side. Else bounds end at supported
// points, and regular data end at a whole number of spacings, give or take what the spacing was rounded by: their outer
// row keeps its nodes. A node farther beyond the points would be guessed from one side.
constexpr double kKept = 1e-9;
constexpr double kRegular = 0.25;

double nodes_along(double length_m, double spacing_m, double slack) {
  return std::floor(length_m / spacing_m + slack) + 1.0;
}

// Bounds that are a lattice's own first and last nodes give its counts again: their difference is off by what a double
// rounds them by, which at 5e6 m is more of a spacing than kKept.
double slack_of(const std::array<double, 4>& bounds_m, double spacing_m) {
  double farthest_m = 0.0;
  for (const double bound_m : bounds_m) farthest_m = std::max(farthest_m, std::abs(bound_m));
  const double rounded = 4.0 * std::numeric_limits<double>::epsilon() * farthest_m / spacing_m;
  return std::clamp(rounded, kKept, kRegular);
}

// The least spacing that keeps a grid nobody asked for within reason: a scan of few points has no more to show, however
// far apart they are.
double bounded_spacing(const Cover& cover, const Extent& extent, double spacing_m) {
  const auto evidence = static_cast<double>(std::max(extent.supported, extent.corners));
  const double most = std::min(kMostUnasked, std::max(4.0, kNodesPerPoint * evidence));
  const auto nodes = [&](double spacing) {
    return nodes_along(cover.width_m, spacing, cover.slack) * nodes_along(cover.height_m, spacing, cover.slack);
  };
  while (nodes(spacing_m) > most) spacing_m *= std::max(1.001, 0.999 * std::sqrt(nodes(spacing_m) / most));
  return spacing_m;
}

// Error for a grid without a cell: the scan's fault when its own spacing gives none either.
Error no_cell(const scene::GridConfig& config, const Cover& cover, double spacing_m, double own_spacing_m) {
  char size[160];
  std::snprintf(size, sizeof size, "seen from here, what the grid should cover is %.3g m x %.3g m: no cell of %.3g m",
                cover.width_m, cover.height_m, spacing_m);
  constexpr const char* kRemedy = "points that spread over a surface; another orientation, bounds or spacing";
  const double shorter = std::min(cover.width_m, cover.height_m);
  const bool carries = own_spacing_m > 0.0 && nodes_along(shorter, own_spacing_m, cover.slack) >= 2.0;
  if (config.bounds_m || (config.spacing_m > 0.0 && carries)) return usage_error(size, kRemedy);
  return input_error({}, size, kRemedy);
}

}  // namespace

scene::Lattice choose_lattice(const scene::GridConfig& config, const Extent& extent, const Eigen::Vector3d& origin_m,
                              double point_spacing_m, double resolution_m) {
  scene::Lattice lattice;
  lattice.origin_m = {origin_m.x() + extent.xmin_m, origin_m.y() + extent.ymin_m, origin_m.z()};
  const bool kept = config.bounds_m || (config.size > 1 && !(config.spacing_m > 0.0));
  Cover cover{extent.width_m(), extent.height_m(), kept ? kKept : kRegular};
  if (config.bounds_m) {
    const auto& [xmin, ymin, xmax, ymax] = *config.bounds_m;
    if (!(xmax >= xmin && ymax >= ymin)) throw usage_error("grid.bounds_m is empty", "xmin < xmax and ymin < ymax");
    lattice.origin_m.x() = xmin;
    lattice.origin_m.y() = ymin;
    cover.width_m = xmax - xmin;
    cover.height_m = ymax - ymin;
  }
  const double longer = std::max(cover.width_m, cover.height_m);
  const double own_spacing_m = std::max(point_spacing_m, resolution_m);
  if (config.spacing_m > 0.0) {
    lattice.spacing_m = config.spacing_m;
  } else if (config.size > 1 && longer > 0.0) {
    lattice.spacing_m = longer / (config.size - 1);
  } else {
    lattice.spacing_m = own_spacing_m > 0.0 && std::isfinite(own_spacing_m) ? own_spacing_m : 1e-3;
    lattice.spacing_m = bounded_spacing(cover, extent, lattice.spacing_m);
  }
  if (!(lattice.spacing_m > 0.0) || !std::isfinite(lattice.spacing_m)) lattice.spacing_m = 1e-3;
  if (!(lattice.spacing_m >= kLeastSpacing_m && lattice.spacing_m <= kMostSpacing_m)) {
    char size[160];
    std::snprintf(size, sizeof size, "what the grid should cover is %.3g m x %.3g m: nodes would stand %.3g m apart",
                  cover.width_m, cover.height_m, lattice.spacing_m);
    throw input_error({}, size, "points that spread over a surface; the right 'units' of the scan");
  }
  if (config.bounds_m) cover.slack = slack_of(*config.bounds_m, lattice.spacing_m);
  const double nx = nodes_along(cover.width_m, lattice.spacing_m, cover.slack);
  const double ny = nodes_along(cover.height_m, lattice.spacing_m, cover.slack);
  const std::string grid = "a grid of " + shortly(nx) + " x " + shortly(ny) + " nodes";
  if (nx < 2.0 || ny < 2.0) throw no_cell(config, cover, lattice.spacing_m, own_spacing_m);
  if (!(std::max(nx, ny) <= kMostAlong && nx * ny <= kMostNodes)) {
    throw usage_error(grid + " is too large",
                      "at most 2^24 nodes along a side and 2^40 in all; a smaller grid.size or larger grid.spacing_mm");
  }
  const auto memory = static_cast<double>(system::physical_memory_bytes());
  if (memory > 0.0 && !system::has_disk_arrays() && nx * ny * kBytesPerNode > 0.8 * memory) {
    throw usage_error(grid + " does not fit the " + shortly(memory / 1e9) + " GB of this machine",
                      "a smaller grid.size or larger grid.spacing_mm");
  }
  lattice.nx = static_cast<int>(nx);
  lattice.ny = static_cast<int>(ny);
  return lattice;
}

}  // namespace sparsha::pipeline
