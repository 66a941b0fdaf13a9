#include "scene/material/friction_law.h"

#include <algorithm>
#include <cmath>

#include "scene/area/regions.h"
#include "scene/scene.h"

namespace sparsha::scene {
namespace {

/// One value of an optional layer; NaN where the scene has none.
double value_at(const std::vector<float>& layer, std::size_t node) {
  return static_cast<double>(layer.empty() ? kUnknownHeight : layer[node]);
}

}  // namespace

FrictionLaw::FrictionLaw(const SceneDescription& scene, double scale, double workspace_m)
    : config_(*scene.config.friction),
      c_m_(scene.friction_c_m),
      scale_(scale),
      radius_m_(0.5 * workspace_m),
      scene_(scene) {
  for (std::size_t k = 0; k < scene.config.parts.size(); ++k) {
    const PartConfig& part = scene.config.parts[k];
    if (!part.touch.mu_dynamic) continue;
    const double mu = *part.touch.mu_dynamic;
    parts_.push_back({area_of(scene, k), mu, part.touch.mu_static.value_or(std::max(config_.mu_static, mu))});
  }
}

double FrictionLaw::with_parts(const Layers& layers, std::size_t node, double mu, double Part::*own) const {
  const Lattice& lattice = layers.grid.lattice;
  const auto nx = static_cast<std::size_t>(lattice.nx);
  Eigen::Vector4d place(lattice.x_m(static_cast<int>(node % nx)), lattice.y_m(static_cast<int>(node / nx)), 0.0, 1.0);
  if (scene_.region_from_grid) {
    const double height_m = static_cast<double>(layers.grid.height_m[node]);
    place.z() = lattice.origin_m.z() + (std::isfinite(height_m) ? height_m : 0.0);
    place = *scene_.region_from_grid * place;
  }
  for (auto part = parts_.rbegin(); part != parts_.rend(); ++part)
    mu += ((*part).*own - mu) * part->area.share_inside(place.x(), place.y(), kBorder_m / scale_);
  return mu;
}

float FrictionLaw::dynamic(const Layers& layers, std::size_t node) const {
  double mu = config_.mu_0;
  if (config_.law == FrictionConfig::Law::curvature) {
    const double curvature_per_m = value_at(layers.curvature_per_m, node);
    if (std::isfinite(curvature_per_m)) mu += c_m_ * curvature_per_m;
  } else if (config_.law == FrictionConfig::Law::paper) {
    const double mean = value_at(layers.mean_curvature_per_m, node) / scale_;
    const double gaussian = value_at(layers.gaussian_curvature_per_m2, node) / (scale_ * scale_);
    if (std::isfinite(mean) && std::isfinite(gaussian)) mu = 1.0 / (radius_m_ * std::hypot(mean, gaussian));
  }
  mu = std::clamp(mu, 0.0, config_.mu_max);
  if (!parts_.empty()) mu = with_parts(layers, node, mu, &Part::mu_dynamic);
  return static_cast<float>(mu);
}

float FrictionLaw::at_rest(const Layers& layers, std::size_t node, float dynamic) const {
  double mu = config_.mu_static;
  if (!parts_.empty()) mu = with_parts(layers, node, mu, &Part::mu_static);
  return std::max(static_cast<float>(mu), dynamic);
}

}  // namespace sparsha::scene
