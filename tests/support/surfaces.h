// Surfaces for the contact tests, made straight from formulas.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "haptics/surface/monge_surface.h"

namespace sparsha::haptics::test {

using Height = std::function<double(double x, double y)>;

/// Nodes of z(x, y), metres, local frame.
inline MongeSurface make_surface_of(int nx, int ny, double spacing_m, const Height& height) {
  MongeSurface surface;
  surface.lattice.nx = nx;
  surface.lattice.ny = ny;
  surface.lattice.spacing_m = spacing_m;
  surface.height_m.reserve(surface.lattice.count());
  double highest = -std::numeric_limits<double>::infinity();
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      surface.height_m.push_back(static_cast<float>(height(i * spacing_m, j * spacing_m)));
      highest = std::max(highest, static_cast<double>(surface.height_m.back()));
    }
  surface.highest_m = highest;
  return surface;
}

inline void set_friction(MongeSurface& surface, double mu_static, double mu_dynamic) {
  surface.mu_static.assign(surface.lattice.count(), static_cast<float>(mu_static));
  surface.mu_dynamic.assign(surface.lattice.count(), static_cast<float>(mu_dynamic));
}

/// Friction that differs from node to node, mu_d in [0, mu_max], mu_s >= mu_d.
inline void set_random_friction(MongeSurface& surface, double mu_max, std::mt19937_64& random) {
  std::uniform_real_distribution<float> mu(0.0F, static_cast<float>(mu_max));
  surface.mu_dynamic.resize(surface.lattice.count());
  surface.mu_static.resize(surface.lattice.count());
  for (std::size_t k = 0; k < surface.mu_dynamic.size(); ++k) {
    surface.mu_dynamic[k] = mu(random);
    surface.mu_static[k] = std::max(surface.mu_dynamic[k], mu(random));
  }
}

/// Independent uniform heights in [0, amplitude_m] at every node.
inline MongeSurface make_rough_surface(int nodes, double spacing_m, double amplitude_m, std::mt19937_64& random) {
  std::uniform_real_distribution<double> height(0.0, amplitude_m);
  return make_surface_of(nodes, nodes, spacing_m, [&](double, double) { return height(random); });
}

/// Fractal stone: midpoint displacement, Hurst exponent 0.7; nodes = 2^k + 1.
MongeSurface make_fractal_surface(int nodes, double spacing_m, double amplitude_m, std::mt19937_64& random);

/// z = 0.05 sin(2 pi x) sin(2 pi y) over 1 m^2.
MongeSurface make_sinusoid(int nodes);

}  // namespace sparsha::haptics::test
