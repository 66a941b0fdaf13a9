// Small clouds and grids for the tests of this folder.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "pipeline/grid/project.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline::testing {

inline Lattice lattice_of(int nx, int ny, double spacing_m, const Eigen::Vector3d& origin_m = Eigen::Vector3d::Zero()) {
  Lattice lattice;
  lattice.nx = nx;
  lattice.ny = ny;
  lattice.spacing_m = spacing_m;
  lattice.origin_m = origin_m;
  return lattice;
}

inline DepthGrid grid_of(const Lattice& lattice, const std::function<double(double, double)>& z) {
  DepthGrid grid(lattice);
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      grid.height_m[lattice.index(i, j)] = static_cast<float>(z(i * lattice.spacing_m, j * lattice.spacing_m));
      grid.state[lattice.index(i, j)] = NodeState::measured;
    }
  return grid;
}

inline Cloud cloud_of(const std::vector<Eigen::Vector3d>& points,
                      const Eigen::Vector3d& origin_m = Eigen::Vector3d::Zero()) {
  Cloud cloud;
  cloud.origin_m = origin_m;
  cloud.resize_points(points.size());
  for (std::size_t n = 0; n < points.size(); ++n)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      cloud.xyz1()[4 * n + static_cast<std::size_t>(axis)] = static_cast<float>(points[n][axis] - origin_m[axis]);
  return cloud;
}

inline Projection projection_of(DepthGrid grid, std::size_t points) {
  Projection projection;
  projection.grid = std::move(grid);
  projection.fate.assign(points, PointFate::used);
  projection.used = points;
  projection.point_spacing_m = projection.grid.lattice.spacing_m;
  return projection;
}

}  // namespace sparsha::pipeline::testing
