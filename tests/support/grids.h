// Small depth grids for tests of projection, layers and cross-check.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

#include "scene/depth_grid.h"

namespace sparsha::pipeline::testing {

inline scene::Lattice lattice_of(int nx, int ny, double spacing_m,
                                 const Eigen::Vector3d& origin_m = Eigen::Vector3d::Zero()) {
  scene::Lattice lattice;
  lattice.nx = nx;
  lattice.ny = ny;
  lattice.spacing_m = spacing_m;
  lattice.origin_m = origin_m;
  return lattice;
}

/// Heights z(x, y), all measured; x and y are relative to node (0, 0).
inline scene::DepthGrid grid_of(const scene::Lattice& lattice, const std::function<double(double, double)>& z) {
  scene::DepthGrid grid(lattice);
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      grid.height_m[lattice.index(i, j)] = static_cast<float>(z(i * lattice.spacing_m, j * lattice.spacing_m));
      grid.state[lattice.index(i, j)] = scene::NodeState::measured;
    }
  return grid;
}

inline void forget(scene::DepthGrid& grid, int i, int j) {
  grid.height_m[grid.lattice.index(i, j)] = scene::kUnknownHeight;
  grid.state[grid.lattice.index(i, j)] = scene::NodeState::unknown;
}

inline void add_noise(scene::DepthGrid& grid, double sigma_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma_m);
  for (float& z : grid.height_m) z = static_cast<float>(z + normal(random));
}

}  // namespace sparsha::pipeline::testing
