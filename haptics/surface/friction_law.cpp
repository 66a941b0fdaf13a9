#include "haptics/surface/friction_law.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "haptics/surface/large_pages.h"

namespace sparsha::haptics {
namespace {

using pipeline::FrictionConfig;
using pipeline::Layers;
using pipeline::NodeState;

/// One value of an optional layer; NaN where the scene has none.
float layer_at(const std::vector<float>& layer, std::size_t node) {
  return layer.empty() ? pipeline::kUnknownHeight : layer[node];
}

double paper_coefficient(double mean_per_m, double gaussian_per_m2, double scale, double radius_m) {
  const double mean = mean_per_m / scale;
  const double gaussian = gaussian_per_m2 / (scale * scale);
  return 1.0 / (radius_m * std::hypot(mean, gaussian));
}

}  // namespace

FrictionMap evaluate_friction(const pipeline::SceneDescription& scene, const Layers& window, double scale) {
  FrictionMap map;
  if (!scene.config.friction) return map;
  const FrictionConfig& config = *scene.config.friction;
  const pipeline::Lattice& lattice = window.grid.lattice;
  // The workspace is as wide as the window's longer side is when scaled.
  const double radius_m = 0.5 * scale * (std::max(lattice.nx, lattice.ny) - 1) * lattice.spacing_m;

  for (std::vector<float>* values : {&map.mu_dynamic, &map.mu_static}) {
    *values = room_for(lattice.count());
    values->resize(lattice.count());
  }
  for (std::size_t node = 0; node < lattice.count(); ++node) {
    if (window.grid.state[node] == NodeState::unknown) continue;
    double mu = config.mu_0;
    if (config.law == FrictionConfig::Law::curvature) {
      const double k = layer_at(window.curvature_per_m, node);
      if (std::isfinite(k)) mu += scene.friction_c_m * k;
    } else if (config.law == FrictionConfig::Law::paper) {
      const double mean = layer_at(window.mean_curvature_per_m, node);
      const double gaussian = layer_at(window.gaussian_curvature_per_m2, node);
      if (std::isfinite(mean) && std::isfinite(gaussian)) mu = paper_coefficient(mean, gaussian, scale, radius_m);
    }
    mu = std::clamp(mu, 0.0, config.mu_max);
    map.mu_dynamic[node] = static_cast<float>(mu);
    map.mu_static[node] = std::max(static_cast<float>(config.mu_static), map.mu_dynamic[node]);
  }
  return map;
}

}  // namespace sparsha::haptics
