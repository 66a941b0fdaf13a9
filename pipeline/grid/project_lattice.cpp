// Node (0, 0) stands at the corner of the bounds; sizes are checked before memory is taken.
#include "pipeline/grid/project_lattice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "pipeline/base/error.h"
#include "pipeline/base/system.h"

namespace sparsha::pipeline {
namespace {

constexpr double kMostNodes = 2147483648.0;
// Bins, height, state and what the projection keeps beside them.
constexpr double kBytesPerNode = 16.0;

std::string shortly(double value) {
  std::string text = std::to_string(value);
  text.resize(text.find('.') + (value >= 100.0 ? 0 : 2));
  return text;
}

}  // namespace

Lattice choose_lattice(const GridConfig& config, const Extent& extent, const Eigen::Vector3d& origin_m,
                       double point_spacing_m, double resolution_m) {
  Lattice lattice;
  lattice.origin_m = {origin_m.x() + extent.xmin_m, origin_m.y() + extent.ymin_m, origin_m.z()};
  double width = extent.width_m();
  double height = extent.height_m();
  if (config.bounds_m) {
    const auto& [xmin, ymin, xmax, ymax] = *config.bounds_m;
    if (!(xmax >= xmin && ymax >= ymin)) throw usage_error("grid.bounds_m is empty", "xmin < xmax and ymin < ymax");
    lattice.origin_m.x() = xmin;
    lattice.origin_m.y() = ymin;
    width = xmax - xmin;
    height = ymax - ymin;
  }
  const double longer = std::max(width, height);
  if (config.spacing_m > 0.0) {
    lattice.spacing_m = config.spacing_m;
  } else if (config.size > 1 && longer > 0.0) {
    lattice.spacing_m = longer / (config.size - 1);
  } else {
    lattice.spacing_m = std::max(point_spacing_m, resolution_m);
  }
  if (!(lattice.spacing_m > 0.0) || !std::isfinite(lattice.spacing_m)) lattice.spacing_m = 1e-3;
  const double nx = std::floor(width / lattice.spacing_m + 1e-9) + 1.0;
  const double ny = std::floor(height / lattice.spacing_m + 1e-9) + 1.0;
  const std::string grid = "a grid of " + shortly(nx) + " x " + shortly(ny) + " nodes";
  if (nx < 2.0 || ny < 2.0) {
    char size[160];
    std::snprintf(size, sizeof size, "seen from here, what the grid should cover is %.3g m x %.3g m: no cell of %.3g m",
                  width, height, lattice.spacing_m);
    constexpr const char* kRemedy = "points that spread over a surface; another orientation, bounds or spacing";
    const bool spread = width > 1e-6 && height > 1e-6;  // then it is the spacing that is impossible
    if (config.bounds_m || (config.spacing_m > 0.0 && spread)) throw usage_error(size, kRemedy);
    throw input_error({}, size, kRemedy);
  }
  if (!(nx * ny <= kMostNodes)) {
    throw usage_error(grid + " is too large", "at most 2^31 nodes; a smaller grid.size or larger grid.spacing_mm");
  }
  const auto memory = static_cast<double>(system::physical_memory_bytes());
  if (memory > 0.0 && nx * ny * kBytesPerNode > 0.8 * memory) {
    throw usage_error(grid + " does not fit the " + shortly(memory / 1e9) + " GB of this machine",
                      "a smaller grid.size or larger grid.spacing_mm");
  }
  lattice.nx = static_cast<int>(nx);
  lattice.ny = static_cast<int>(ny);
  return lattice;
}

}  // namespace sparsha::pipeline
